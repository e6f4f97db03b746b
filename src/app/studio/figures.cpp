#include "app/studio/figures.h"

#include <fmt/format.h>

namespace parian {

std::size_t map_bytes(const ProfileMap& map) {
  return sizeof(float) * (map.log_profile.size() + map.gain.size() + map.dilation.size());
}

std::string bytes_text(std::size_t bytes) {
  const auto count = static_cast<double>(bytes);
  return bytes < 1000000 ? fmt::format("{:.1f} kB", count / 1e3)
                         : fmt::format("{:.2f} MB", count / 1e6);
}

}  // namespace parian

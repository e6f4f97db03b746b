#include "transport/emitters.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace parian {

EmitterView view(const Emitters& emitters) {
  EmitterView result{};
  result.x = emitters.position[0].data();
  result.y = emitters.position[1].data();
  result.z = emitters.position[2].data();
  for (std::size_t c = 0; c < 3; ++c) {
    result.log_flux[c] = emitters.log_flux[c].data();
    result.support[c] = emitters.support[c].data();
  }
  result.edge_width = emitters.edge_width.data();
  result.spread = emitters.spread.data();
  result.row = emitters.row.data();
  result.rows = emitters.rows.data();
  result.row_size = emitters.row_size;
  return result;
}

void resize(Emitters& emitters, std::size_t count) {
  for (std::size_t c = 0; c < 3; ++c) {
    emitters.position[c].resize(count);
    emitters.log_flux[c].resize(count);
    emitters.support[c].resize(count);
  }
  emitters.edge_width.resize(count);
  emitters.spread.resize(count);
  emitters.row.resize(count);
}

void set_samples(Emitters& emitters, const ProfileField& field, const GatherSources& sources,
                 const std::vector<std::uint32_t>& order) {
  const bool homogeneous = field.width == 1 && field.height == 1;
  emitters.row_size = field.row();
  emitters.rows.resize(field.row() * (homogeneous ? 1 : order.size()));
  parallel_for_blocks(order.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<float> row(field.row());
    for (std::size_t i = begin; i < end; ++i) {
      const GatherPoint& point = sources.points[order[i]];
      const Rgb& flux = sources.flux[order[i]];
      float support[3];
      field.eval(static_cast<double>(point.x), static_cast<double>(point.y), row.data(), support);
      if (!homogeneous || i == 0)
        std::copy(row.begin(), row.end(), &emitters.rows[(homogeneous ? 0 : i) * field.row()]);
      emitters.row[i] = homogeneous ? 0 : static_cast<std::uint32_t>(i);
      const float position[3] = {point.position.x, point.position.y, point.position.z};
      const float power[3] = {flux.x, flux.y, flux.z};
      for (std::size_t c = 0; c < 3; ++c) {
        emitters.position[c][i] = position[c];
        emitters.log_flux[c][i] = power[c] > 0 ? std::log(power[c]) : log_of_nothing;
        emitters.support[c][i] = support[c];
      }
    }
  });
}

}  // namespace parian

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "io/blend/packed_internal.h"

namespace parian {
namespace {

float distance_of(const ProfileBlend& blend, std::size_t a, std::size_t b, std::size_t row) {
  float sum = 0;
  for (std::size_t i = 0; i < row; ++i) {
    const float d = blend.base_log_profile[a * row + i] - blend.base_log_profile[b * row + i];
    sum += d * d;
  }
  return sum;
}

std::size_t row_of(const ProfileBlend& blend) {
  return static_cast<std::size_t>(blend.channels) * blend.knots_mm.size();
}

// A chain from the darkest base, always on to the nearest one left; of many bases, by brightness.
std::vector<std::size_t> order_bases(const ProfileBlend& blend) {
  constexpr std::size_t longest_chain = 2048;
  const std::size_t bases = blend.bases(), row = row_of(blend);
  std::vector<std::size_t> order(bases);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return blend.base_log_profile[a * row] < blend.base_log_profile[b * row];
  });
  if (bases > longest_chain) return order;
  for (std::size_t i = 1; i < bases; ++i) {
    std::size_t nearest = i;
    float least = HUGE_VALF;
    for (std::size_t j = i; j < bases; ++j) {
      const float distance = distance_of(blend, order[i - 1], order[j], row);
      if (distance < least) {
        least = distance;
        nearest = j;
      }
    }
    std::swap(order[i], order[nearest]);
  }
  return order;
}

std::uint32_t zigzag(std::int64_t value) {
  return static_cast<std::uint32_t>((value << 1) ^ (value >> 63));
}
std::int64_t unzigzag(std::uint32_t value) {
  return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1u);
}

// Steps down from knot to knot, less those of the base before; the first knot as it is.
std::size_t width_of(const std::vector<std::uint32_t>& values) {
  const std::uint32_t largest = *std::max_element(values.begin(), values.end());
  return largest < 1u << 8u ? 1 : largest < 1u << 16u ? 2 : 4;
}

std::size_t index_width(std::size_t bases) {
  return bases <= 256 ? 1 : 2;
}
std::size_t weight_width(const ProfileBlend& blend) {
  return blend.grid.weight_levels < 256 ? 1 : 2;
}

}  // namespace

ProfileBlend sort_blend(const ProfileBlend& blend) {
  const std::size_t pixels = blend.pixels(), bases = blend.bases();
  const std::size_t row = row_of(blend);
  const auto per_pixel = static_cast<std::size_t>(blend.per_pixel);
  const std::vector<std::size_t> order = order_bases(blend);
  ProfileBlend sorted = blend;
  std::vector<std::uint16_t> number(bases);
  for (std::size_t j = 0; j < bases; ++j) {
    number[order[j]] = static_cast<std::uint16_t>(j);
    std::copy_n(&blend.base_log_profile[order[j] * row], row, &sorted.base_log_profile[j * row]);
  }
  std::array<float, max_bases_per_pixel> weight{};
  std::array<std::size_t, max_bases_per_pixel> slot{};
  std::array<long, max_bases_per_pixel> level{};  // of the lattice: ties are ties
  for (std::size_t x = 0; x < pixels; ++x) {
    get_weights(blend, x, weight.data());
    for (std::size_t k = 0; k < per_pixel; ++k)
      level[k] = std::lround(weight[k] * static_cast<float>(blend.grid.weight_levels));
    std::iota(slot.begin(), slot.end(), std::size_t{0});
    std::stable_sort(slot.begin(), slot.begin() + static_cast<std::ptrdiff_t>(per_pixel),
                     [&](std::size_t a, std::size_t b) { return level[a] > level[b]; });
    for (std::size_t k = 0; k < per_pixel; ++k) {
      // The base of a weight of 0 does not matter: the one to the left is cheapest.
      const bool free = level[slot[k]] == 0 && x > 0;
      sorted.index[k * pixels + x] =
          free ? sorted.index[k * pixels + x - 1] : number[blend.index[slot[k] * pixels + x]];
      if (k + 1 < per_pixel) sorted.weight[k * pixels + x] = weight[slot[k]];
    }
  }
  return sorted;
}

std::string pack_profiles(const ProfileBlend& blend) {
  const std::size_t knots = blend.knots_mm.size();
  const std::size_t row = static_cast<std::size_t>(blend.channels) * knots;
  const auto level = [&](std::size_t i) {
    return std::llround(static_cast<double>(blend.base_log_profile[i]) / blend.grid.profile_step);
  };
  const std::size_t count = blend.base_log_profile.size(), bases = count / row;
  std::vector<std::uint32_t> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::int64_t value = level(i);
    if (i % knots > 0) value -= level(i - 1);
    if (i >= row) value -= i % knots > 0 ? level(i - row) - level(i - row - 1) : level(i - row);
    // Equal knots of all bases lie together.
    values[i % row * bases + i / row] = zigzag(value);
  }
  const std::size_t width = width_of(values);
  std::string bytes;
  append(bytes, static_cast<std::uint8_t>(width));
  append_plane(bytes, values, count, width);
  return bytes;
}

void unpack_profiles(ByteReader reader, std::size_t bases, ProfileBlend& blend) {
  const std::string place = "section 'profiles'";
  const std::size_t knots = blend.knots_mm.size();
  const std::size_t row = static_cast<std::size_t>(blend.channels) * knots, count = bases * row;
  const auto width = reader.read<std::uint8_t>(place);
  if (width != 1 && width != 2 && width != 4)
    throw Error({reader.file, place, "a width of 1, 2 or 4 bytes", fmt::format("{}", width)});
  const std::vector<std::uint32_t> values = read_plane(reader, count, count, width, place);
  std::vector<std::int64_t> level(count);
  blend.base_log_profile.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::int64_t value = unzigzag(values[i % row * bases + i / row]);
    if (i % knots > 0) value += level[i - 1];
    if (i >= row) value += i % knots > 0 ? level[i - row] - level[i - row - 1] : level[i - row];
    level[i] = value;
    blend.base_log_profile[i] =
        static_cast<float>(static_cast<double>(value) * blend.grid.profile_step);
  }
}

std::string pack_indices(const ProfileBlend& blend) {
  std::string bytes;
  const auto row = static_cast<std::size_t>(blend.width);
  for (int k = 0; k < blend.per_pixel; ++k) {
    const auto* from = blend.index.data() + static_cast<std::size_t>(k) * blend.pixels();
    append_plane(bytes, {from, from + blend.pixels()}, row, index_width(blend.bases()));
  }
  return bytes;
}

void unpack_indices(ByteReader reader, std::size_t bases, ProfileBlend& blend) {
  const auto row = static_cast<std::size_t>(blend.width);
  for (int k = 0; k < blend.per_pixel; ++k) {
    const std::vector<std::uint32_t> values =
        read_plane(reader, blend.pixels(), row, index_width(bases), "section 'indices'");
    blend.index.insert(blend.index.end(), values.begin(), values.end());
  }
}

std::string pack_weights(const ProfileBlend& blend) {
  std::string bytes;
  const auto row = static_cast<std::size_t>(blend.width);
  std::vector<std::uint32_t> values(blend.pixels());
  for (int k = 0; k + 1 < blend.per_pixel; ++k) {
    const float* from = blend.weight.data() + static_cast<std::size_t>(k) * blend.pixels();
    for (std::size_t x = 0; x < values.size(); ++x)
      values[x] = static_cast<std::uint32_t>(
          std::lround(static_cast<double>(from[x]) * blend.grid.weight_levels));
    append_plane(bytes, values, row, weight_width(blend));
  }
  return bytes;
}

void unpack_weights(ByteReader reader, ProfileBlend& blend) {
  const auto row = static_cast<std::size_t>(blend.width);
  for (int k = 0; k + 1 < blend.per_pixel; ++k)
    for (std::uint32_t value :
         read_plane(reader, blend.pixels(), row, weight_width(blend), "section 'weights'"))
      blend.weight.push_back(
          static_cast<float>(static_cast<double>(value) / blend.grid.weight_levels));
}

}  // namespace parian

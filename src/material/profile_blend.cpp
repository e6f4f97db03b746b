#include "material/profile_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "base/hot.h"
#include "material/plane_eval_internal.h"

namespace parian {
namespace {

constexpr double weight_slack = 1e-5;  // rounding of a sum of floats

// out += weight values[index], and what is left of the weights less weight.
PARIAN_HOT void add_entries(const float* PARIAN_RESTRICT values,
                            const std::uint16_t* PARIAN_RESTRICT index,
                            const float* PARIAN_RESTRICT weight, std::size_t count,
                            float* PARIAN_RESTRICT left, float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < count; ++i) {
    const int base = index[i];
    out[i] += weight[i] * values[base];
    left[i] -= weight[i];
  }
}

// The last entry, with the weight that is left.
PARIAN_HOT void add_last_entries(const float* PARIAN_RESTRICT values,
                                 const std::uint16_t* PARIAN_RESTRICT index,
                                 const float* PARIAN_RESTRICT left, std::size_t count,
                                 float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < count; ++i) {
    const int base = index[i];
    const float weight = left[i] > 0 ? left[i] : 0.0f;
    out[i] += weight * values[base];
  }
}

// The values of four pixels, whose indices are read as one word: loads are what bounds mix_pairs.
inline void pick_four(const float* PARIAN_RESTRICT values,
                      const std::uint16_t* PARIAN_RESTRICT index, float* PARIAN_RESTRICT out) {
  constexpr bool little = std::endian::native == std::endian::little;
  std::uint64_t word = 0;
  std::memcpy(&word, index, sizeof(word));
  for (int i = 0; i < 4; ++i) out[i] = values[(word >> (little ? 16 * i : 48 - 16 * i)) & 0xffffu];
}

// K = 2 in one pass.
PARIAN_HOT void mix_pairs(const float* PARIAN_RESTRICT values,
                          const std::uint16_t* PARIAN_RESTRICT first,
                          const std::uint16_t* PARIAN_RESTRICT second,
                          const float* PARIAN_RESTRICT weight, std::size_t count,
                          float* PARIAN_RESTRICT out) {
  constexpr std::size_t block = 8;
  std::size_t i = 0;
  for (; i + block <= count; i += block) {
    float a[block], b[block];
    for (std::size_t j = 0; j < block; j += 4) pick_four(values, first + i + j, a + j);
    for (std::size_t j = 0; j < block; j += 4) pick_four(values, second + i + j, b + j);
    for (std::size_t j = 0; j < block; ++j) {
      const float rest = 1 - weight[i + j];
      out[i + j] = weight[i + j] * a[j] + (rest > 0 ? rest : 0.0f) * b[j];
    }
  }
  for (; i < count; ++i) {
    const float rest = 1 - weight[i];
    out[i] = weight[i] * values[first[i]] + (rest > 0 ? rest : 0.0f) * values[second[i]];
  }
}

// A profile's values from one per base: sum_k t_xk values[b(x,k)] for all pixels.
void mix_planes(const ProfileBlend& blend, const std::vector<float>& values, float* out) {
  constexpr std::size_t block = 1024;  // what is left stays in cache
  const std::size_t pixels = blend.pixels();
  const auto last = static_cast<std::size_t>(blend.per_pixel) - 1;
  if (last == 1)
    return mix_pairs(values.data(), blend.index.data(), &blend.index[pixels], blend.weight.data(),
                     pixels, out);
  std::array<float, block> left;
  for (std::size_t x = 0; x < pixels; x += block) {
    const std::size_t count = std::min(block, pixels - x);
    std::fill_n(out + x, count, 0.0f);
    std::fill_n(left.begin(), count, 1.0f);
    for (std::size_t k = 0; k < last; ++k)
      add_entries(values.data(), &blend.index[k * pixels + x], &blend.weight[k * pixels + x], count,
                  left.data(), out + x);
    add_last_entries(values.data(), &blend.index[last * pixels + x], left.data(), count, out + x);
  }
}

void check_header(const ProfileBlend& blend, const std::string& name) {
  if (blend.width < 1 || blend.height < 1 || (blend.channels != 1 && blend.channels != 3))
    throw Error(
        {name, "size", "width and height of at least 1, 1 or 3 channels",
         fmt::format("{} x {} pixels, {} channels", blend.width, blend.height, blend.channels)});
  if (blend.per_pixel < 1 || blend.per_pixel > max_bases_per_pixel)
    throw Error({name, "per_pixel", fmt::format("a value in [1, {}]", max_bases_per_pixel),
                 fmt::format("{}", blend.per_pixel)});
  if (!(blend.pixel_pitch_mm > 0) || std::isinf(blend.pixel_pitch_mm))
    throw Error(
        {name, "pixel_pitch_mm", "a finite length > 0", fmt::format("{}", blend.pixel_pitch_mm)});
  check_knots(blend.knots_mm, name, "knots_mm");
  if (blend.bases() < 1 || blend.bases() > static_cast<std::size_t>(max_bases))
    throw Error({name, "bases", fmt::format("1 to {} base profiles", max_bases),
                 fmt::format("{}", blend.bases())});
  const BlendGrid& grid = blend.grid;
  if (!(grid.profile_step >= 0 && grid.profile_step <= 1) || grid.weight_levels < 0 ||
      grid.weight_levels > 65535)
    throw Error({name, "grid", "a step in [0, 1] and levels in [0, 65535]",
                 fmt::format("{} and {}", grid.profile_step, grid.weight_levels)});
}

void check_profiles(const ProfileBlend& blend, const std::string& name) {
  const std::size_t knots = blend.knots_mm.size();
  const auto channels = static_cast<std::size_t>(blend.channels);
  check_values(blend.base_log_profile, blend.bases() * channels * knots,
               -std::numeric_limits<float>::max(), name, "base profiles");
  const double step = blend.grid.profile_step;
  for (std::size_t i = 0; i < blend.base_log_profile.size(); ++i) {
    const float value = blend.base_log_profile[i];
    const auto place = [&] {
      return fmt::format("base {}, channel {}, knot {}", i / (channels * knots),
                         i / knots % channels, i % knots);
    };
    if (i % knots > 0 && value > blend.base_log_profile[i - 1])
      throw Error({name, place(), fmt::format("at most {}", blend.base_log_profile[i - 1]),
                   fmt::format("{}", value)});
    if (step > 0 &&
        static_cast<float>(std::round(static_cast<double>(value) / step) * step) != value)
      throw Error({name, place(), fmt::format("a multiple of {}", step), fmt::format("{}", value)});
  }
}

void check_pixels(const ProfileBlend& blend, const std::string& name) {
  const std::size_t pixels = blend.pixels(), bases = blend.bases();
  const auto per_pixel = static_cast<std::size_t>(blend.per_pixel);
  const int levels = blend.grid.weight_levels;
  const auto place = [&](std::size_t x) {
    return fmt::format("pixel ({}, {})", x % static_cast<std::size_t>(blend.width),
                       x / static_cast<std::size_t>(blend.width));
  };
  if (blend.index.size() != per_pixel * pixels)
    throw Error({name, "indices", fmt::format("{} values", per_pixel * pixels),
                 fmt::format("{}", blend.index.size())});
  check_values(blend.weight, (per_pixel - 1) * pixels, 0, name, "weights");
  for (std::size_t x = 0; x < pixels; ++x) {
    double sum = 0;
    for (std::size_t k = 0; k < per_pixel; ++k) {
      const std::uint16_t index = blend.index[k * pixels + x];
      if (index >= bases)
        throw Error(
            {name, place(x), fmt::format("an index below {}", bases), fmt::format("{}", index)});
      if (k + 1 == per_pixel) continue;
      const auto weight = static_cast<double>(blend.weight[k * pixels + x]);
      sum += weight;
      if (levels > 0 && std::abs(std::remainder(weight * levels, 1)) > 0.02)
        throw Error({name, place(x), fmt::format("weights that are multiples of 1/{}", levels),
                     fmt::format("{}", weight)});
    }
    if (sum > 1 + weight_slack)
      throw Error({name, place(x), "weights that sum to at most 1", fmt::format("{}", sum)});
  }
}

// Weights that sum to 1 to the nearest multiples of 1 / levels that do: largest remainders.
void round_weights(std::array<double, max_bases_per_pixel>& weights, std::size_t count,
                   int levels) {
  std::array<double, max_bases_per_pixel> remainder{};
  int left = levels;
  for (std::size_t k = 0; k < count; ++k) {
    const double floor = std::floor(weights[k] * levels + 0.01);
    remainder[k] = weights[k] * levels - floor;
    weights[k] = floor;
    left -= static_cast<int>(floor);
  }
  for (; left > 0; --left) {
    const auto largest =
        std::max_element(remainder.begin(), remainder.begin() + static_cast<std::ptrdiff_t>(count));
    weights[static_cast<std::size_t>(largest - remainder.begin())] += 1;
    *largest -= 1;
  }
}

void snap_weights(ProfileBlend& blend, int levels) {
  const std::size_t pixels = blend.pixels();
  const auto per_pixel = static_cast<std::size_t>(blend.per_pixel);
  std::array<float, max_bases_per_pixel> given{};
  std::array<double, max_bases_per_pixel> weights{};
  for (std::size_t x = 0; x < pixels; ++x) {
    get_weights(blend, x, given.data());
    std::copy(given.begin(), given.end(), weights.begin());
    round_weights(weights, per_pixel, levels);
    for (std::size_t k = 0; k + 1 < per_pixel; ++k)
      blend.weight[k * pixels + x] = static_cast<float>(weights[k] / levels);
  }
}

}  // namespace

void check(const ProfileBlend& blend, const std::string& name) {
  check_header(blend, name);
  check_profiles(blend, name);
  check_pixels(blend, name);
  const std::size_t planes = static_cast<std::size_t>(blend.channels) * blend.pixels();
  const float positive = std::numeric_limits<float>::min();
  if (!blend.gain.empty()) check_values(blend.gain, planes, positive, name, "gain");
  if (!blend.dilation.empty()) check_values(blend.dilation, planes, positive, name, "dilation");
}

void get_weights(const ProfileBlend& blend, std::size_t pixel, float* weights) {
  const auto last = static_cast<std::size_t>(blend.per_pixel) - 1;
  float left = 1;
  for (std::size_t k = 0; k < last; ++k) {
    weights[k] = blend.weight[k * blend.pixels() + pixel];
    left -= weights[k];
  }
  weights[last] = std::max(left, 0.0f);
}

Profile get_profile(const ProfileBlend& blend, int channel, int x, int y) {
  const std::size_t knots = blend.knots_mm.size();
  const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(blend.width) +
                            static_cast<std::size_t>(x);
  std::array<float, max_bases_per_pixel> weights{};
  get_weights(blend, pixel, weights.data());
  std::vector<double> log_value(knots, 0.0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(blend.per_pixel); ++k) {
    const float* base = base_profile(blend, blend.index[k * blend.pixels() + pixel], channel);
    for (std::size_t i = 0; i < knots; ++i)
      log_value[i] += static_cast<double>(weights[k]) * static_cast<double>(base[i]);
  }
  const std::size_t plane = static_cast<std::size_t>(channel) * blend.pixels() + pixel;
  return make_profile(blend.knots_mm, std::move(log_value),
                      blend.gain.empty() ? 1 : static_cast<double>(blend.gain[plane]),
                      blend.dilation.empty() ? 1 : static_cast<double>(blend.dilation[plane]));
}

void eval_slice(const ProfileBlend& blend, int channel, Offset offset, float* slice) {
  ProfilePlanes planes{.width = blend.width,
                       .height = blend.height,
                       .pixel_pitch_mm = blend.pixel_pitch_mm,
                       .knots_mm = &blend.knots_mm,
                       .dilated = !blend.dilation.empty()};
  if (!blend.gain.empty())
    planes.gain = blend.gain.data() + static_cast<std::size_t>(channel) * blend.pixels();
  std::vector<float> values(blend.bases());
  planes.interpolate = [&](std::size_t knot, float w, float* out) {
    for (std::size_t j = 0; j < values.size(); ++j) {
      const float* base = base_profile(blend, j, channel) + knot;
      values[j] = (1 - w) * base[0] + w * base[1];
    }
    mix_planes(blend, values, out);
  };
  planes.top = [&](float* out) { planes.interpolate(0, 0, out); };  // bases do not rise
  planes.profile = [&](int x, int y) { return get_profile(blend, channel, x, y); };
  eval_planes(planes, offset, slice);
}

ProfileMap make_profile_map(const ProfileBlend& blend) {
  ProfileMap map = make_profile_map(blend.width, blend.height, blend.channels, blend.pixel_pitch_mm,
                                    blend.knots_mm);
  map.boundary = blend.boundary;
  map.eta = blend.eta;
  map.gain = blend.gain;
  map.dilation = blend.dilation;
  map.hold_out = blend.hold_out;
  map.provenance = blend.provenance;
  std::vector<float> values(blend.bases());
  for (int c = 0; c < blend.channels; ++c)
    for (std::size_t knot = 0; knot < blend.knots_mm.size(); ++knot) {
      for (std::size_t j = 0; j < values.size(); ++j) values[j] = base_profile(blend, j, c)[knot];
      mix_planes(blend, values, knot_plane(map, c, static_cast<int>(knot)));
    }
  return map;
}

void snap_to_grid(ProfileBlend& blend, const BlendGrid& grid) {
  // Rounding is monotone: what did not rise does not rise after it.
  if (grid.profile_step > 0)
    for (float& value : blend.base_log_profile)
      value = static_cast<float>(std::round(static_cast<double>(value) / grid.profile_step) *
                                 grid.profile_step);
  if (grid.weight_levels > 0) snap_weights(blend, grid.weight_levels);
  blend.grid = grid;
}

std::size_t paper_bytes(const ProfileBlend& blend) {
  const auto channels = static_cast<std::size_t>(blend.channels);
  const auto per_pixel = static_cast<std::size_t>(blend.per_pixel);
  const std::size_t index_bytes = blend.bases() <= 256 ? 1 : 2;
  return 4 * channels * blend.bases() * blend.knots_mm.size() +
         blend.pixels() * (per_pixel * index_bytes + 4 * (per_pixel - 1));
}

}  // namespace parian

// Small tables for the tests of judging.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"
#include "material/bssrdf_table.h"

namespace parian::testing_tables {

inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();

inline BssrdfTable make_table(int width, int height, int channels, std::vector<Offset> offsets,
                              double pitch = 1) {
  TableHeader header;
  header.width = width;
  header.height = height;
  header.channels = channels;
  header.pixel_pitch_mm = pitch;
  header.offsets = std::move(offsets);
  return make_bssrdf_table(std::move(header));
}

// Log-uniform values that fall with distance, some of them missing.
inline void fill_random(BssrdfTable& table, std::uint64_t seed, double missing = 0) {
  Rng rng = make_rng(seed);
  for (int c = 0; c < table.header.channels; ++c)
    for (std::size_t d = 0; d < table.header.offsets.size(); ++d) {
      const Offset offset = table.header.offsets[d];
      const PixelRange range = pairs_in_grid(table.header, offset);
      float* slice = slice_of(table, c, static_cast<int>(d));
      for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x) {
          const double value = std::exp(2 * sample_uniform(rng) - length_px(offset));
          const bool keep = sample_uniform(rng) >= missing;
          slice[y * table.header.width + x] = keep ? static_cast<float>(value) : nan;
        }
    }
}

// Offsets of the disc in both half planes.
inline std::vector<Offset> disc_offsets(double radius) {
  std::vector<Offset> offsets = half_disc_offsets(radius);
  for (std::size_t i = 0, half = offsets.size(); i < half; ++i)
    if (offsets[i] != Offset{}) offsets.push_back({-offsets[i].dx, -offsets[i].dy});
  return offsets;
}

inline float value_at(const BssrdfTable& table, int c, int d, int x, int y) {
  return slice_of(table, c, d)[y * table.header.width + x];
}

}  // namespace parian::testing_tables

// Small heterogeneous tables for the tests of fit.
#pragma once

#include <cmath>
#include <limits>

#include "base/random.h"
#include "fit/reduced_system.h"
#include "material/bssrdf_table.h"

namespace parian {

// Exponential falls whose rate is averaged over both ends and the middle: outside the models' span.
inline BssrdfTable make_test_table(int width, int height, double radius, int channels = 1,
                                   bool symmetric = true) {
  TableHeader header;
  header.width = width;
  header.height = height;
  header.channels = channels;
  header.pixel_pitch_mm = 0.5;
  header.symmetric = symmetric;
  for (Offset offset : half_disc_offsets(radius, width, height)) {
    header.offsets.push_back(offset);
    if (!symmetric && offset != Offset{}) header.offsets.push_back({-offset.dx, -offset.dy});
  }
  BssrdfTable table = make_bssrdf_table(header);
  const auto rate = [](double x, double y, int c) {
    return 0.4 + 0.15 * std::sin(0.9 * x + 0.1 * c) * std::cos(0.7 * y);
  };
  for (int c = 0; c < channels; ++c) {
    for (std::size_t i = 0; i < header.offsets.size(); ++i) {
      const Offset d = header.offsets[i];
      const PixelRange range = pairs_in_grid(header, d);
      float* slice = slice_of(table, c, static_cast<int>(i));
      for (int y = range.y0; y < range.y1; ++y) {
        for (int x = range.x0; x < range.x1; ++x) {
          const double k = (rate(x, y, c) + rate(x + d.dx, y + d.dy, c) +
                            rate(x + 0.5 * d.dx, y + 0.5 * d.dy, c)) /
                           3;
          slice[y * width + x] =
              static_cast<float>(0.2 * std::exp(-k * length_px(d)) / (1 + 0.3 * length_px(d)));
        }
      }
    }
  }
  return table;
}

// Removes about `fraction` of the pairs, never (0,0).
inline void remove_pairs(BssrdfTable& table, double fraction, std::uint64_t seed) {
  const TableHeader& header = table.header;
  for (int c = 0; c < header.channels; ++c)
    for (std::size_t i = 0; i < header.offsets.size(); ++i) {
      if (header.offsets[i] == Offset{}) continue;
      float* slice = slice_of(table, c, static_cast<int>(i));
      for (std::size_t x = 0; x < header.pixels(); ++x)
        if (hash_to_uniform(hash_u64(hash_u64(seed, x), i)) < fraction)
          slice[x] = std::numeric_limits<float>::quiet_NaN();
    }
}

// Knots a pixel of make_test_table apart.
inline ReducedParams make_test_params(int segments) {
  ReducedParams params;
  params.lambda = 0.1;
  for (int k = 0; k <= segments; ++k) params.knots_mm.push_back(0.5 * k);
  return params;
}

}  // namespace parian

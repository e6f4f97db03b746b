// Small materials for tests of the compression.
#pragma once

#include <cmath>

#include "base/random.h"
#include "material/bssrdf_table.h"
#include "material/material.h"

namespace parian {

// Exponential profiles whose albedo and range vary smoothly over the sample and jump once, with
// noise: no two pixels are alike.
inline ProfileMap make_test_map(int width = 14, int height = 12, int channels = 3, int knots = 6) {
  std::vector<double> knots_mm(static_cast<std::size_t>(knots));
  for (std::size_t k = 0; k < knots_mm.size(); ++k) knots_mm[k] = 0.5 * static_cast<double>(k);
  ProfileMap map = make_profile_map(width, height, channels, 0.5, knots_mm);
  Rng rng = make_rng(5);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double jump = x > width / 2 ? 0.8 : 0;
      const double noise = 0.1 * sample_normal(rng);
      for (int c = 0; c < channels; ++c)
        for (int k = 0; k < knots; ++k) {
          const double r = knots_mm[static_cast<std::size_t>(k)];
          const double slope = 1.2 + 0.3 * c + 0.4 * std::sin(0.5 * y) + jump;
          knot_plane(map, c, k)[y * width + x] =
              static_cast<float>(-1 + jump + noise - slope * r - 0.05 * r * r);
        }
    }
  return map;
}

// All pairs within the map's last knot.
inline std::vector<Offset> test_offsets(const ProfileMap& map) {
  return half_disc_offsets(map.knots_mm.back() / map.pixel_pitch_mm);
}

// The map's own table, with `noise` in the logarithm.
inline BssrdfTable make_test_table(const ProfileMap& map, double noise = 0) {
  const Material material = map;
  TableHeader like = natural_header(material);
  like.offsets = test_offsets(map);
  BssrdfTable table = read_table(*make_slices(material, like));
  Rng rng = make_rng(9);
  for (float& value : table.reflectance)
    if (!std::isnan(value)) value *= static_cast<float>(std::exp(noise * sample_normal(rng)));
  return table;
}

}  // namespace parian

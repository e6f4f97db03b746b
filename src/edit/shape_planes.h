// The profiles of a map as edits see them: what shape edits change, with the albedo and range that
// the knots alone have. Gain and dilation multiply those.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "base/aligned.h"
#include "material/profile_map.h"

namespace parian {

// Pixels that kernels treat side by side; the last block of a plane may be shorter.
inline constexpr std::size_t shape_lanes = 64;

struct ShapePlanes {
  AlignedVector<float> log_profile;  // [channel][knot][y][x], as of a ProfileMap
  std::vector<double> albedo;        // [channel][y][x], 2 pi C of the knots
  std::vector<double> range_mm;      // [channel][y][x], alpha of the knots
};

// What the kernels need of the knots.
struct KnotTable {
  std::vector<double> radius;         // as in the map, increasing from 0
  std::vector<float> radius_float;    // the same
  std::vector<float> inverse_length;  // of segments
};
KnotTable make_knot_table(const std::vector<double>& knots_mm);

// Albedo 2 pi C and range alpha of `count` <= shape_lanes profiles, knot k of profile i at
// log_value[k * stride + i]: as diffuse_albedo and profile_range, to 1e-12.
void measure_shapes(const KnotTable& knots, const float* log_value, std::size_t stride,
                    std::size_t count, double* albedo, double* range_mm);

// Measures all.
std::shared_ptr<const ShapePlanes> make_shape_planes(AlignedVector<float> log_profile,
                                                     const std::vector<double>& knots_mm,
                                                     std::size_t pixels, int channels);

}  // namespace parian

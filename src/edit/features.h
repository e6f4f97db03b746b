// What a pixel looks like, as a short vector whose Euclidean distance is the distance of appearance
// that strokes propagate by: SubEdit's profile distance (Song et al. 2009, Eq. 11) embedded and
// reduced by principal components, or simpler quantities.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "material/profile_map.h"
#include "material/slices.h"

namespace parian {

// Scaled so that the squared distance of two pixels, averaged over all ordered pairs, is 1; all
// zeros where all pixels are equal. Components are in order of falling variance, with mean 0.
struct Features {
  int width = 0;
  int height = 0;
  int dims = 0;
  std::vector<float> values;  // [pixel][dim]

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

double feature_distance_squared(const Features& features, std::size_t a, std::size_t b);

// Eq. 11, d^2 = integral of (P_a - P_b)^2 r dr summed over the channels, embedded: components
// sqrt(c_q) P(r_q) of all channels, with two Gauss nodes r_q for each segment between knots and
// weights c_q that include r (error < 2 % where P falls by less than e per segment), then the first
// `dims` principal components. Gain and dilation count.
Features make_profile_features(const ProfileMap& map, int dims = 6);

// The same with ln P instead of P and without the factor r: every radius counts alike, dark
// channels as much as bright ones. Values below e^-16 of the map's largest count as e^-16.
Features make_log_profile_features(const ProfileMap& map, int dims = 6);

// Raw vectors [pixel][raw_dim], for example Lab pixels of a photograph: Euclidean distance, scaled
// and reduced. Throws Error naming the pixel when a value is not finite.
Features make_features(int width, int height, int raw_dims, const std::vector<float>& values,
                       int dims = 6);

// Planes [plane][y][x] of different units, for example ln albedo and ln range: each is divided by
// its standard deviation first. Throws Error naming the pixel when a value is not finite.
Features make_property_features(int width, int height, int planes, const std::vector<float>& values,
                                int dims = 6);

// Distance of raw scattering, sum over offsets d of (R(x, x + d) - R(y, y + d))^2: depends on what
// lies around a pixel, which is why Eq. 11 propagates better (Fig. 7). Unmeasured values count as
// 0. Slices are streamed through a seeded random projection to 32 dims, whose squared distances
// scatter by 25 % (standard deviation) around the exact ones.
Features make_bssrdf_features(const SliceSource& source, int dims = 6, std::uint64_t seed = 1);

}  // namespace parian

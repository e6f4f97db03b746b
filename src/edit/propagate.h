// Sparse strokes to soft masks over all pixels (AppWand, Pellacini and Lawrence 2007, on a sparse
// graph): one indicator per stroke, all solved together.
//
//   E(e) = sum_strokes w_i (e_i - g_i)^2 + lambda sum_edges a_ij (e_i - e_j)^2
//        + direct sum_i sum_t z_it (e_i - [t = s])^2 + prior sum_i e_i^2
//
// for the indicator e of stroke s: g_i = 1 on its own pixels, 0 on other strokes' pixels,
// a_ij = exp(-d_ij^2 / sigma), d the distance of features. z_it = exp(-d^2 / sigma) to the nearest
// pixel of stroke t in appearance is AppProp's term between strokes and all pixels (An and
// Pellacini 2008). It is what makes sigma a range: edges to nearest neighbours alone have d^2 far
// below sigma, and how far a stroke reaches along them depends on the number of pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/params.h"
#include "edit/features.h"
#include "edit/neighbours.h"

namespace parian {

struct PropagateParams {
  double sigma = 0.2;       // range of appearance; 1 is the mean over random pairs
  double strength = 1;      // lambda relative to default_smoothness / k
  double direct = 0.002;    // 0: AppWand's energy, along edges alone
  double prior = 1e-5;      // pulls what no stroke reaches to 0
  double tolerance = 1e-5;  // relative residual
  int max_iterations = 500;
  // The rest of the image competes: each pixel is pulled to 0 with weight direct (1 - max_t z_it).
  // For strokes that are all positive, so that their mask falls off as exp(-d^2 / sigma).
  bool rest = false;
};
ParamList describe(PropagateParams& params);
Param appearance_sigma_param(double& sigma);  // of either solver

// lambda = strength default_smoothness / k: all edges of a pixel together weigh 1/50 of a stroke.
inline constexpr double default_smoothness = 0.02;
// Edges in the image, where the pixels are not neighbours in appearance too, count this much: they
// close holes and smooth noise, but must not carry a stroke across its material's border as four
// of sixteen similar pixels would.
inline constexpr double spatial_factor = 0.25;

struct StrokePixel {
  std::uint32_t pixel = 0;  // y * width + x
  float weight = 1;         // >= 0
  int stroke = 0;
};

// Indicators are in [0, 1] and sum to at most 1, up to rounding and the solver's tolerance.
struct Propagation {
  int width = 0;
  int height = 0;
  int strokes = 0;
  std::vector<float> indicators;  // [stroke][y][x]
  int iterations = 0;
  double residual = 0;      // relative, the worst stroke's
  std::size_t clamped = 0;  // values that were outside [0, 1]
};

// Throws Error when no stroke pixel has a positive weight, a weight is negative or not finite, or
// the features are not the graph's. Pixels and strokes must be in range.
Propagation propagate(const NeighbourGraph& graph, const Features& features,
                      const std::vector<StrokePixel>& pixels, int strokes,
                      const PropagateParams& params = {});

// The mask of some strokes against the others: the sum of the positive strokes' indicators over the
// sum of all, fading to 0 where that is below 1e-3: no stroke reaches. When all strokes are
// positive the sum itself: then the prior, and with `rest` the rest of the image, is what they
// compete with.
std::vector<float> normalise_indicators(const Propagation& propagation,
                                        const std::vector<bool>& positive);

}  // namespace parian

// Sums of irradiance samples over basis functions of distance (Xu et al. 2007, Eq. 10):
//
//   T_j(x_o)[c] = sum_i B_j(|x_o - x_i|) flux_i[c],   0 beyond the last knot
//
// Hierarchy. A node is taken as a whole where its size is at most `opening` times its distance. Of
// the distances to its samples it keeps, by flux, the mean of each channel, and the variance of all
// (from centroid and covariance, to third order in size / distance): half the flux goes to mean
// minus and half to mean plus one standard deviation. That two-point rule is exact for cubic curves
// of distance, so what is left of a curve that falls like r^-p is at most of the order of
// p^4 (size / distance)^4 / 400 of the node's own part, and less as nodes differ. Certified is
// less: distances and both points lie in the range of the node's box, so T_j is off by no more than
// the sum over nodes of flux (max B_j - min B_j) over that range.
//
// Near term. Functions near 0 are narrower than the samples' spacing, where a plain sum aliases. As
// in gather.h, B_j = B_j w + B_j (1 - w), w = 1 up to near_mm / 2 and 0 from near_mm; the part B_j
// w of samples on the target's own side keeps its integral over a plane, I_j = 2 pi int B_j w r dr:
// the sum is scaled by I_j / sum B_j w area within what its number of samples allows, and of
// functions that hardly see a sample it is I_j times the mean irradiance around the target. So a
// plane under constant irradiance I has T_j = 2 pi I int B_j r dr, however narrow B_j.
#pragma once

#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "math/spline_basis.h"
#include "transport/gather.h"

namespace parian {

struct RadialMomentParams {
  double opening = 0.5;  // 0: every sample by itself
  bool certify = false;  // fill RadialMoments::bound; not a flag of commands
};
ParamList describe(RadialMomentParams& params);

struct RadialMoments {
  std::vector<float> value;     // [target][function][channel]; W where flux is in W
  std::vector<float> bound;     // likewise, of |T_j - T_j by every sample| but for rounding
  double nodes_per_target = 0;  // nodes and samples that were evaluated
};

// The basis starts at 0. near_mm: see default_near_mm; 0: the plain sum. The same bits for any
// number of threads.
RadialMoments compute_radial_moments(const SplineBasis& basis, const GatherSources& sources,
                                     const std::vector<GatherPoint>& targets, double near_mm,
                                     const RadialMomentParams& params = {},
                                     const Progress& progress = {});

}  // namespace parian

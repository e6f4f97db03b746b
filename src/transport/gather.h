// The second pass of two-pass subsurface rendering (Jensen and Buhler 2002), for heterogeneous
// radial profiles: radiant exitance at targets from flux that entered at the samples,
//
//   M(o) = sum_i R_d(i, o) flux_i,   R_d(i, o) = exp(h_i(r) + h_o(r)),  r = |x_i - x_o|,
//
// zero beyond either support. Brute force is the reference; moment_tree.h is the fast one.
//
// Near term. Samples closer than near_mm (a few spacings) would alias sharp profiles. There the
// kernel is split smoothly, R = R w + R (1 - w), w(r) = (1 - (r/near_mm)^2)^2, and the part R w of
// samples on the target's own side (normals in the same hemisphere) is scaled so that it keeps its
// integral over a plane: S I / W with S = sum R w flux, W = sum P_o w area, I = int P_o w dA, I / W
// at most 1 + 2 / (n - 1) or its inverse for n samples, so that edges and spikes stay what they
// are. A profile narrower than the spacing scatters like a Lambertian surface, and no target is
// left without light. near_mm = 0 is the plain sum, which is reciprocal.
#pragma once

#include <cstddef>
#include <vector>

#include "base/progress.h"
#include "material/profile_field.h"
#include "math/vec.h"

namespace parian {

// Where a profile is taken from: a surface point and its place in the sample, in pixels.
struct GatherPoint {
  Vec3 position;  // mm
  Vec3 normal;    // unit, outward
  float x = 0;
  float y = 0;
};

// Samples of one area each with the flux that entered there.
struct GatherSources {
  std::vector<GatherPoint> points;
  std::vector<Rgb> flux;  // irradiance (transmitted) times area
  double area_mm2 = 0;    // of each
};

// How the near term is set: near_mm for sources of this area.
double default_near_mm(double area_mm2);

// For each target the exitance in W/mm^2 (flux in W), range-limited and vectorised. The same bits
// for any number of threads.
std::vector<Rgb> gather_brute(const ProfileField& field, const GatherSources& sources,
                              const std::vector<GatherPoint>& targets, double near_mm,
                              const Progress& progress = {});

}  // namespace parian

// Single scattering of a homogeneous material by direct integration (Xu et al. 2007, Eq. 5-7),
// without basis functions and without depth maps: what edits are compared with.
//
//   L(x_o, w_o) = F_t(w_o) sigma_s int int p F_t(w_i) e^{-sigma_t (s_i' + s)} L ds dw
//
// p = (1 - 3 g w_i' . w_o') / 4 pi with both directions pointing away from the medium and g clamped
// to [-1/3, 1/3]; sigma_s = sigma_s' / (1 - g) and sigma_t = sigma_a + sigma_s with g as it is.
#pragma once

#include <cstdint>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "material/dipole.h"
#include "mesh/ray_tracer.h"
#include "scene/scene.h"

namespace parian {

// Where a place looks for scattered light: along its normal, as transport does, or along the
// refracted view direction.
enum class ScatteringPath { normal, view };

struct SingleReferenceParams {
  ScatteringPath path = ScatteringPath::normal;
  int path_samples = 64;  // per channel, placed by its sigma_t
  int directions = 128;   // of an environment light: those of transport for the same seed
  std::uint64_t seed = 1;
};
ParamList describe(SingleReferenceParams& params);

// One view of a surface point.
struct SurfaceView {
  SurfacePoint point;
  Vec3 to_eye;  // unit, w_o
};

// Radiance of each view, W / (m^2 sr) per channel; 0 where the surface looks away. A material of
// one channel has it for all. The same bits for any number of threads.
std::vector<Rgb> integrate_single_scattering(const std::vector<SurfaceView>& views,
                                             const std::vector<Light>& lights,
                                             const TriangleMesh& mesh, const RayTracer& tracer,
                                             const Dipole& material,
                                             const SingleReferenceParams& params = {},
                                             const Progress& progress = {});

}  // namespace parian

// Irradiance at surface points under a scene's lights, with visibility.
//
//   E(x) = int L(w) V(x, w) F(w) (n . w) dw,  F = Fresnel transmission into eta where the
//   material's boundary is excluded, otherwise 1
#pragma once

#include <cstdint>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "mesh/ray_tracer.h"
#include "scene/scene.h"

namespace parian {

struct IrradianceParams {
  int rays = 128;  // per point and environment light: brightness and cosine, half each (MIS)
  std::uint64_t seed = 1;
};
ParamList describe(IrradianceParams& params);

// The parameters that all have in common which scatter the light that enters at samples.
Param describe_samples(int& samples, double most = 20'000'000);
Param describe_rays(int& rays);
Param describe_seed(std::uint64_t& seed);  // of both

// Fresnel transmission of unpolarised light from outside at cosine `cos_theta` into index eta.
float fresnel_transmission(float eta, float cos_theta);

// W/m^2 per channel at each point. Point and directional lights are exact; environment lights have
// independent noise at each point, but for a common part 1 / sqrt(sets) as large, where sets of
// directions drawn by brightness are shared: 2^19 / (rays / 2) sets, at most one per point.
// `boundary` and `eta` are the material's. The same bits for any number of threads.
std::vector<Rgb> compute_irradiance(const std::vector<SurfacePoint>& points,
                                    const std::vector<Light>& lights, const RayTracer& tracer,
                                    Boundary boundary, double eta,
                                    const IrradianceParams& params = {},
                                    const Progress& progress = {});

}  // namespace parian

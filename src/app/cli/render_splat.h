// `parian render --method splat`: pictures by the OpenGL renderer, reported as the CPU's are.
#pragma once

#include <functional>

#include "render/render.h"
#include "transport/homogeneous_transport.h"

namespace parian {

// A picture with another homogeneous material in place of the scene's, or with that (null). The
// scene must outlive the function. Throws Error where there is no OpenGL ES 3.0, for layers, and
// for tables without a fit.
std::function<RenderResult(const Dipole* material)> make_splat_frames(const Scene& scene,
                                                                      const RenderParams& params,
                                                                      const Progress& progress);

// The same from precomputed transport of the scene's mesh and lights, which is copied to the
// device.
std::function<RenderResult(const Dipole* material)> make_live_frames(
    const Scene& scene, const HomogeneousTransport& transport, const RenderParams& params);

}  // namespace parian

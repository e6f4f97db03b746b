// `parian render --method splat`: pictures by the OpenGL renderer, reported as the CPU's are.
#pragma once

#include <functional>

#include "render/render.h"

namespace parian {

// A picture with another homogeneous material in place of the scene's, or with that (null). The
// scene must outlive the function. Throws Error where there is no OpenGL ES 3.0, for layers, and
// for tables without a fit.
std::function<RenderResult(const Dipole* material)> make_splat_frames(const Scene& scene,
                                                                      const RenderParams& params,
                                                                      const Progress& progress);

}  // namespace parian

// Layers over a material (scene/scene.h) for splatting: every sample and every pixel has a profile
// of its own, evaluated on the CPU (transport/layered_field.h), so that textures hold one texel for
// each of them.
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "gl/surface_view.h"
#include "material/profile_field.h"
#include "mesh/ray_tracer.h"
#include "scene/scene.h"

namespace parian {

// Sample i lies at sample_place(i) of the field's grid. Null where no layer counts at any of them.
std::optional<ProfileField> make_sample_field(const Scene& scene,
                                              const std::vector<SurfacePoint>& samples);
Vec2 sample_place(std::size_t index);

// A field whose grid is the picture's, n x n pixels drawn to one of it: the profile at the surface
// that the middle of a pixel sees, or another part of it, or a neighbour. Empty elsewhere.
ProfileField make_pixel_field(const Scene& scene, const RayTracer& tracer,
                              const SplatCamera& camera, int antialias, const Progress& progress);

}  // namespace parian

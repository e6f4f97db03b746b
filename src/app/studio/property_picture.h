// Pictures of what the material and the light are at each point, without scattering.
#pragma once

#include "app/studio/stage.h"
#include "edit/mask.h"
#include "image/image.h"
#include "material/material.h"

namespace parian {

// The grid that a material has on a surface.
SampleGrid grid_of(const Material& material);

// Albedo (2 pi C), or the range in false colours with the materials' largest as full scale; a
// little darker where the surface turns away.
Image draw_property(const Stage& stage, const Material& material, const StageLayers& layers,
                    const Camera& camera, bool is_albedo);
// E / pi, as a white diffuse surface would look.
Image draw_irradiance(const Stage& stage, const Material& material,
                      const std::vector<Light>& lights, const Camera& camera);
// On top of a picture from the same camera: edges of triangles; where the mask selects, in red.
void draw_wireframe(const Stage& stage, const Camera& camera, Image& image);
void draw_mask(const Stage& stage, const Material& material, const Mask& mask, const Camera& camera,
               Image& image);
void draw_mask(const Stage& stage, const SurfaceMask& mask, const Camera& camera, Image& image);

}  // namespace parian

// The figures of docs/homogeneous.md, section by section (Xu et al. 2007).
#pragma once

#include "bench/common/page.h"
#include "material/dipole.h"
#include "scene/scene.h"

namespace parian {

// The dragon, 60 mm long, under an environment.
Scene make_dragon_scene(int width, int height, const Dipole& material);

// The diffusion models' totals and curves, and what they look like.
void study_models(const Page& page);
// Fig. 1 and 2: bases for R_d and E at equal numbers of coefficients.
void study_bases(const Page& page);
// Radiance from a few functions against many, against brute force and direct integration.
void study_accuracy(const Page& page);
// Table 2: time, storage and updates per second on meshes of several sizes.
void study_speed(const Page& page, bool with_largest);
// Fig. 3 to 7.
void study_pictures(const Page& page);

}  // namespace parian

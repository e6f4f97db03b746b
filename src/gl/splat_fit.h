// What splats carry in place of profiles: in each channel a cubic in r whose eighth power is what a
// source sends. It is fitted once per edit and light, so that a splat's texels cost neither an
// exponential nor a search for nodes.
#pragma once

#include "gl/material_textures.h"
#include "gl/objects.h"
#include "gl/sources.h"

namespace parian {

// Eighth root of k / w_near, a cubic in r: k weighs the near term's samples (splat_fragment.glsl)
// and has the integral 1 over a plane.
Vec4 make_near_kernel(const ReferenceProfile& reference, double near_mm);

struct FitPrograms {
  Program single, group;
};
FitPrograms make_fit_programs();

// After group_sources.
void fit_sources(Sources& sources, const FitPrograms& programs, const RadialLevels& radial,
                 const ReferenceProfile& reference);

}  // namespace parian

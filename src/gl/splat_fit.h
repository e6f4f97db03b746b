// What splats carry in place of profiles: in each channel a polynomial in r of the logarithm of
// what a source sends. It is fitted once per edit and light, so that a splat costs one exponential
// a channel and no search for nodes.
#pragma once

#include "gl/material_textures.h"
#include "gl/objects.h"
#include "gl/sources.h"

namespace parian {

struct FitPrograms {
  Program single, group;
};
FitPrograms make_fit_programs();

// After group_sources.
void fit_sources(Sources& sources, const FitPrograms& programs, const RadialLevels& radial,
                 const ReferenceProfile& reference);

}  // namespace parian

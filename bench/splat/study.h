// The studies behind docs/splatting.md.
#pragma once

#include "bench/common/assets.h"
#include "bench/common/page.h"
#include "gl/context.h"
#include "gl/splat_renderer.h"
#include "material/material.h"

namespace parian {

// data/stone-72x64.h5, fitted, and compressed to two base materials per pixel.
const ProfileMap& stone_map();
const ProfileBlend& stone_blend();
Dipole make_marble(double scale = 1);
void set_from_environment(SplatParams& params);

void study_accuracy(const Page& page, const GlLimits& limits);

}  // namespace parian

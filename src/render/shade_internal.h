// From exitance to radiance, and from hits to pixels.
#pragma once

#include <vector>

#include "base/progress.h"
#include "image/image.h"
#include "render/primary_internal.h"
#include "render/render.h"

namespace parian {

// The whole picture. `exitance` is per target of the view, or per vertex with vertex shading.
Image shade(const Scene& scene, const RayTracer& tracer, const PrimaryView& view,
            const std::vector<Rgb>& exitance, const RenderParams& params, const Progress& progress);

}  // namespace parian

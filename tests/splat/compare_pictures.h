// The real-time renderer beside the CPU's, picture by picture.
#pragma once

#include <string>

#include "gl/splat_renderer.h"
#include "image/metrics.h"
#include "render/render.h"

namespace parian {

// The CPU's picture of a scene, every sample for every pixel's one ray, no reflection.
Image render_reference(Scene scene, int samples, int rays);

// For a failed comparison: writes NAME.png, NAME-reference.png and NAME-difference.png (ten times
// the difference around grey) into the folder of temporary files and returns a line that says so.
std::string dump_pictures(const std::string& name, const Image& reference, const Image& image);

}  // namespace parian

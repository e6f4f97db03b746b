// The real-time renderer beside the CPU's, picture by picture.
#pragma once

#include <string>
#include <vector>

#include "gl/splat_renderer.h"
#include "image/metrics.h"
#include "render/render.h"

namespace parian {

// The CPU's picture of a scene, every sample for every pixel's one ray, no reflection.
Image render_reference(Scene scene, int samples, int rays);

// For a failed comparison: writes NAME.png, NAME-reference.png and NAME-difference.png (ten times
// the difference around grey) into the folder of temporary files and returns a line that says so.
std::string dump_pictures(const std::string& name, const Image& reference, const Image& image);

// At most 2 % on average and 8 % at the 99th percentile, which are recorded; otherwise dumped.
void expect_close(const Image& reference, const Image& image, const std::vector<float>& coverage,
                  const std::string& name);

}  // namespace parian

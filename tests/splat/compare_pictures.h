// The real-time renderer beside the CPU's, picture by picture.
#pragma once

#include <string>
#include <vector>

#include "gl/splat_renderer.h"
#include "render/render.h"

namespace parian {

struct PictureErrors {
  double mean = 0, p99 = 0, max = 0;  // relative, over pixels
  std::size_t pixels = 0;
};

// |a - b| / (|b| + 1e-3 max |b|), lengths over channels, over pixels that are covered in both
// (black in none).
PictureErrors compare_pictures(const Image& reference, const Image& image,
                               const std::vector<float>& coverage);

// The CPU's picture of a scene, every sample for every pixel's one ray, no reflection.
Image render_reference(Scene scene, int samples, int rays);

// For a failed comparison: writes NAME.png, NAME-reference.png and NAME-difference.png (ten times
// the difference around grey) into the folder of temporary files and returns a line that says so.
std::string dump_pictures(const std::string& name, const Image& reference, const Image& image);

}  // namespace parian

// The demo's last step: a material on a real mesh, from the fitted profiles and from the table
// without a fit, side by side.
#pragma once

#include <string>

#include "base/progress.h"

namespace parian {

struct ShapePictures {
  std::string map;     // path of the fitted map
  std::string table;   // path of the table that it was fitted to
  std::string assets;  // folder of fetched meshes and environments, may be empty
  std::string folder;  // where pictures go
  bool small = false;  // few pixels and samples
};

// Writes shape.png and shape-{fit,table,difference}.png into the folder; returns the page's
// section.
std::string make_shape_pictures(const ShapePictures& pictures, const Progress& progress);

}  // namespace parian

// Scene to scene description: what read_scene reads back as it was.
#pragma once

#include "base/document.h"
#include "scene/scene.h"

namespace parian {

// Meshes, images and materials other than coefficients are written as the files that they are from:
// what they hold is not looked at. Throws Error for one that is from no file.
Document write_scene(const Scene& scene);

}  // namespace parian

// Scene descriptions (docs/rendering.md, data/schema/scene.schema.json): JSON to Scene.
#pragma once

#include <functional>
#include <string>

#include "base/document.h"
#include "scene/scene.h"

namespace parian {

// What a description refers to by path; io and app supply them. Each throws Error naming the file.
struct SceneLoaders {
  std::function<TriangleMesh(const std::string& path)> load_mesh;
  std::function<Image(const std::string& path)> load_image;
  std::function<SurfaceMaterial(const std::string& path)> load_material;
  std::function<Document(const std::string& path)> load_document;  // JSON
};

// Relative paths are resolved against the document's folder by the loaders, which get them as
// written. Errors name file and JSON pointer. Unknown keys are errors.
// Lights and layers that are not enabled are checked, too, and left out unless they shall be kept.
enum class Disabled { drop, keep };
Scene read_scene(const Document& document, const SceneLoaders& loaders,
                 Disabled disabled = Disabled::drop);

}  // namespace parian

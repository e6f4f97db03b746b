#include "app/studio/studio_files.h"

#include <algorithm>
#include <exception>

#include "app/studio/stage_layers.h"
#include "image/color.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/image/image_file.h"
#include "io/json/json.h"

namespace parian {

void save_recipe(Studio& studio, const std::string& path) {
  try {
    if (studio.snapshot == nullptr) return;
    save_document(path, studio.snapshot->recipe);
    studio.recipe_path = path;
    studio.saved_version = studio.snapshot->version;
    remember(studio, path);
    report(studio, "saved " + path);
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

void save_map(Studio& studio, const std::string& path) {
  if (studio.snapshot == nullptr) return;
  studio.jobs.start("save " + path,
                    [&studio, path, map = studio.snapshot->map](const Progress&) -> Jobs::Finish {
                      save_profile_map(path, *map);
                      return [&studio, path] { report(studio, "saved " + path); };
                    });
}

void save_picture(Studio& studio, const std::string& path) {
  const bool has_refined = studio.refined != nullptr && studio.refined->id == studio.request_id;
  const std::shared_ptr<const Picture> picture = has_refined ? studio.refined : studio.picture;
  if (picture == nullptr) return;
  try {
    Image image = make_image(picture->width, picture->height, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i)
      image.values[i] = decode_srgb(static_cast<float>(picture->rgba[i / 3 * 4 + i % 3]) / 255.0f);
    save_image(path, image);
    report(studio, "saved " + path);
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

void save_compressed(Studio& studio, std::size_t index, const std::string& path) {
  if (index >= studio.compressed.size()) return;
  try {
    save_blend(path, *studio.compressed[index].blend, BlendEncoding::packed);
    report(studio, "saved " + path);
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

std::string what_is_unsaved(const Studio& studio) {
  const bool recipe = studio.snapshot != nullptr && !studio.snapshot->layers.empty() &&
                      studio.snapshot->version != studio.saved_version;
  const bool masks =
      std::any_of(studio.layers.begin(), studio.layers.end(), [&](const auto& layer) {
        const StageLayers& saved = studio.saved_layers;
        return mask_kind_names()[mask_kind_of(layer->mask)] == "painted" &&
               std::find(saved.begin(), saved.end(), layer) == saved.end();
      });
  if (recipe && masks) return "The recipe and painted masks of the surface are not saved.";
  if (masks) return "Painted masks of the surface are not saved (File, Save scene as).";
  return recipe ? "The recipe is not saved." : "";
}

}  // namespace parian

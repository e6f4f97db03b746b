#include "app/studio/stage_layers.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace parian {

void add_stage_layer(Studio& studio, SurfaceLayer layer) {
  if (studio.layers.size() >= max_layers)
    throw Error({{}, "layers", "at most 16 on a surface", "another one"}, ErrorKind::usage);
  if (studio.stage != nullptr) layer.mapping = studio.stage->scene.mapping;
  studio.selected_stage_layer = studio.layers.size();
  studio.layers.push_back(std::make_shared<const SurfaceLayer>(std::move(layer)));
  touch_view(studio);
}

void set_stage_layer(Studio& studio, std::size_t index, SurfaceLayer layer) {
  studio.layers.at(index) = std::make_shared<const SurfaceLayer>(std::move(layer));
  touch_view(studio);
}

void move_stage_layer(Studio& studio, std::size_t from, std::size_t to) {
  if (from >= studio.layers.size() || to >= studio.layers.size()) return;
  const auto moved = studio.layers[from];
  studio.layers.erase(studio.layers.begin() + static_cast<std::ptrdiff_t>(from));
  studio.layers.insert(studio.layers.begin() + static_cast<std::ptrdiff_t>(to), moved);
  studio.selected_stage_layer = to;
  touch_view(studio);
}

void remove_stage_layer(Studio& studio, std::size_t index) {
  if (index >= studio.layers.size()) return;
  studio.layers.erase(studio.layers.begin() + static_cast<std::ptrdiff_t>(index));
  studio.selected_stage_layer.reset();
  touch_view(studio);
}

const std::vector<std::string>& mask_kind_names() {
  static const std::vector<std::string> names{"everywhere", "painted", "gradient", "sphere",
                                              "slab",       "noise",   "stripes",  "of a file"};
  return names;
}

std::size_t mask_kind_of(const SurfaceMask& mask) {
  if (mask.empty()) return 0;
  const MaskShape& shape = mask.front().shape;
  if (const auto* painted = std::get_if<VertexMask>(&shape); painted && painted->file.empty())
    return 1;
  if (std::holds_alternative<GradientMask>(shape)) return 2;
  if (std::holds_alternative<SphereMask>(shape)) return 3;
  if (std::holds_alternative<SlabMask>(shape)) return 4;
  if (std::holds_alternative<NoiseMask>(shape)) return 5;
  if (std::holds_alternative<StripesMask>(shape)) return 6;
  return 7;
}

SurfaceMask make_mask(std::size_t kind, const Stage& stage) {
  const Bounds3& box = stage.box;
  const Vec3 size = extent(box), middle = center(box);
  const auto height = static_cast<double>(size.y);
  switch (kind) {
    case 1:
      return {{VertexMask{std::vector<float>(count_source_vertices(stage.scene.mesh))}}};
    case 2:
      return {{GradientMask{{middle.x, box.lower.y, middle.z}, {middle.x, box.upper.y, middle.z}}}};
    case 3:
      return {{SphereMask{box.upper, 0.4 * static_cast<double>(diagonal(box)), 0.1 * height}}};
    case 4:
      return {{SlabMask{middle, {0, 1, 0}, 0, 0.1 * height}}};
    case 5:
      return {{NoiseMask{.scale_mm = std::max(0.25 * height, 0.001)}}};
    case 6:
      return {
          {StripesMask{.period_mm = std::max(0.25 * height, 0.001), .feather_mm = 0.02 * height}}};
    default:
      return {};
  }
}

}  // namespace parian

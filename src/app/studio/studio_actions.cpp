// What menus and panels ask for: compression, homogeneous materials, undo.
#include <fmt/format.h>

#include <algorithm>

#include "app/studio/studio.h"
#include "compress/choose.h"
#include "compress/compress.h"
#include "io/blend/blend_file.h"

namespace parian {
namespace {

CompressedPoint compress_once(const ProfileMap& map, const CompressParams& params,
                              const Progress& progress) {
  const auto objective = make_blend_objective(map, nullptr, params.objective, progress);
  CompressState state = make_compress_state(map, objective, params);
  while (!state.done) {
    advance_progress(progress, fmt::format("{} base materials", params.bases), progress_of(state));
    advance(state);
  }
  const CompressErrors errors = estimate_errors(state);
  auto blend = std::make_shared<const ProfileBlend>(make_blend(state));
  return {.bases = params.bases,
          .per_pixel = params.per_pixel,
          .bytes = encode_blend(*blend, BlendEncoding::packed).size(),
          .relative_error = errors.relative,
          .albedo_error = errors.albedo,
          .blend = blend};
}

// In the order of the list, in place of one with the same numbers.
void insert_point(std::vector<CompressedPoint>& points, const CompressedPoint& point) {
  const auto key = [](const CompressedPoint& p) { return std::pair(p.per_pixel, p.bases); };
  const auto place = std::lower_bound(
      points.begin(), points.end(), point,
      [&](const CompressedPoint& a, const CompressedPoint& b) { return key(a) < key(b); });
  if (place != points.end() && key(*place) == key(point))
    *place = point;
  else
    points.insert(place, point);
}

void start_compression(Studio& studio, std::vector<int> counts) {
  if (counts.empty()) return;
  CompressParams params = studio.compression;
  params.bases = counts.front();
  params.weight_levels = default_weight_levels;
  params.profile_step = default_profile_step;
  counts.erase(counts.begin());
  studio.jobs.start(
      "compress",
      [&studio, params, counts,
       map = studio.snapshot->map](const Progress& progress) -> Jobs::Finish {
        const CompressedPoint point = compress_once(*map, params, progress);
        return [&studio, point, counts, map] {
          if (map != studio.snapshot->map) return;  // edited meanwhile
          const std::shared_ptr<const ProfileBlend> shown =
              studio.shown_compressed ? studio.compressed[*studio.shown_compressed].blend : nullptr;
          insert_point(studio.compressed, point);
          for (std::size_t i = 0; i < studio.compressed.size(); ++i)
            if (shown != nullptr && studio.compressed[i].blend == shown)
              studio.shown_compressed = i;
          start_compression(studio, counts);
        };
      });
}

void apply_scene(Studio& studio, const SceneState& state) {
  studio.lighting = state.lighting;
  studio.layers = state.layers;
  studio.exposure = state.exposure;
  studio.orbit = state.orbit;
  studio.homogeneous = state.homogeneous;
  if (state.is_homogeneous)
    set_homogeneous(studio, state.homogeneous);
  else
    leave_homogeneous(studio);
  touch_view(studio);
  note_scene_now(studio);  // as it was noted: makes no entry
}

std::size_t recipe_entries(const Studio& studio) {
  return studio.snapshot != nullptr ? studio.snapshot->history.size() : 0;
}

}  // namespace

Dipole first_homogeneous() {
  return {.channels = {{0.004, 1.2, 0}, {0.008, 1.3, 0}, {0.03, 1.5, 0}},
          .single_scattering = true};
}

void set_homogeneous(Studio& studio, Dipole material) {
  material.channels.resize(3, material.channels.front());
  studio.is_homogeneous = true;
  studio.homogeneous = material;
  studio.material = std::make_shared<const Material>(std::move(material));
  if (studio.edit_started_s < 0) studio.edit_started_s = studio.now_s;
  touch_view(studio);
}

void leave_homogeneous(Studio& studio) {
  if (!studio.is_homogeneous || studio.snapshot == nullptr) return;
  studio.is_homogeneous = false;
  studio.material = studio.snapshot->material;
  touch_view(studio);
}

void compress_map(Studio& studio) {
  if (studio.snapshot == nullptr) return;
  std::vector<int> counts;
  const int most =
      std::min<int>(studio.compression.bases, static_cast<int>(studio.snapshot->after.pixels()));
  for (int bases = std::max(studio.compression.per_pixel, most / 8); bases < most; bases *= 2)
    counts.push_back(bases);
  counts.push_back(most);
  start_compression(studio, std::move(counts));
}

void show_compressed(Studio& studio, std::optional<std::size_t> index) {
  if (studio.shown_compressed == index || studio.is_homogeneous) return;
  studio.shown_compressed = index;
  studio.material = index ? std::make_shared<const Material>(*studio.compressed.at(*index).blend)
                          : studio.snapshot->material;
  touch_view(studio);
}

void note_scene_now(Studio& studio) {
  if (studio.noted_stage != studio.stage) {
    forget_camera(studio.scene_history, studio.orbit);
    studio.noted_stage = studio.stage;
  }
  note_scene(studio.scene_history,
             {studio.is_homogeneous, studio.homogeneous, studio.lighting, studio.layers,
              studio.exposure, studio.orbit},
             recipe_entries(studio));
}

HistoryView view_history(const Studio& studio) {
  if (studio.snapshot == nullptr) return view_history(studio.scene_history, {}, {});
  return view_history(studio.scene_history, studio.snapshot->history, studio.snapshot->future);
}

void jump_to(Studio& studio, std::size_t position) {
  note_scene_now(studio);
  const HistoryView view = view_history(studio);
  const std::size_t target = std::min(position, view.rows.size());
  const bool forth = target > view.position;
  bool moves_recipe = false;
  for (std::size_t at = view.position; at != target; at = forth ? at + 1 : at - 1) {
    if (!view.rows[forth ? at : at - 1].is_scene) {
      moves_recipe = true;
      forth ? studio.editor->redo() : studio.editor->undo();
    } else if (const auto state =
                   forth ? redo_scene(studio.scene_history) : undo_scene(studio.scene_history)) {
      apply_scene(studio, *state);
    }
  }
  if (moves_recipe) touch_map(studio);
}

void undo(Studio& studio) {
  note_scene_now(studio);
  if (const std::size_t position = view_history(studio).position; position > 0)
    jump_to(studio, position - 1);
}

void redo(Studio& studio) {
  note_scene_now(studio);
  jump_to(studio, view_history(studio).position + 1);
}

}  // namespace parian

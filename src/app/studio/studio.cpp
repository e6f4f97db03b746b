#include "app/studio/studio.h"

#include <algorithm>

#include "app/studio/flat_picture.h"
#include "app/studio/studio_files.h"
#include "app/studio/tools.h"
#include "base/error.h"

namespace parian {

Camera make_view_camera(const Studio& studio, double scale) {
  const auto size = [&](int pixels) {
    return std::max(16, static_cast<int>(static_cast<double>(pixels) * scale));
  };
  return make_camera(studio.orbit, size(studio.view_width), size(studio.view_height));
}

std::shared_ptr<const Mask> shown_mask(const Studio& studio) {
  if (!studio.show_selection || studio.snapshot == nullptr || !studio.selected_layer ||
      *studio.selected_layer >= studio.snapshot->layers.size() || studio.tool == Tool::mask)
    return nullptr;
  return studio.snapshot->layers[*studio.selected_layer].mask;
}

std::shared_ptr<const SurfaceLayer> shown_layer_mask(const Studio& studio) {
  if (!studio.show_selection || studio.tool != Tool::mask || !studio.selected_stage_layer ||
      *studio.selected_stage_layer >= studio.layers.size())
    return nullptr;
  const StageLayers shown = shown_layers(studio);
  const auto& chosen = studio.layers[*studio.selected_stage_layer];
  return std::find(shown.begin(), shown.end(), chosen) != shown.end() ? chosen : nullptr;
}

void choose_tool(Studio& studio, Tool tool) {
  if (studio.tool == tool) return;
  const bool changes_red = studio.tool == Tool::mask || tool == Tool::mask;
  studio.tool = tool;
  if (studio.show_selection && changes_red) touch_view(studio);
}

StageLayers shown_layers(const Studio& studio) {
  if (studio.stage == nullptr || studio.material == nullptr) return {};
  return shown_layers(studio.layers, *studio.stage, *studio.material);
}

namespace {

constexpr double rest_s = 0.25;          // without changes, until the picture gets all its pixels
constexpr double autosave_rest_s = 0.5;  // between a change and its autosave

// Of the draft's size under layers, whose pixels have a profile of their own each: an edit is then
// seen about as soon as without.
constexpr double layered_scale = 0.7;

double draft_scale(const Studio& studio) {
  return studio.interactive_scale * (shown_layers(studio).empty() ? 1 : layered_scale);
}

void request_picture(Studio& studio, bool fine) {
  std::shared_ptr<const ReadyTransport> transport;
  std::vector<Rgb> scales;
  if (can_use_transport(studio) && studio.transport != nullptr)
    if (auto found = find_light_scales(*studio.transport, make_transport_key(studio))) {
      transport = studio.transport;
      scales = *std::move(found);
    }
  const bool is_live = transport != nullptr;
  PictureRequest request{
      .stage = studio.stage,
      .material = studio.material,
      .layers = shown_layers(studio),
      .before = studio.original,
      .mask = shown_mask(studio),
      .layer_mask = shown_layer_mask(studio),
      .transport = std::move(transport),
      .light_scales = std::move(scales),
      .lighting = only_enabled(studio.lighting),
      .camera = make_view_camera(studio, fine || is_live ? 1 : draft_scale(studio)),
      .mode = studio.mode,
      .exposure = studio.exposure,
      .fine = fine};
  studio.request_id = studio.pictures.request(std::move(request));
  studio.request_is_fine = fine;
  studio.is_stale = false;
}

// Changes of the light and of a homogeneous material, once they rest.
void update_scene_history(Studio& studio) {
  if (!studio.is_held && studio.now_s - studio.last_change_s >= rest_s) note_scene_now(studio);
}

void update_map(Studio& studio) {
  if (studio.editor == nullptr) return;
  const bool is_busy = studio.editor->activity().busy;
  studio.snapshot = studio.editor->snapshot();
  if (!is_busy) studio.pending_layer.reset();
  show_pending(studio);
  if (std::optional<std::string> error = studio.editor->take_error())
    report(studio, std::move(*error), true);
  if (studio.snapshot->version == studio.seen_version) return;
  studio.seen_version = studio.snapshot->version;
  const std::size_t layers = studio.snapshot->layers.size();
  if (layers == 0)
    studio.selected_layer.reset();
  else
    studio.selected_layer = std::min(studio.selected_layer.value_or(layers - 1), layers - 1);
  if (!studio.is_homogeneous) {
    studio.material = studio.snapshot->material;
    studio.shown_compressed.reset();
    studio.compressed.clear();
  }
  studio.inspected.x = std::clamp(studio.inspected.x, 0, studio.snapshot->after.width - 1);
  studio.inspected.y = std::clamp(studio.inspected.y, 0, studio.snapshot->after.height - 1);
  studio.flat_is_stale = true;
  touch_view(studio);
}

void update_view(Studio& studio) {
  if (std::optional<std::string> error = studio.pictures.take_error())
    report(studio, std::move(*error), true);
  studio.picture = studio.pictures.latest();
  const bool shows_newest = studio.picture != nullptr && studio.picture->id == studio.request_id;
  if (shows_newest && studio.edit_started_s >= 0 && !studio.is_stale) {
    studio.edit_shown_ms = 1e3 * (studio.now_s - studio.edit_started_s);
    studio.edit_started_s = -1;
  }
  if (studio.stage == nullptr || studio.material == nullptr) return;
  if (studio.is_stale) {
    // One coarse picture at a time: the newest state is asked for when the last one is there.
    if (!studio.pictures.is_busy() || studio.request_is_fine) request_picture(studio, false);
    return;
  }
  const double rested = studio.now_s - studio.last_change_s;
  const bool has_ended = shows_newest || studio.pictures.last_failed() == studio.request_id;
  if (!studio.request_is_fine && has_ended && rested > rest_s && studio.still != Still::draft)
    request_picture(studio, true);
  update_refiner(studio);
}

FlatRequest make_flat_request(const Studio& studio) {
  if (studio.flat_shows_second && studio.second != nullptr)
    return {.state = studio.second->state,
            .map = studio.second->map,
            .mask = nullptr,
            .mode = studio.flat_mode,
            .beam = {studio.second->state.width / 2, studio.second->state.height / 2}};
  const LayerSnapshot* layer = selected_layer(studio);
  return {.state = studio.snapshot->after,
          .map = studio.snapshot->map,
          .mask = layer != nullptr ? layer->mask : nullptr,
          .mode = studio.flat_mode,
          .beam = studio.beam};
}

void update_flat(Studio& studio) {
  if (!studio.flat_is_stale || studio.snapshot == nullptr || studio.jobs.is_running("flat")) return;
  studio.flat_is_stale = false;
  studio.jobs.start("flat",
                    [&studio, request = make_flat_request(studio)](const Progress& progress) {
                      auto image = std::make_shared<const Image>(draw_flat(request, progress));
                      return [&studio, image] {
                        studio.flat_picture = image;
                        ++studio.flat_id;
                      };
                    });
}

// What the table says around the inspected pixel, for the plot.
void update_measured(Studio& studio) {
  const std::array<int, 3> wanted{studio.inspected.x, studio.inspected.y, studio.channel};
  if (studio.measured_at == wanted || studio.jobs.is_running("measured")) return;
  studio.measured_at = wanted;
  studio.measured.clear();
  if (studio.table == nullptr) return;
  studio.jobs.start(
      "measured",
      [&studio, wanted, table = studio.table](const Progress& progress) -> Jobs::Finish {
        auto pairs = std::make_shared<std::vector<MeasuredPair>>(
            collect_pairs(*table, wanted[2], {wanted[0], wanted[1]}, progress));
        return [&studio, pairs] { studio.measured = *pairs; };
      });
}

void update_autosave(Studio& studio) {
  if (studio.snapshot == nullptr || studio.last_change_s == studio.autosaved_change_s) return;
  if (studio.now_s - studio.last_change_s < autosave_rest_s || studio.editor->activity().busy)
    return;
  studio.autosaved_change_s = studio.last_change_s;
  try {
    write_autosave(studio);
  } catch (const Error& error) {
    report(studio, error.what(), true);
  }
}

}  // namespace

const std::vector<std::string>& tool_names() {
  static const std::vector<std::string> names{"orbit", "light", "scribble +", "scribble -", "brush",
                                              "pick",  "paint", "stamp",      "select",     "mask"};
  return names;
}

const std::vector<std::string>& still_names() {
  static const std::vector<std::string> names{"draft", "fine", "exact"};
  return names;
}

const std::vector<std::string>& flat_mode_names() {
  static const std::vector<std::string> names{"albedo",  "range", "mean radius", "selection",
                                              "uniform", "disc",  "line",        "beam"};
  return names;
}

void report(Studio& studio, std::string text, bool is_error) {
  constexpr std::size_t most = 200;
  if (is_error) ++studio.unseen_errors;
  if (!studio.messages.empty() && studio.messages.back().text == text) {
    if (is_error && studio.unseen_errors > 1) --studio.unseen_errors;  // the same one
    studio.messages.back().time_s = studio.now_s;
    ++studio.messages.back().count;
    return;
  }
  studio.messages.push_back({std::move(text), is_error, studio.now_s});
  if (studio.messages.size() > most) studio.messages.pop_front();
}

void update(Studio& studio, double now_s) {
  studio.now_s = now_s;
  for (const std::string& error : studio.jobs.poll()) report(studio, error, true);
  open_waiting(studio);
  update_map(studio);
  apply_strokes(studio);
  update_scene_history(studio);
  update_transport(studio);
  update_view(studio);
  update_flat(studio);
  update_measured(studio);
  update_autosave(studio);
}

bool is_settled(const Studio& studio) {
  // The refinement goes on for long: its first pass counts.
  for (const JobView& job : studio.jobs.views())
    if (job.name != "refine") return false;
  if (studio.is_stale || !studio.waiting_files.empty()) return false;
  if (studio.snapshot != nullptr && studio.flat_is_stale) return false;
  if (studio.editor != nullptr &&
      (studio.editor->activity().busy || studio.editor->snapshot() != studio.snapshot))
    return false;
  if (studio.stage == nullptr || studio.material == nullptr) return true;
  if (!studio.waiting_strokes.empty()) return false;
  if (!studio.request_is_fine && studio.still != Still::draft) return false;
  if (studio.pictures.last_failed() == studio.request_id) return true;
  if (studio.picture == nullptr || studio.picture->id != studio.request_id) return false;
  return is_refined(studio);
}

void touch_view(Studio& studio) {
  studio.is_stale = true;
  studio.last_change_s = studio.now_s;
  stop_refining(studio);
}

void touch_map(Studio& studio) {
  note_scene_now(studio);  // what was done before the edit is undone after it
  studio.pending_layer.reset();
  studio.last_change_s = studio.now_s;
  if (studio.edit_started_s < 0) studio.edit_started_s = studio.now_s;
  stop_refining(studio);
}

}  // namespace parian

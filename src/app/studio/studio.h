// Everything the editor's window shows and changes, without a window: panels read this struct and
// call the functions below, each frame starts with update(). All of it lives in the window's
// thread; long work runs in Editor, PictureThread and Jobs.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/studio/editor.h"
#include "app/studio/jobs.h"
#include "app/studio/layout.h"
#include "app/studio/pictures.h"
#include "app/studio/refiner.h"
#include "app/studio/scene_history.h"
#include "app/studio/selection_edit.h"
#include "app/studio/stage.h"
#include "compress/compress_params.h"
#include "material/bssrdf_table.h"
#include "material/slices.h"
#include "scene/mask_brush.h"

namespace parian {

enum class Tool {
  orbit,
  light,
  scribble_plus,
  scribble_minus,
  brush,
  eyedropper,
  paint,
  stamp,
  select,
  mask
};
const std::vector<std::string>& tool_names();

enum class FlatMode { albedo, range, mean_radius, selection, uniform, disc, line, beam };
const std::vector<std::string>& flat_mode_names();

// How good the picture becomes while nothing moves: as while it moves, splatted at full size, or
// by the exact renderer.
enum class Still { draft, fine, exact };
const std::vector<std::string>& still_names();

struct MapPixel {
  int x = 0, y = 0;
};

// A profile that the eyedropper took, of this map or of another one.
struct PickedProfile {
  std::string map;  // path; empty: the map being edited
  std::array<double, 2> at_mm{};
  std::vector<Profile> profiles;  // one a channel
};

// A pattern for the stamp: a rectangle of this map or of another one.
struct StampSource {
  std::string map;                 // path; empty: the map being edited
  std::array<double, 4> box_mm{};  // min x, min y, max x, max y
};

// Another material, to take profiles and patterns from.
struct SecondMaterial {
  std::string path;
  EditState state;
  std::shared_ptr<const ProfileMap> map;
};

// What was drawn with a tool, in mm on the map: lines of one point or more. On the mesh a stroke
// may leave the map at one place and come in at another, and is several lines then.
using StrokeLine = std::vector<std::array<double, 2>>;
struct Stroke {
  Tool tool = Tool::brush;
  std::vector<StrokeLine> lines;
  bool on_second = false;  // on the second material
  bool ended = false;      // the last line
};

// Painting of the chosen surface layer's mask (mask_tool.h).
struct MaskTool {
  MaskBrush brush;
  std::optional<MaskStroke> stroke;           // while it is drawn
  std::size_t index = 0;                      // of its layer
  std::shared_ptr<const SurfaceLayer> layer;  // as it has made it
  std::optional<Vec3> last;                   // where it touched the mesh
  std::shared_ptr<const VertexGraph> graph;   // of this stage
  std::shared_ptr<const Stage> stage;
};

// A blend that was made of the map, for the rate-distortion list.
struct CompressedPoint {
  int bases = 0, per_pixel = 2;
  std::size_t bytes = 0;
  double relative_error = 0, albedo_error = 0;
  std::shared_ptr<const ProfileBlend> blend;
};

// R_d between the inspected pixel and another one, as it was measured.
struct MeasuredPair {
  double r_mm = 0, value = 0;
};

// Until what was named before it is open.
struct WaitingFile {
  std::string path;
  bool is_second = false;  // the second material
};

struct Message {
  std::string text;
  bool is_error = false;
  double time_s = 0;
  int count = 1;  // how often in a row
};

// A clear material that scatters once visibly, to start from.
Dipole first_homogeneous();

struct StudioPaths {
  std::string state_folder;  // recent files, autosave; empty: nothing is kept
  std::string data_folder;   // bundled samples
};

struct Studio {
  StudioPaths paths;
  LayoutShares shares;
  PictureThread pictures;

  // Material: a map with its recipe, or a homogeneous one.
  std::unique_ptr<Editor> editor;
  std::shared_ptr<const EditorSnapshot> snapshot;
  std::shared_ptr<const Material> material;  // what the stage shows
  std::shared_ptr<const Material> original;  // before all edits
  std::shared_ptr<const SliceSource> table;  // what the map was fitted to, if known
  std::string material_path, recipe_path;
  Dipole homogeneous = first_homogeneous();
  std::shared_ptr<const SecondMaterial> second;
  std::optional<std::size_t> selected_layer;
  PartPath part;                       // of its selection
  std::size_t selected_stroke = 0;     // of a scribble
  std::optional<std::size_t> grabbed;  // handle of the part, while it is dragged
  // A layer as it was posted, until the editor has done it: what is changed next is changed in it.
  std::optional<std::pair<std::size_t, Document>> pending_layer;
  std::uint64_t seen_version = 0, saved_version = 0;

  // Stage.
  std::shared_ptr<const Stage> stage;
  std::string mesh_path;
  Orbit orbit;
  Lighting lighting;
  std::size_t selected_light = 0;
  StageLayers layers;        // over the material
  StageLayers saved_layers;  // as a scene's file has them
  std::optional<std::size_t> selected_stage_layer;
  double exposure = 0;
  ViewMode mode = ViewMode::shaded;
  int view_width = 640, view_height = 480;  // of the 3-D view, in pixels
  double interactive_scale = 0.45;
  Still still = Still::exact;

  // Precomputed transport of the stage, for homogeneous materials (transport_job.h).
  std::optional<PrecomputeParams> transport_params;  // none: by the size of the mesh
  std::shared_ptr<const ReadyTransport> transport;
  std::optional<TransportKey> transport_under_way;
  SceneHistory scene_history;
  std::shared_ptr<const Stage> noted_stage;  // that the history's views are of

  // What was asked for last, and what is shown.
  std::uint64_t request_id = 0;
  double last_change_s = 0;        // when something was changed last
  double autosaved_change_s = -1;  // that the autosave holds
  std::shared_ptr<const Picture> picture;
  Refiner refiner;
  std::shared_ptr<const Picture> refined;         // its, of the same request
  std::uint64_t refining_id = 0;                  // of the request that it was started for
  double edit_started_s = -1, edit_shown_ms = 0;  // from an edit to its picture

  // Flat view.
  FlatMode flat_mode = FlatMode::albedo;
  std::shared_ptr<const Image> flat_picture;  // linear, of the map's size
  std::uint64_t flat_id = 0;                  // grows with each picture
  MapPixel beam;

  // Tools.
  Tool tool = Tool::orbit;
  double brush_radius_mm = 1;
  std::optional<PickedProfile> picked;
  MapPixel inspected;  // whose profile is plotted
  int channel = 1;
  std::vector<MeasuredPair> measured;          // of the table, around the inspected pixel
  std::array<int, 3> measured_at{-1, -1, -1};  // x, y, channel that they are of
  Stroke stroke;                               // while it is drawn
  std::deque<Stroke> waiting_strokes;          // until the editor has done the last one
  std::optional<StampSource> stamp_source;
  MaskTool mask;

  // Compression.
  CompressParams compression;
  std::vector<CompressedPoint> compressed;
  std::optional<std::size_t> shown_compressed;

  std::deque<Message> messages;
  std::size_t unseen_errors = 0;  // the last of them stands over the view
  std::vector<std::string> recent;
  std::deque<WaitingFile> waiting_files;   // until the map that they need is open
  std::string base_job, mesh_job;          // that open what is shown next
  std::optional<std::string> recoverable;  // path of an autosaved recipe
  std::uint64_t drags = 0;  // finished ones: a drag of a slider is one entry of the history
  double now_s = 0;

  // What is on, and what is old.
  bool is_homogeneous = false;
  bool show_selection = false;
  bool use_transport = true;
  bool request_is_fine = false;
  bool is_stale = true;  // something changed since the last request
  bool flat_shows_second = false;
  bool flat_is_stale = true;
  bool is_held = false;  // a mouse button: what is being dragged is no entry yet

  Jobs jobs;  // last: what runs ends before what it looks at
};

// Takes in what finished, asks for pictures of what changed. Once a frame.
void update(Studio& studio, double now_s);
// Nothing is under way, and what is shown is of the present state. `refined` as well where asked.
bool is_settled(const Studio& studio);

void report(Studio& studio, std::string text, bool is_error = false);

// Of the recipe, the light, the exposure, the camera and the homogeneous material, in the order in
// which they were made.
void undo(Studio& studio);
void redo(Studio& studio);
HistoryView view_history(const Studio& studio);
void jump_to(Studio& studio, std::size_t position);
// Makes an entry at once of what was changed beside the recipe.
void note_scene_now(Studio& studio);

// Of the 3-D view, whose size is scaled.
Camera make_view_camera(const Studio& studio, double scale);
// The layers that the view shows.
StageLayers shown_layers(const Studio& studio);
// What the view shows in red: the selection, or with the tool `mask` that of the chosen surface
// layer; null: neither.
std::shared_ptr<const Mask> shown_mask(const Studio& studio);
std::shared_ptr<const SurfaceLayer> shown_layer_mask(const Studio& studio);
void choose_tool(Studio& studio, Tool tool);

// Marks the 3-D view, or all pictures of the map, as old.
void touch_view(Studio& studio);
void touch_map(Studio& studio);

void set_homogeneous(Studio& studio, Dipole material);
// Back to the map.
void leave_homogeneous(Studio& studio);

// A run of compressions from few to many bases, in the background; added to those that are there of
// the same map.
void compress_map(Studio& studio);
void show_compressed(Studio& studio, std::optional<std::size_t> index);

}  // namespace parian

// Strokes on the mesh: what is drawn on the screen becomes lines on the map.
#include <algorithm>
#include <cmath>

#include "app/studio/tools.h"

namespace parian {
namespace {

using Pixel = std::array<double, 2>;

struct MeshPoint {
  Pixel at;
  std::optional<Place> place;  // none: beside the mesh
};

// Between points of the screen farther apart the map may fold back in a mirrored repetition.
constexpr double longest_step_px = 1;
// Where the map still jumps between points this close, it has a seam there.
constexpr double seam_step_px = 1.0 / 16;

struct MeshLine {
  Studio& studio;
  double longest_mm;  // a step that the brush covers

  MeshPoint look_at(const Pixel& at) const { return {at, mesh_to_map(studio, at[0], at[1])}; }
  void trace(const MeshPoint& from, const MeshPoint& to) const;
};

void MeshLine::trace(const MeshPoint& from, const MeshPoint& to) const {
  const double apart_px = std::hypot(to.at[0] - from.at[0], to.at[1] - from.at[1]);
  const bool joins = from.place && to.place &&
                     std::hypot((*to.place)[0] - (*from.place)[0],
                                (*to.place)[1] - (*from.place)[1]) <= longest_mm;
  const bool is_beside = !from.place && !to.place;
  if (apart_px > (joins || is_beside ? longest_step_px : seam_step_px)) {
    const MeshPoint middle =
        look_at({0.5 * (from.at[0] + to.at[0]), 0.5 * (from.at[1] + to.at[1])});
    trace(from, middle);
    trace(middle, to);
    return;
  }
  if (!joins) break_stroke(studio);
  if (to.place) extend_stroke(studio, (*to.place)[0], (*to.place)[1]);
}

}  // namespace

void extend_mesh_stroke(Studio& studio, const Pixel& from, const Pixel& to) {
  if (studio.snapshot == nullptr || studio.stage == nullptr) return;
  const MeshLine line{studio,
                      std::max(studio.snapshot->after.pixel_pitch_mm, studio.brush_radius_mm)};
  const MeshPoint start = line.look_at(from);
  if (studio.stroke.lines.empty() && start.place)
    extend_stroke(studio, (*start.place)[0], (*start.place)[1]);
  line.trace(start, line.look_at(to));
}

}  // namespace parian

// A profile map while it is edited: a value whose planes are shared, so that a step that changes
// the albedo costs one plane of gains, and undo costs nothing. Albedo and range edits are kept as
// factors (gain, dilation) and lose nothing; shape edits make new knots.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "edit/mask.h"
#include "edit/shape_planes.h"
#include "material/profile_map.h"
#include "material/properties.h"

namespace parian {

using Plane = std::vector<double>;  // [channel][y][x]

struct EditState {
  int width = 0;
  int height = 0;
  int channels = 3;
  double pixel_pitch_mm = 1;
  Boundary boundary = Boundary::excluded;
  double eta = 1.3;
  std::vector<double> knots_mm;
  std::shared_ptr<const ShapePlanes> shapes;
  std::shared_ptr<const Plane> gain, dilation;  // never null

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t values() const { return pixels() * static_cast<std::size_t>(channels); }
};

// What edits had to give up, in values (pixels times channels).
struct EditReport {
  std::size_t clamped_albedo = 0;
  std::size_t clamped_range = 0;
};

// Edited albedos 2 pi C and ranges stay at least here; a range stays at least half a pixel.
inline constexpr double least_albedo = 1e-6;
inline double least_range_mm(const EditState& state) {
  return 0.5 * state.pixel_pitch_mm;
}

EditState make_edit_state(const ProfileMap& map);
// Gains and dilations rounded to float, and left out where all are 1. Provenance is the caller's.
ProfileMap make_profile_map(const EditState& state);

// The properties as they stand: 2 pi C and alpha in mm.
Plane albedo_plane(const EditState& state);
Plane range_plane(const EditState& state);
// int P r^2 dr / int P r dr in mm.
Plane mean_radius_plane(const EditState& state);
Profile get_profile(const EditState& state, int channel, int x, int y);

// The state with new albedos, or ranges: only values that differ from the old ones change gain or
// dilation. Clamps and counts.
void set_albedo(EditState& state, const Plane& before, const Plane& after, EditReport& report);
void set_range(EditState& state, const Plane& before, const Plane& after, EditReport& report);

// Gain and dilation that give these properties, of a state whose profiles are new.
void set_properties(EditState& state, const Plane& albedo, const Plane& range_mm);

}  // namespace parian

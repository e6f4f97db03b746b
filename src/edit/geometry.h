// Edits that change a map's grid: other pixels of the same profiles, or profiles in between.
#pragma once

#include <cstdint>

#include "edit/edit_state.h"

namespace parian {

// Maps have at most so many pixels, and so many bytes while they are edited.
inline constexpr std::size_t max_edit_pixels = std::size_t{1} << 24u;
inline constexpr std::size_t max_edit_bytes = std::size_t{1} << 32u;
std::size_t max_pixels(const EditState& like);

// Pixel i of the result is pixel index[i] of the state: whole profiles, so nothing is lost.
EditState gather_pixels(const EditState& state, const std::vector<std::uint32_t>& index, int width,
                        int height);

// The part [x0, x1) x [y0, y1).
EditState crop(const EditState& state, int x0, int y0, int x1, int y1);
// nx times ny copies; `mirror`: every other one is mirrored, so that their borders fit.
EditState tile(const EditState& state, int nx, int ny, bool mirror);
EditState flip(const EditState& state, bool horizontal, bool vertical);
// By quarters of a turn from x to y (clockwise as seen).
EditState rotate_quarters(const EditState& state, int quarters);

// Where a pixel of the result lies in the state: pixel coordinates, centres at integers + 0.5; the
// state goes on mirrored beyond its borders.
struct GridMap {
  double xx = 1, xy = 0, x0 = 0;  // x = xx X + xy Y + x0 for the centre (X, Y) of a new pixel
  double yx = 0, yy = 1, y0 = 0;
};
// Albedo and range interpolated linearly, shapes geometrically (linear in ln S over knots in units
// of the range); averaged over the new pixel where that is larger. Exact where all profiles agree.
EditState resample(const EditState& state, int width, int height, const GridMap& map,
                   double pixel_pitch_mm);

// The same extent with pixels of another size; the size is rounded to whole pixels.
EditState resample_to_pitch(const EditState& state, double pixel_pitch_mm);
// Turned about its centre from x to y, on the same grid; quarters are exact.
EditState rotate(const EditState& state, double degrees);

}  // namespace parian

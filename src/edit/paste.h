// Pattern copy and paste (SubEdit, section 7.1): gradients of albedo and range from a region of a
// map or of an image, solved into the target with its own values at the border (Perez, Gangnet,
// Blake 2003). Shapes stay.
#pragma once

#include <cstdint>

#include "base/params.h"
#include "edit/edit_state.h"
#include "edit/mask_shapes.h"
#include "image/image.h"

namespace parian {

struct PasteParams {
  double scale = 1;         // of the pattern, on the target
  double rotation_deg = 0;  // from x to y
  bool flip = false;        // left and right, before the turn
  bool mixed = false;       // take the target's gradient where it is the stronger one
  bool linear = false;      // solve for albedo and range themselves, not for their logarithms
  bool keep_mean = false;   // of a selection without a border: the whole map
  double albedo = 1;        // factor on the pattern's gradients
  double range = 1;
};
ParamList describe(PasteParams& params);

// A pattern: planes of albedo [channels][y][x] and range, on pixels of a pitch, of which the
// rectangle is taken.
struct Pattern {
  int width = 0, height = 0, channels = 3;
  double pixel_pitch_mm = 1;
  Plane albedo, range_mm;
  Point2 min, max;  // in its pixels
};
Pattern make_pattern(const EditState& map);  // all of it
// Albedo: its values, at least 1e-3; range: its luminance, as it has none of its own.
Pattern make_pattern(const Image& image, double pixel_pitch_mm, int channels);

// The pattern's rectangle is laid with its middle at `center` (in pixels of the state). Pasted
// where the mask is above 0 and the pattern covers the pixel's centre; where the mask is below 1
// the change is taken in part. Throws Error where that is nowhere, or everywhere without keep_mean.
void apply(const PasteParams& params, const Pattern& pattern, Point2 center, EditState& state,
           const Mask& mask, EditReport& report);

}  // namespace parian

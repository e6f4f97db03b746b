// What strokes become in a recipe.
#pragma once

#include <array>
#include <string>

#include "app/studio/studio.h"

namespace parian {

// On the thread of the window, while the editor rests.
void apply_stroke(Studio& studio, const Stroke& stroke);
// The tool `select`: places of the selected part of the selection.
void select_places(Studio& studio, const Stroke& stroke);

// "from" of layers.
Document describe_picked(const PickedProfile& picked);
Document describe_stamp(const StampSource& source);
// The source's ellipse around a point; its border gives the values between which it is fitted.
Document make_stamp_layer(const StampSource& source, const std::array<double, 2>& to);

// One document for each line.
Document::Array make_scribbles(const std::vector<StrokeLine>& lines, double radius, bool positive);

}  // namespace parian

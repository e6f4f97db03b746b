// Hue, saturation and lightness of albedos, in OKLCh, where equal steps look equal.
#pragma once

#include "base/params.h"
#include "image/color_spaces.h"

namespace parian {

struct Recolor {
  double hue_deg = 0;     // added to the hue
  double saturation = 1;  // factor on the chroma
  double lightness = 1;   // factor on the lightness and, to keep the saturation, on the chroma
};
ParamList describe(Recolor& recolor);
bool is_identity(const Recolor& recolor);

// `amount` in [0, 1] interpolates the parameters from "no change"; 0 returns the same bits. Where a
// channel would be negative, chroma falls at constant hue and lightness until none is. Channels
// above 1 stay as they are.
Color recolor_albedo(const Color& albedo, const Recolor& recolor, double amount);

// Planes [3][pixels] in place.
void recolor_planes(double* albedo, std::size_t pixels, const Recolor& recolor,
                    const float* amount);

}  // namespace parian

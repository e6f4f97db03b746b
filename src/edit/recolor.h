// Hue, saturation and lightness of albedos, in OKLCh, where equal steps look equal.
#pragma once

#include <cstddef>

#include "base/params.h"

namespace parian {

struct Recolor {
  double hue_deg = 0;     // added to the hue
  double saturation = 1;  // factor on the chroma
  double lightness = 1;   // factor on the lightness and, to keep the saturation, on the chroma
};
ParamList describe(Recolor& recolor);
bool is_identity(const Recolor& recolor);

// Planes [3][pixels] in place. `amount` in [0, 1] interpolates the parameters from "no change"; 0
// leaves the same bits. Where a channel would be negative, chroma falls at constant hue and
// lightness until none is. Channels above 1 stay as they are.
void recolor_planes(double* albedo, std::size_t pixels, const Recolor& recolor,
                    const float* amount);

}  // namespace parian

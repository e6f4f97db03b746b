// What a blend consists of, to look at: as in Fig. 3 and 4 of the 2019 paper.
#pragma once

#include "image/image.h"
#include "material/profile_blend.h"

namespace parian {

// The K weights of every pixel side by side, largest first: linear grey, 0 to 1.
Image make_weight_image(const ProfileBlend& blend);

// The bases in the same order, each in a colour of its own that means nothing else.
Image make_index_image(const ProfileBlend& blend);

}  // namespace parian

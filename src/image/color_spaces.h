// Perceptual colour spaces over linear Rec. 709 (D65): CIE Lab for distances between photographs'
// pixels, OKLab (Ottosson 2020) for edits of hue, chroma and lightness. Values outside [0, 1] and
// below 0 are allowed everywhere and survive round trips to 1e-10.
#pragma once

#include <array>

namespace parian {

using Color = std::array<double, 3>;

Color linear_to_xyz(const Color& rgb);  // white is (0.9505, 1, 1.089)
Color xyz_to_linear(const Color& xyz);
Color linear_to_lab(const Color& rgb);  // white is (100, 0, 0)

Color linear_to_oklab(const Color& rgb);  // (L, a, b), white is (1, 0, 0)
Color oklab_to_linear(const Color& oklab);
// The part of the chroma with which no channel is negative, of a colour with L >= 0, at its hue and
// lightness: 1, or where a channel is 0 and turns negative beyond.
double find_possible_chroma(const Color& oklab);
// (L, chroma, hue in radians); hue is 0 for greys.
Color oklab_to_oklch(const Color& oklab);

}  // namespace parian

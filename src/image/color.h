// The sRGB transfer curve (IEC 61966-2-1) and the luminance of linear Rec. 709.
#pragma once

namespace parian {

// Linear to sRGB-encoded, both in [0, 1]; values outside are clamped.
float encode_srgb(float linear);
float decode_srgb(float encoded);
// 0.2126 R + 0.7152 G + 0.0722 B
inline float luminance(float r, float g, float b) {
  return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

}  // namespace parian

// Image values: planes of floats, linear Rec. 709 unless said otherwise, row 0 on top.
#pragma once

#include <cstddef>
#include <vector>

namespace parian {

// values[(y * width + x) * channels + c]: interleaved, as codecs want it.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 3;
  std::vector<float> values;
};

Image make_image(int width, int height, int channels, float value = 0);

inline float& at(Image& image, int x, int y, int c) {
  return image.values[(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(x)) *
                          static_cast<std::size_t>(image.channels) +
                      static_cast<std::size_t>(c)];
}
inline float at(const Image& image, int x, int y, int c) {
  return at(const_cast<Image&>(image), x, y, c);
}

// Side by side with a gap of `gap` pixels of value `gap_value`; heights and channels must agree.
Image place_side_by_side(const std::vector<Image>& images, int gap = 8, float gap_value = 1);

// Every pixel becomes factor x factor equal pixels.
Image magnify(const Image& image, int factor);

// v * factor for every value.
Image scale(Image image, float factor);

}  // namespace parian

#include "image/image.h"

#include <algorithm>

#include "base/check.h"

namespace parian {

Image make_image(int width, int height, int channels, float value) {
  PARIAN_CHECK_LE(0, width);
  PARIAN_CHECK_LE(0, height);
  PARIAN_CHECK_LE(1, channels);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                            static_cast<std::size_t>(channels);
  return {width, height, channels, std::vector<float>(count, value)};
}

Image place_side_by_side(const std::vector<Image>& images, int gap, float gap_value) {
  PARIAN_CHECK(!images.empty());
  int width = -gap;
  for (const Image& image : images) {
    PARIAN_CHECK_EQ(image.height, images[0].height);
    PARIAN_CHECK_EQ(image.channels, images[0].channels);
    width += image.width + gap;
  }
  Image row = make_image(width, images[0].height, images[0].channels, gap_value);
  int left = 0;
  for (const Image& image : images) {
    for (int y = 0; y < image.height; ++y)
      std::copy_n(&image.values[static_cast<std::size_t>(y) *
                                static_cast<std::size_t>(image.width * image.channels)],
                  image.width * image.channels, &at(row, left, y, 0));
    left += image.width + gap;
  }
  return row;
}

Image magnify(const Image& image, int factor) {
  PARIAN_CHECK_LE(1, factor);
  Image large = make_image(image.width * factor, image.height * factor, image.channels);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        at(large, x, y, c) = at(image, x / factor, y / factor, c);
  return large;
}

Image scale(Image image, float factor) {
  for (float& value : image.values) value *= factor;
  return image;
}

}  // namespace parian

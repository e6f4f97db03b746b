#include "image/image.h"

#include <gtest/gtest.h>

#include "image/color.h"

namespace parian {
namespace {

TEST(Image, SideBySideAndMagnified) {
  const Image row = place_side_by_side({make_image(2, 3, 1, 0.25f), make_image(4, 3, 1, 0.5f)}, 1);
  EXPECT_EQ(row.width, 7);
  EXPECT_EQ(at(row, 1, 2, 0), 0.25f);
  EXPECT_EQ(at(row, 2, 2, 0), 1.0f);
  EXPECT_EQ(at(row, 3, 0, 0), 0.5f);
  const Image large = magnify(row, 3);
  EXPECT_EQ(large.width, 21);
  EXPECT_EQ(at(large, 8, 8, 0), 1.0f);
}

TEST(Color, SrgbRoundTripsAndHitsKnownValues) {
  for (float value = 0; value <= 1; value += 0.01f)
    EXPECT_NEAR(decode_srgb(encode_srgb(value)), value, 1e-6f);
  EXPECT_NEAR(encode_srgb(0.2140411f), 0.5f, 1e-6f);
  EXPECT_NEAR(encode_srgb(7), 1.0f, 1e-6f);
  EXPECT_NEAR(luminance(1, 1, 1), 1, 1e-6f);
}

}  // namespace
}  // namespace parian

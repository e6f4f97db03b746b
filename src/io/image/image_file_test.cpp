#include "io/image/image_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "base/test_errors.h"
#include "io/json/files.h"
#include "io/json/test_folder.h"

namespace parian {
namespace {

struct ImageFiles : testing::Test {
  TestFolder folder{"image"};
  std::string at_path(const std::string& name) const { return folder.at(name); }
};

Image make_noise(int width, int height, int channels, float scale) {
  Image image = make_image(width, height, channels);
  Rng rng = make_rng(1);
  for (float& value : image.values) value = scale * static_cast<float>(sample_uniform(rng));
  return image;
}

TEST_F(ImageFiles, ExrKeepsEveryBit) {
  for (const int channels : {1, 3}) {
    Image image = make_noise(7, 5, channels, 40);
    image.values[3] = -2.5f;
    save_image(at_path("a.exr"), image);
    const Image read = load_image(at_path("a.exr"));
    EXPECT_EQ(read.width, 7);
    EXPECT_EQ(read.height, 5);
    EXPECT_EQ(read.channels, channels);
    EXPECT_EQ(read.values, image.values);
  }
}

// A half-float file with an offset data window and no green.
TEST_F(ImageFiles, ExrReadsHalfAndSomeChannels) {
  Imf::Header header(Imath::Box2i({0, 0}, {9, 9}), Imath::Box2i({2, -1}, {4, 0}));
  header.channels().insert("B", Imf::Channel(Imf::HALF));
  header.channels().insert("R", Imf::Channel(Imf::FLOAT));
  header.channels().insert("A", Imf::Channel(Imf::FLOAT));
  std::vector<half> blue;
  std::vector<float> red;
  for (int i = 0; i < 6; ++i) blue.emplace_back(0.25f * static_cast<float>(i)), red.push_back(1.0f);
  Imf::FrameBuffer buffer;
  const Imath::V2i origin(2, -1);
  buffer.insert("B", Imf::Slice::Make(Imf::HALF, blue.data(), origin, 3, 2, sizeof(half)));
  buffer.insert("R", Imf::Slice::Make(Imf::FLOAT, red.data(), origin, 3, 2, sizeof(float)));
  buffer.insert("A", Imf::Slice::Make(Imf::FLOAT, red.data(), origin, 3, 2, sizeof(float)));
  {
    Imf::OutputFile file(at_path("h.exr").c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  const Image read = load_image(at_path("h.exr"));
  ASSERT_EQ(read.width, 3);
  ASSERT_EQ(read.channels, 3);
  EXPECT_EQ(at(read, 1, 1, 2), 1.0f);
  EXPECT_EQ(at(read, 1, 1, 1), 0.0f);
  EXPECT_EQ(at(read, 1, 1, 0), 1.0f);
  EXPECT_EQ(at(read, 2, 0, 2), 0.5f);
}

TEST_F(ImageFiles, PngQuantisesTheSrgbCurve) {
  for (const int channels : {1, 3}) {
    Image image = make_noise(9, 4, channels, 1);
    image.values[0] = -1;
    image.values[1] = 7;
    save_image(at_path("a.png"), image);
    const Image read = load_image(at_path("a.png"));
    ASSERT_EQ(read.channels, channels);
    EXPECT_EQ(read.values[0], 0.0f);
    EXPECT_EQ(read.values[1], 1.0f);
    // Half a step of 1/255 where the curve is steepest: slope 2.4 / 1.055 at white.
    for (std::size_t i = 2; i < read.values.size(); ++i)
      EXPECT_NEAR(read.values[i], image.values[i], 0.5 / 255 * 2.4 / 1.055 + 1e-6);
    // What was read writes the same bytes again.
    save_image(at_path("b.png"), read);
    EXPECT_EQ(read_file(at_path("a.png"), 99999), read_file(at_path("b.png"), 99999));
  }
}

// Rows of 8 and more pixels are stored as runs, shorter ones plainly.
TEST_F(ImageFiles, HdrHasEightBitsOfMantissa) {
  for (const int width : {5, 12}) {
    const Image image = make_noise(width, 6, 3, 100);
    save_image(at_path("a.hdr"), image);
    const Image read = load_image(at_path("a.hdr"));
    ASSERT_EQ(read.width, width);
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < width; ++x) {
        const float peak = std::max({at(image, x, y, 0), at(image, x, y, 1), at(image, x, y, 2)});
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(at(read, x, y, c), at(image, x, y, c), peak / 128);
      }
  }
}

TEST_F(ImageFiles, ErrorsNameTheFile) {
  const Image image = make_noise(20, 20, 3, 1);
  EXPECT_EQ(
      error_of([&] { save_image(at_path("a.jpg"), image); }),
      at_path("a.jpg") + ": expected a file name that ends in .png, .exr or .hdr, found '.jpg'");
  EXPECT_EQ(error_of([&] { load_image(at_path("a")); }),
            at_path("a") +
                ": expected a file name that ends in .png, .jpg, .exr or .hdr, found no extension");
  EXPECT_EQ(error_of([&] { load_image(at_path("none.png")); }),
            at_path("none.png") + ": expected a readable file, found no such file");
  EXPECT_EQ(error_of([&] { save_image(at_path("no/a.exr"), image); }),
            at_path("no/a.exr") + ": expected a writable folder, found no such directory");
  write_text(at_path("text.png"), "hello");
  EXPECT_EQ(error_of([&] { load_image(at_path("text.png")); }),
            at_path("text.png") + ": expected a whole PNG or JPEG image, found unknown image type");
  write_text(at_path("text.exr"), "hello");
  EXPECT_THAT(
      error_of([&] { load_image(at_path("text.exr")); }),
      testing::StartsWith(at_path("text.exr") + ": expected a whole OpenEXR image, found "));
}

TEST_F(ImageFiles, TruncatedFilesAreErrors) {
  const Image image = make_noise(20, 20, 3, 1);
  for (const std::string extension : {".png", ".exr", ".hdr"}) {
    save_image(at_path("a" + extension), image);
    const std::string bytes = read_file(at_path("a" + extension), 999999);
    write_text(at_path("b" + extension), bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT(error_of([&] { load_image(at_path("b" + extension)); }),
                testing::StartsWith(at_path("b" + extension) + ": expected a whole "));
  }
}

// A PNG header that claims 30000 x 30000 pixels in 60 bytes.
TEST_F(ImageFiles, SizesAreCheckedBeforeDecoding) {
  save_image(at_path("a.png"), make_noise(2, 2, 1, 1));
  std::string bytes = read_file(at_path("a.png"), 9999);
  const auto set_size = [&](int high, int low) {
    for (const std::size_t i : {16u, 20u})
      bytes[i] = 0, bytes[i + 1] = 0, bytes[i + 2] = static_cast<char>(high),
      bytes[i + 3] = static_cast<char>(low);
    write_text(at_path("b.png"), bytes);
  };
  set_size(0x75, 0x30);
  EXPECT_EQ(error_of([&] { load_image(at_path("b.png")); }),
            at_path("b.png") + ": size: expected 1 to 2^28 pixels, found 30000 x 30000");
  set_size(0x3a, 0x98);
  EXPECT_EQ(error_of([&] { load_image(at_path("b.png")); }),
            at_path("b.png") + ": size: expected the data of 15000 x 15000 pixels, found " +
                std::to_string(bytes.size()) + " bytes");
}

TEST_F(ImageFiles, InfinitePixelsAreErrors) {
  Image image = make_noise(4, 3, 3, 1);
  at(image, 2, 1, 0) = std::numeric_limits<float>::infinity();
  save_image(at_path("a.exr"), image);
  EXPECT_EQ(error_of([&] { load_image(at_path("a.exr")); }),
            at_path("a.exr") + ": pixel (2, 1): expected a finite value, found inf");
}

TEST_F(ImageFiles, RawPngKeepsCodes) {
  for (const int channels : {1, 3})
    for (const int bits : {8, 16}) {
      const float top = bits == 8 ? 255.0f : 65535.0f;
      Image image = make_noise(9, 6, channels, top);
      for (float& value : image.values) value = std::floor(value) / top;
      save_raw_png(at_path("raw.png"), image, bits);
      const Image read = load_raw_image(at_path("raw.png"));
      EXPECT_EQ(read.width, 9);
      EXPECT_EQ(read.channels, channels);
      EXPECT_EQ(read.values, image.values);
    }
}

TEST_F(ImageFiles, RawImagesMayHoldNanButNoInfinity) {
  Image image = make_noise(3, 2, 1, 1);
  image.values[4] = NAN;
  save_image(at_path("raw.exr"), image);
  EXPECT_TRUE(std::isnan(load_raw_image(at_path("raw.exr"), true).values[4]));
  const std::string path = at_path("raw.exr");
  EXPECT_EQ(error_of([&] { load_raw_image(path); }),
            path + ": pixel (1, 1): expected a finite value, found nan");
  EXPECT_EQ(error_of([&] { load_raw_image("a.hdr"); }),
            "a.hdr: expected a file name that ends in .png or .exr, found '.hdr'");
}

}  // namespace
}  // namespace parian

#include "io/capture/capture_folder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/test_errors.h"
#include "io/json/test_folder.h"

namespace parian {
namespace {

struct CaptureFolder : testing::Test, TestFolder {
  CaptureFolder() : TestFolder("capture") {}
  std::string folder = path.string();
};

CaptureMeta make_meta(FrameFormat format) {
  CaptureMeta meta;
  meta.width = meta.height = 6;
  meta.lattice_px = 3;
  meta.radius_px = 1;
  meta.camera_width = 7, meta.camera_height = 5;
  meta.channels = 1;
  meta.exposures_s = {0.1, 0.2};
  meta.calibration_frames = 2;
  meta.format = format;
  return meta;
}

TEST_F(CaptureFolder, FramesComeBack) {
  for (const auto format : {FrameFormat::png8, FrameFormat::png16, FrameFormat::exr}) {
    const CaptureMeta meta = make_meta(format);
    for (const FrameName& frame : list_frames(meta))
      save_frame(folder, meta, frame,
                 make_image(7, 5, 1, static_cast<float>(frame.i + 4 * frame.exposure) / 255.0f));
    save_capture_meta(folder, meta);
    const CaptureMeta read = open_capture(folder);
    EXPECT_EQ(read.format, format);
    const Image image = make_frame_loader(folder, read)({.i = 2, .j = 1, .exposure = 1});
    EXPECT_NEAR(image.values.at(34), 6 / 255.0, 1e-5);
  }
}

TEST_F(CaptureFolder, BadFramesAreNamed) {
  const CaptureMeta meta = make_meta(FrameFormat::exr);
  const FrameName frame{.role = FrameRole::white, .exposure = 1};
  const auto error_of_frame = [&](const Image& image) {
    save_frame(folder, meta, frame, image);
    return error_of([&] { make_frame_loader(folder, meta)(frame); });
  };
  Image image = make_image(7, 5, 1, 0.5f);
  EXPECT_EQ(error_of_frame(image), "no error");
  image.values[9] = NAN;
  EXPECT_EQ(error_of_frame(image),
            folder + "/white_1_0.exr: pixel (2, 1): expected a finite value, found nan");
  EXPECT_EQ(error_of_frame(make_image(7, 5, 3)),
            folder +
                "/white_1_0.exr: size: expected 7 x 5 pixels of 1 channel, found 7 x 5 pixels "
                "of 3 channels");
}

}  // namespace
}  // namespace parian

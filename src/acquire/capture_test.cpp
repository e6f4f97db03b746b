// The whole path from a table over photographs to a table, and what stops it.
#include "acquire/capture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "acquire/capture_synthesize.h"
#include "acquire/sample.h"
#include "acquire/test_documents_internal.h"
#include "base/parallel.h"
#include "base/test_errors.h"
#include "judge/compare.h"

namespace parian {
namespace {

// A small board of two materials.
BssrdfTable make_truth(double radius_px) {
  Document document = chessboard_description();
  set(document, "materials",
      array({object({{"name", "white"}, {"material", "Marble"}}),
             object({{"name", "dark"}, {"sigma_a", 0.2}, {"sigma_s_prime", 1.1}})}));
  set(document, "channels", 1);
  set(document, "radius_px", radius_px);
  return read_table(*make_analytic_source(read_sample(locate(document), {})));
}

CaptureMeta make_meta(const BssrdfTable& truth) {
  CaptureMeta meta;
  meta.width = truth.header.width;
  meta.height = truth.header.height;
  meta.channels = truth.header.channels;
  meta.pixel_pitch_mm = truth.header.pixel_pitch_mm;
  meta.lattice_px = 9;
  meta.radius_px = 3;
  return meta;
}

struct Folder {
  CaptureMeta meta;
  std::map<std::string, Image> frames;
};
Folder synthesize(const BssrdfTable& truth, CaptureMeta meta, const PhotographParams& params) {
  make_camera(params, meta);
  Folder folder{meta, {}};
  synthesize_capture(truth, meta, params, [&](const FrameName& name, const Image& image) {
    Image codes = image;
    const float top = meta.format == FrameFormat::png8 ? 255.0f : 65535.0f;
    for (float& value : codes.values) value = std::round(value * top) / top;
    folder.frames[frame_file(meta, name)] = std::move(codes);
  });
  return folder;
}
CaptureResult process(const Folder& folder) {
  return process_capture(folder.meta, [&](const FrameName& name) {
    return folder.frames.at(frame_file(folder.meta, name));
  });
}
// The truth at the offsets that were captured.
CompareReport judge(const BssrdfTable& truth, const BssrdfTable& found) {
  TableHeader header = truth.header;
  header.offsets = found.header.offsets;
  BssrdfTable part = make_bssrdf_table(std::move(header));
  for (int c = 0; c < part.header.channels; ++c)
    for (std::size_t d = 0; d < part.header.offsets.size(); ++d) {
      const float* from = slice_of(truth, c, find_offset(truth.header, part.header.offsets[d]));
      std::copy(from, from + part.header.pixels(), slice_of(part, c, static_cast<int>(d)));
    }
  return compare(*make_slices(part), *make_slices(found), {});
}

TEST(Capture, RoundTripWithARealisticCamera) {
  const BssrdfTable truth = make_truth(14);
  const PhotographParams params;
  const CaptureResult result = process(synthesize(truth, make_meta(truth), params));
  const CompareReport errors = judge(truth, result.table);
  EXPECT_LT(errors.relative_error.mean, 0.03);
  EXPECT_LT(errors.albedo_error_mean, 0.01);
  const CaptureReport& report = result.report;
  EXPECT_EQ(report.dots_found, 9);
  EXPECT_LT(report.reprojection_px, 0.02);
  EXPECT_NEAR(report.psf_px, params.blur_px, 0.03);
  EXPECT_NEAR(report.camera.full_well, params.full_well, 0.05 * params.full_well);
  EXPECT_NEAR(report.camera.read * report.camera.full_well, params.read_noise, 0.3);
  EXPECT_LT(report.white_error, 0.01);
  // Neighbours' light is a tenth of what the camera sees here.
  EXPECT_GT(report.tail_fraction, 0.08);
  EXPECT_TRUE(result.table.header.symmetric);
  EXPECT_FALSE(result.raw.header.symmetric);
  EXPECT_EQ(result.table.header.boundary, Boundary::included);
}

TEST(Capture, WithoutNoiseAndTailsTheTableComesBack) {
  const BssrdfTable truth = make_truth(3);
  PhotographParams params{.full_well = 0};
  CaptureMeta meta = make_meta(truth);
  meta.full_well = 1e6;
  const CaptureResult result = process(synthesize(truth, meta, params));
  const CompareReport errors = judge(truth, result.table);
  EXPECT_LT(errors.relative_error.mean, 0.005);
  EXPECT_LT(errors.albedo_error_mean, 0.002);
  EXPECT_LT(std::abs(result.report.tail_fraction), 0.002);
}

// The noise model that comes with the table predicts its errors.
TEST(Capture, NoiseModelHoldsTheErrors) {
  const BssrdfTable truth = make_truth(3);
  PhotographParams params{.vignetting = 0, .nonuniformity = 0, .full_well = 1000, .read_noise = 10};
  const CaptureResult result = process(synthesize(truth, make_meta(truth), params));
  const TableHeader& header = result.table.header;
  double chi2 = 0, count = 0;
  for (std::size_t d = 1; d < header.offsets.size(); ++d) {
    const float* found = slice_of(result.table, 0, static_cast<int>(d));
    const float* expected = slice_of(truth, 0, find_offset(truth.header, header.offsets[d]));
    for (std::size_t i = 0; i < header.pixels(); ++i) {
      if (std::isnan(found[i])) continue;
      const double error = found[i] - expected[i];
      chi2 += error * error /
              (header.noise_floor[0] * header.noise_floor[0] + header.noise_gain[0] * expected[i]);
      count += 1;
    }
  }
  // Far from Gaussian bins, and calibration errors are common to many pairs.
  EXPECT_GT(chi2 / count, 0.6);
  EXPECT_LT(chi2 / count, 1.7);
}

TEST(Capture, SameBitsForAnyNumberOfThreads) {
  const BssrdfTable truth = make_truth(5);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return process(synthesize(truth, make_meta(truth), {})).table.reflectance;
  };
  const std::vector<float> one = run(1), two = run(2);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i)
    if (!(std::isnan(one[i]) && std::isnan(two[i]))) {
      ASSERT_EQ(one[i], two[i]);
    }
}

// A folder whose frames can be spoiled one by one.
struct SpoiledCapture : testing::Test {
  static const Folder& good() {
    static const Folder folder = synthesize(make_truth(3), make_meta(make_truth(3)), {});
    return folder;
  }
  static std::string error_after(const std::function<void(Folder&)>& spoil) {
    Folder folder = good();
    spoil(folder);
    return error_of([&] { process(folder); });
  }
  static void fill(Folder& folder, const std::string& role, float value) {
    for (auto& [name, image] : folder.frames)
      if (name.substr(0, role.size()) == role)
        std::fill(image.values.begin(), image.values.end(), value);
  }
};

TEST_F(SpoiledCapture, SaturatedEverywhere) {
  EXPECT_EQ(error_after([](Folder& folder) { fill(folder, "white_", 1); }),
            "white_0_0.png: expected pixels that are not saturated at 0.01 s, found every pixel "
            "saturated");
  EXPECT_EQ(error_after([](Folder& folder) { fill(folder, "dots_002_001", 1); }),
            "dots_002_001_0.png: expected pixels that are not saturated at 0.01 s, found every "
            "pixel saturated");
}

TEST_F(SpoiledCapture, DotsNotFound) {
  EXPECT_EQ(error_after([](Folder& folder) { fill(folder, "reference_dots_", 0.01f); }),
            "dots: expected dots that stand out of the background, found none");
}

TEST_F(SpoiledCapture, LatticeMismatch) {
  EXPECT_EQ(error_after([](Folder& folder) { folder.meta.lattice_px = 7; }),
            "lattice: expected 4 x 3 dots, as the description says, found 9 dots, of which 9 make "
            "a lattice of 3 x 3");
}

TEST_F(SpoiledCapture, FramesThatDoNotAddUpAreReported) {
  Folder folder = good();
  for (auto& [name, image] : folder.frames)
    if (name.substr(0, 6) == "white_")
      for (float& value : image.values) value = value < 0.95f ? 0.9f * value : 1;
  EXPECT_NEAR(process(folder).report.white_error, 0.11, 0.02);
}

TEST_F(SpoiledCapture, GivenPointsReplaceTheDots) {
  Folder folder = good();
  CaptureMeta meta = folder.meta;
  const Homography h = make_camera({}, meta);
  for (const double x : {0.0, 6.0})
    for (const double y : {0.0, 5.0}) {
      const Point p = apply(h, x, y);
      folder.meta.points.push_back({x, y, p.x, p.y});
    }
  const CaptureResult result = process(folder);
  EXPECT_EQ(result.report.dots_found, 0);
  EXPECT_LT(judge(make_truth(3), result.table).relative_error.mean, 0.01);
}

TEST(CaptureMeta, ReadsWhatItWrites) {
  CaptureMeta meta = make_meta(make_truth(3));
  meta.points = {{0, 0, 1, 2}, {1, 0, 3, 4}, {0, 1, 5, 6}, {1, 1, 7, 8}};
  meta.format = FrameFormat::exr;
  meta.synthetic = true;
  const Document document = write_capture_meta(meta);
  const CaptureMeta read = read_capture_meta(locate(document));
  EXPECT_EQ(read.exposures_s, meta.exposures_s);
  EXPECT_EQ(read.points.size(), 4u);
  EXPECT_EQ(read.format, FrameFormat::exr);
  EXPECT_TRUE(read.synthetic);
  EXPECT_EQ(list_frames(read).size(), 6u * 3u * 4u + 81u * 3u);
  const auto error_with = [&](const char* key, Document value) {
    Document changed = document;
    set(changed, key, std::move(value));
    return error_of([&] { read_capture_meta(locate(changed)); });
  };
  EXPECT_EQ(error_with("lattice_px", 20),
            "s.json: /lattice_px: expected less than the 20 pixels of the shorter side, found 20");
  EXPECT_EQ(error_with("radius_px", 4.5),
            "s.json: /radius_px: expected at most 4, so that a pixel has one dot within it, "
            "found 4.5");
  EXPECT_EQ(error_with("exposures_s", array({0.1, 0.1})),
            "s.json: /exposures_s/1: expected exposures that increase from above 0, found 0.1");
  EXPECT_EQ(error_with("calibration_frames", 1),
            "s.json: /: expected two 'calibration_frames' or more, as there is no 'full_well', "
            "found 1");
  EXPECT_EQ(error_with("points", array({})),
            "s.json: /points: expected 4 to 4096 points, found an array of 0");
}

}  // namespace
}  // namespace parian

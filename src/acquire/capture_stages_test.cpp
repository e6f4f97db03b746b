// Each stage of a capture against what its input was made from.
#include <gtest/gtest.h>

#include <cmath>

#include "acquire/capture_geometry.h"
#include "acquire/capture_photometry.h"
#include "acquire/capture_resample.h"
#include "acquire/capture_slices.h"
#include "acquire/capture_synthesize.h"
#include "acquire/test_documents_internal.h"
#include "base/random.h"
#include "base/test_errors.h"

namespace parian {
namespace {

TEST(Photometry, ResponsesInvert) {
  for (const auto kind : {ResponseKind::linear, ResponseKind::srgb})
    for (int i = 0; i <= 50; ++i) {
      const double code = i / 50.0;
      EXPECT_NEAR(invert_response(make_response(kind), eval_response(make_response(kind), code)),
                  code, 1e-9);
    }
}

TEST(Photometry, ResponseIsRecoveredUpToItsScale) {
  for (const double gamma : {1.0, 1.8, 2.2}) {
    Rng rng = make_rng(3);
    const auto encode = [&](double linear) { return std::pow(std::min(1.0, linear), 1 / gamma); };
    std::vector<ExposurePair> pairs;
    for (int i = 0; i < 2000; ++i) {
      const double light = std::exp(-5 * sample_uniform(rng));
      pairs.push_back({encode(0.01 + light / 8), encode(0.01), 1, encode(0.01 + 0.95 * light),
                       encode(0.01), 8 * 0.95});
    }
    const Response response = recover_response(pairs);
    for (int i = 1; i <= 20; ++i)
      EXPECT_NEAR(eval_response(response, i / 20.0), std::pow(i / 20.0, gamma), 0.004) << gamma;
  }
  EXPECT_EQ(error_of([] { recover_response({}); }),
            "response: expected 50 pixels that are seen at two exposures or more, found 0");
}

// Frames of a flat light with noise.
Image make_frame(double level, double full_well, double read, Rng& rng) {
  Image image = make_image(100, 100, 1);
  for (float& value : image.values)
    value = static_cast<float>(
        0.02 + level +
        std::sqrt(level / full_well + read * read / (full_well * full_well)) * sample_normal(rng));
  return image;
}

TEST(Photometry, CameraNoiseIsFound) {
  Rng rng = make_rng(5);
  std::vector<Image> dark, light;
  for (int k = 0; k < 4; ++k) {
    dark.push_back(make_frame(0, 20000, 5, rng));
    light.push_back(make_frame(0.6, 20000, 5, rng));
  }
  const CameraNoise noise = estimate_camera_noise(dark, light, 0.95);
  // 30,000 degrees of freedom: 0.8 % standard deviation of a variance.
  EXPECT_NEAR(noise.full_well / 20000, 1, 0.04);
  EXPECT_NEAR(noise.read * 20000, 5, 0.1);
  EXPECT_EQ(error_of([&] { estimate_camera_noise(dark, dark, 0); }),
            "camera noise: expected frames that differ by the noise of their photons, found "
            "frames that do not");
}

TEST(Photometry, MergedExposuresAreUnbiasedWithTheStatedVariance) {
  Rng rng = make_rng(7);
  const CameraNoise noise{.read = 4.0 / 5000, .full_well = 5000};
  const std::vector<double> seconds{1, 8, 64};
  for (const double light : {0.0, 0.0005, 0.004, 0.05, 0.8}) {
    std::vector<ExposureMean> frames, dark;
    for (const double s : seconds) {
      Image image = make_frame(std::min(5.0, light * s), 5000, 4, rng);
      for (float& value : image.values) value = std::min(value, 1.0f);
      frames.push_back(average_frames({image}, {}, 0.95));
      Image level = make_image(100, 100, 1, 0.02f);
      dark.push_back(average_frames({level}, {}, 0.95));
      dark.back().frames = 1000000;  // known
    }
    const HdrImage merged = merge_exposures(frames, dark, seconds, noise);
    double mean = 0, variance = 0, stated = 0;
    for (std::size_t i = 0; i < 10000; ++i) {
      ASSERT_TRUE(std::isfinite(merged.variance.values[i]));
      mean += merged.value.values[i] / 1e4;
      stated += merged.variance.values[i] / 1e4;
    }
    for (const float value : merged.value.values) variance += (value - mean) * (value - mean) / 1e4;
    EXPECT_NEAR(mean, light, 4 * std::sqrt(stated / 1e4)) << light;
    // In the dark the photons' part is predicted from noise, and not below 0.
    EXPECT_NEAR(variance / stated, 1, light > 0 ? 0.1 : 0.15) << light;
  }
}

TEST(Photometry, SaturatedAtEveryExposureHasNoWeight) {
  const std::vector<ExposureMean> light{average_frames({make_image(2, 1, 1, 0.97f)}, {}, 0.95)};
  const std::vector<ExposureMean> dark{average_frames({make_image(2, 1, 1, 0.02f)}, {}, 0.95)};
  EXPECT_TRUE(std::isinf(merge_exposures(light, dark, {1}, {}).variance.values[0]));
}

Homography tilted() {
  return {{8, -0.6, 20, 0.5, 7.5, 15, 0.004, -0.003, 1}};
}

TEST(Geometry, HomographyIsFoundExactly) {
  std::vector<PointPair> points;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 4; ++j) {
      const Point p = apply(tilted(), 2.5 * i, 3.0 * j);
      points.push_back({2.5 * i, 3.0 * j, p.x, p.y});
    }
  const Homography found = fit_homography(points);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(found.m[k], tilted().m[k], 1e-7);
  EXPECT_LT(reprojection_error(found, points), 1e-9);
  const Point back = apply(invert(found), points[7].x_px, points[7].y_px);
  EXPECT_NEAR(back.x, points[7].x_mm, 1e-9);
  // The area's scale is the determinant of central differences.
  const double h = 1e-4;
  const Point x0 = apply(found, 3 - h, 2), x1 = apply(found, 3 + h, 2);
  const Point y0 = apply(found, 3, 2 - h), y1 = apply(found, 3, 2 + h);
  EXPECT_NEAR(area_scale(found, 3, 2),
              ((x1.x - x0.x) * (y1.y - y0.y) - (y1.x - y0.x) * (x1.y - x0.y)) / (4 * h * h), 1e-4);
}

TEST(Geometry, PointsOnALineAreRefused) {
  EXPECT_EQ(error_of([] {
              fit_homography({{0, 0, 0, 0}, {1, 0, 1, 0}, {2, 0, 2, 0}});
            }),
            "homography: expected 4 points or more, found 3");
  EXPECT_EQ(error_of([] {
              fit_homography({{0, 0, 0, 0}, {1, 0, 1, 0}, {2, 0, 2, 0}, {3, 0, 3, 0}});
            }),
            "homography: expected points that do not lie on one line, found such points");
}

CaptureMeta grid_meta() {
  CaptureMeta meta;
  meta.width = 30, meta.height = 22;
  meta.pixel_pitch_mm = 0.5;
  meta.lattice_px = 7;
  meta.radius_px = 3;
  meta.channels = 1;
  meta.camera_width = 180, meta.camera_height = 130;
  return meta;
}

TEST(Geometry, DotsAreFoundAndMatched) {
  const CaptureMeta meta = grid_meta();
  const Image white = make_image(meta.camera_width, meta.camera_height, 1, 2);
  Image image = predict_dots(meta, tilted(), 1.1, white);
  Rng rng = make_rng(2);
  for (float& value : image.values) value += static_cast<float>(0.01 * sample_normal(rng));
  const std::vector<Dot> dots = find_dots(image);
  EXPECT_EQ(dots.size(), 5u * 4u);
  for (const Dot& dot : dots) {
    const Point p = apply(invert(tilted()), dot.x, dot.y);
    // Power: exitance 2 over the dot's image.
    EXPECT_NEAR(dot.power, 2 * 0.25 * area_scale(tilted(), p.x, p.y), 1.5);
  }
  const std::vector<PointPair> points = match_lattice(dots, meta);
  ASSERT_EQ(points.size(), 20u);
  EXPECT_LT(reprojection_error(tilted(), points), 0.15);
  EXPECT_NEAR(estimate_psf(meta, tilted(), image, white), 1.1, 0.03);
}

// The operator's adjoint fit undoes what it does.
TEST(Resample, FindsTheExitance) {
  CaptureMeta meta = grid_meta();
  const CameraOperator b = make_camera_operator(meta, tilted(), 1.2);
  Rng rng = make_rng(4);
  std::vector<float> exitance(b.begin.size() - 1);
  for (float& value : exitance) value = static_cast<float>(sample_uniform(rng));
  const std::vector<float> seen = photograph(b, exitance);
  HdrImage image{make_image(180, 130, 1), make_image(180, 130, 1, 1e-6f)};
  image.value.values = seen;
  const std::vector<float> found = resample(b, image, 0);
  for (int y = 0; y < meta.height; ++y)
    for (int x = 0; x < meta.width; ++x) {
      const auto k =
          static_cast<std::size_t>((y + resample_margin_px) * b.width + x + resample_margin_px);
      ASSERT_NEAR(found[static_cast<std::size_t>(y * meta.width + x)], exitance[k], 2e-3);
    }
  // Pixels that are saturated do not count, and where all are there is no value.
  for (int y = 0; y < 130; ++y)
    for (int x = 0; x < 60; ++x) {
      at(image.value, x, y, 0) = 100;
      at(image.variance, x, y, 0) = INFINITY;
    }
  const std::vector<float> partly = resample(b, image, 0);
  EXPECT_TRUE(std::isnan(partly[0]));
  EXPECT_NEAR(partly[29], found[29], 1e-3);
}

TEST(Resample, UniformLightStaysUniform) {
  const CaptureMeta meta = grid_meta();
  const CameraOperator b = make_camera_operator(meta, tilted(), 0.9);
  const std::vector<float> seen = photograph(b, std::vector<float>(b.begin.size() - 1, 3.0f));
  const Point p = apply(tilted(), 7, 5);
  EXPECT_NEAR(seen[static_cast<std::size_t>(static_cast<int>(p.y) * 180 + static_cast<int>(p.x))],
              3, 0.003);
}

// Products of pixels' factors and a falling profile, over all dots of a frame.
double tail_of(double r) {
  return 0.2 * std::exp(-0.9 * r) + 0.01 * std::exp(-0.25 * r);
}
double factor_of(int x, int y) {
  return 1 + 0.3 * std::sin(0.4 * x) * std::cos(0.3 * y);
}
DotResponses make_responses(const CaptureMeta& meta, bool nearest_only) {
  DotResponses responses;
  for (int j = 0; j < meta.lattice_px; ++j)
    for (int i = 0; i < meta.lattice_px; ++i)
      for (int y = 0; y < meta.height; ++y)
        for (int x = 0; x < meta.width; ++x) {
          double sum = 0;
          for (int dy = j; dy < meta.height; dy += meta.lattice_px)
            for (int dx = i; dx < meta.width; dx += meta.lattice_px) {
              const double r = std::hypot(dx - x, dy - y);
              if (nearest_only && r > meta.radius_px) continue;
              sum += tail_of(r) * factor_of(x, y) * factor_of(dx, dy);
            }
          responses.value.push_back(static_cast<float>(sum));
        }
  return responses;
}

TEST(Slices, TailsOfNeighboursAreTakenAway) {
  CaptureMeta meta = grid_meta();
  meta.width = meta.height = 28;
  const BssrdfTable expected = make_raw_table(meta, make_responses(meta, true));
  DotResponses responses = make_responses(meta, false);
  const BssrdfTable before = make_raw_table(meta, responses);
  EXPECT_GT(remove_tails(meta, responses), 0.05);
  const BssrdfTable after = make_raw_table(meta, responses);
  double error_before = 0, error_after = 0;
  for (std::size_t i = 0; i < expected.reflectance.size(); ++i) {
    if (std::isnan(expected.reflectance[i])) continue;
    error_before += std::abs(before.reflectance[i] - expected.reflectance[i]);
    error_after += std::abs(after.reflectance[i] - expected.reflectance[i]);
  }
  EXPECT_LT(error_after, 0.12 * error_before);
}

TEST(Slices, NormalisedByTheStandard) {
  CaptureMeta meta = grid_meta();
  DotResponses responses = make_responses(meta, true);
  const BssrdfTable expected = make_raw_table(meta, responses);
  // A camera that sees V E rho / pi of the standard, V E R pitch^2 / pi of the sample, V = E.
  const auto light = [](int x, int y) { return 1 - 0.01 * x - 0.005 * y; };
  std::vector<float> reference;
  for (int y = 0; y < meta.height; ++y)
    for (int x = 0; x < meta.width; ++x)
      reference.push_back(static_cast<float>(light(x, y) * light(x, y) * meta.reference_albedo));
  std::size_t k = 0;
  for (int j = 0; j < meta.lattice_px; ++j)
    for (int i = 0; i < meta.lattice_px; ++i)
      for (int y = 0; y < meta.height; ++y)
        for (int x = 0; x < meta.width; ++x, ++k) {
          const auto nearest = [&](int at, int shift, int size) {
            int best = shift;
            for (int dot = shift; dot < size; dot += meta.lattice_px)
              if (std::abs(dot - at) < std::abs(best - at)) best = dot;
            return best;
          };
          responses.value[k] *= static_cast<float>(
              light(x, y) * light(nearest(x, i, meta.width), nearest(y, j, meta.height)) * 0.25);
        }
  normalise_responses(meta, reference, responses);
  const BssrdfTable found = make_raw_table(meta, responses);
  for (std::size_t i = 0; i < found.reflectance.size(); ++i)
    if (!std::isnan(found.reflectance[i])) {
      ASSERT_NEAR(found.reflectance[i], expected.reflectance[i], 1e-6);
    }
}

TEST(Slices, CentreIsContinued) {
  CaptureMeta meta = grid_meta();
  meta.centre_px = 1.2;
  DotResponses responses = make_responses(meta, true);
  BssrdfTable table = make_raw_table(meta, responses);
  for (std::size_t d = 0; d < table.header.offsets.size(); ++d)
    for (std::size_t i = 0; i < table.header.pixels(); ++i) {
      float& value = slice_of(table, 0, static_cast<int>(d))[i];
      if (std::isnan(value)) continue;
      const double r = length_px(table.header.offsets[d]);
      value =
          static_cast<float>(r < 1.2 ? 50 : std::exp(-0.7 * r));  // specular light in the middle
    }
  EXPECT_EQ(replace_centre(meta, table), 5);
  for (std::size_t d = 0; d < table.header.offsets.size(); ++d)
    for (std::size_t i = 0; i < table.header.pixels(); ++i) {
      const float value = slice_of(table, 0, static_cast<int>(d))[i];
      if (std::isnan(value)) continue;
      ASSERT_NEAR(value, std::exp(-0.7 * length_px(table.header.offsets[d])), 1e-4);
    }
}

TEST(Slices, NoiseModelIsFound) {
  CaptureMeta meta = grid_meta();
  meta.width = meta.height = 60;
  TableHeader header{.width = 60, .height = 60, .channels = 1, .symmetric = false};
  for (const Offset d : half_disc_offsets(4)) {
    header.offsets.push_back(d);
    if (d != Offset{}) header.offsets.push_back({-d.dx, -d.dy});
  }
  BssrdfTable table = make_bssrdf_table(header);
  Rng rng = make_rng(9);
  const double floor = 1e-3, gain = 2e-4;  // of the mean of two
  for (std::size_t d = 0; d < header.offsets.size(); ++d) {
    const PixelRange range = pairs_in_grid(header, header.offsets[d]);
    const double value = std::exp(-1.2 * length_px(header.offsets[d]));
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x)
        slice_of(table, 0, static_cast<int>(d))[y * 60 + x] = static_cast<float>(
            value + std::sqrt(2 * (floor * floor + gain * value)) * sample_normal(rng));
  }
  const NoiseModel model = fit_noise_model(table, 0);
  EXPECT_NEAR(model.floor, floor, 0.15 * floor);
  EXPECT_NEAR(model.gain, gain, 0.1 * gain);
  EXPECT_LT(model.relative, 0.01);
}

}  // namespace
}  // namespace parian

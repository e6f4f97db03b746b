#include "edit/synthesis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"
#include "edit/synthesis_seams.h"
#include "edit/synthesis_search.h"

namespace parian {
namespace {

using Indices = std::vector<std::uint32_t>;

std::size_t at(int y, int x, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

// Noise smoothed by a few passes of a small tent, around 5 with a deviation of about 1.
std::vector<float> make_clouds(int width, int height, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<float> plane(at(height, 0, width));
  for (float& value : plane) value = static_cast<float>(sample_normal(rng));
  for (int pass = 0; pass < 4; ++pass) {
    const std::vector<float> old = plane;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        float sum = 0;
        for (const int dy : {-1, 0, 1})
          for (const int dx : {-1, 0, 1})
            sum +=
                old[at(std::clamp(y + dy, 0, height - 1), std::clamp(x + dx, 0, width - 1), width)];
        plane[at(y, x, width)] = 0.45f * sum / 1.5f;
      }
  }
  return plane;
}

std::vector<float> take(const float* plane, const Indices& indices) {
  std::vector<float> values;
  values.reserve(indices.size());
  for (const std::uint32_t index : indices) values.push_back(plane[index]);
  return values;
}

double mean_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<float>& values) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const float value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// Mean squared difference of pixels one step apart inside the plane.
double roughness(const std::vector<float>& plane, int width, int height, int dx, int dy) {
  double sum = 0;
  for (int y = 0; y + dy < height; ++y)
    for (int x = 0; x + dx < width; ++x) {
      const double step = plane[at(y + dy, x + dx, width)] - plane[at(y, x, width)];
      sum += step * step;
    }
  return sum / ((width - dx) * (height - dy));
}

// The same across the borders that meet when the plane is tiled.
double wrap_roughness(const std::vector<float>& plane, int width, int height) {
  double sum = 0;
  for (int y = 0; y < height; ++y)
    sum += std::pow(plane[at(y, 0, width)] - plane[at(y, width - 1, width)], 2);
  for (int x = 0; x < width; ++x)
    sum += std::pow(plane[at(0, x, width)] - plane[at(height - 1, x, width)], 2);
  return sum / (width + height);
}

std::string error_text(const std::vector<float>& planes, int count, int width, int height,
                       const SynthesisParams& params) {
  return parian::error_of([&] { synthesize(planes, count, width, height, params); });
}

TEST(Synthesis, gives_valid_indices_for_any_size_and_patch) {
  const std::vector<float> plane = make_clouds(17, 12, 1);
  const int sizes[][2] = {{1, 1}, {2, 3}, {3, 40}, {12, 17}, {23, 21}};
  for (const auto& size : sizes)
    for (const int patch : {0, 1, 4000})
      for (const int overlap : {0, 4000})
        for (const bool tileable : {false, true}) {
          SynthesisParams params{.width_px = size[0], .height_px = size[1]};
          params.patch_px = patch;
          params.overlap_px = overlap;
          params.tileable = tileable;
          const Indices result = synthesize(plane, 1, 17, 12, params);
          ASSERT_EQ(result.size(), at(size[1], 0, size[0]));
          ASSERT_LT(*std::max_element(result.begin(), result.end()), 17u * 12u);
        }
}

TEST(Synthesis, ignores_planes_that_do_not_vary) {
  const std::size_t pixels = 24 * 20;
  const SynthesisParams params{.width_px = 40, .height_px = 30};
  std::vector<float> planes(pixels, -3.7f);
  const Indices constant = synthesize(planes, 1, 24, 20, params);
  EXPECT_LT(*std::max_element(constant.begin(), constant.end()), pixels);
  EXPECT_EQ(constant, synthesize({}, 0, 24, 20, params));

  const std::vector<float> clouds = make_clouds(24, 20, 2);
  planes.insert(planes.end(), clouds.begin(), clouds.end());
  EXPECT_EQ(synthesize(planes, 2, 24, 20, params), synthesize(clouds, 1, 24, 20, params));
}

TEST(Synthesis, does_not_depend_on_the_planes_units) {
  std::vector<float> plane = make_clouds(32, 32, 3);
  const SynthesisParams params{.width_px = 60, .height_px = 40};
  const Indices result = synthesize(plane, 1, 32, 32, params);
  for (float& value : plane) value *= 1024.0f;
  EXPECT_EQ(synthesize(plane, 1, 32, 32, params), result);
}

TEST(Synthesis, depends_on_the_seed_alone) {
  std::vector<float> planes;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const std::vector<float> plane = make_clouds(40, 36, seed);
    planes.insert(planes.end(), plane.begin(), plane.end());
  }
  SynthesisParams params{.width_px = 56, .height_px = 44};
  Indices first;
  {
    const ThreadLimit one(1);
    first = synthesize(planes, 3, 40, 36, params);
  }
  const ThreadLimit four(4);
  EXPECT_EQ(synthesize(planes, 3, 40, 36, params), first);
  params.seed = 2;
  EXPECT_NE(synthesize(planes, 3, 40, 36, params), first);
}

TEST(Synthesis, seams_are_as_smooth_as_the_sample) {
  const std::vector<float> plane = make_clouds(56, 48, 4);
  for (int seed = 0; seed < 2; ++seed) {
    const SynthesisParams params{.width_px = 112, .height_px = 96, .seed = seed};
    const std::vector<float> result = take(plane.data(), synthesize(plane, 1, 56, 48, params));
    EXPECT_LT(roughness(result, 112, 96, 1, 0), 1.1 * roughness(plane, 56, 48, 1, 0));
    EXPECT_LT(roughness(result, 112, 96, 0, 1), 1.1 * roughness(plane, 56, 48, 0, 1));
  }
}

TEST(Synthesis, keeps_the_planes_statistics) {
  std::vector<float> planes = make_clouds(64, 64, 5);
  const std::vector<float> other = make_clouds(64, 64, 6);
  planes.insert(planes.end(), other.begin(), other.end());
  const SynthesisParams params{.width_px = 128, .height_px = 128};
  const Indices result = synthesize(planes, 2, 64, 64, params);
  for (const std::size_t begin : {std::size_t{0}, other.size()}) {
    std::vector<float> sample(planes.begin() + static_cast<std::ptrdiff_t>(begin),
                              planes.begin() + static_cast<std::ptrdiff_t>(begin + other.size()));
    std::vector<float> values = take(planes.data() + begin, result);
    const double deviation = deviation_of(sample);
    EXPECT_NEAR(mean_of(values), mean_of(sample), 0.2 * deviation);
    EXPECT_NEAR(deviation_of(values), deviation, 0.15 * deviation);
    // Mean distance of equal quantiles (Wasserstein).
    std::sort(sample.begin(), sample.end());
    std::sort(values.begin(), values.end());
    double distance = 0;
    for (std::size_t k = 0; k < 64; ++k)
      distance += std::abs(sample[(2 * k + 1) * sample.size() / 128] -
                           values[(2 * k + 1) * values.size() / 128]);
    EXPECT_LT(distance / 64, 0.2 * deviation);
  }
}

TEST(Synthesis, continues_the_period_of_a_checkerboard) {
  std::vector<float> plane;
  plane.reserve(40 * 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) plane.push_back(((x / 4 + y / 4) % 2) != 0 ? 1.0f : 0.0f);
  for (const bool tileable : {false, true}) {
    SynthesisParams params{.width_px = 96, .height_px = 88, .patch_px = 16};  // overlap 5 > 4
    params.tileable = tileable;
    const std::vector<float> result = take(plane.data(), synthesize(plane, 1, 40, 40, params));
    int right = 0, total = 0;
    for (int y = 0; y + 4 < 88; ++y)
      for (int x = 0; x + 4 < 96; ++x, total += 2) {
        right += result[at(y, x, 96)] != result[at(y, x + 4, 96)] ? 1 : 0;
        right += result[at(y, x, 96)] != result[at(y + 4, x, 96)] ? 1 : 0;
      }
    EXPECT_GT(right, 0.98 * total);
  }
}

TEST(Synthesis, tileable_results_wrap_around) {
  const std::vector<float> plane = make_clouds(56, 48, 7);
  const double own = roughness(plane, 56, 48, 1, 0);
  SynthesisParams params{.width_px = 100, .height_px = 90, .tileable = true};
  std::vector<float> result = take(plane.data(), synthesize(plane, 1, 56, 48, params));
  EXPECT_LT(wrap_roughness(result, 100, 90), 1.4 * own);
  params.tileable = false;
  result = take(plane.data(), synthesize(plane, 1, 56, 48, params));
  EXPECT_GT(wrap_roughness(result, 100, 90), 3 * own);
}

// Pairs of pixels with one source, by their distance: regular copies would pile up in one entry.
TEST(Synthesis, does_not_repeat_itself) {
  const int width = 128, height = 128;
  const std::vector<float> plane = make_clouds(64, 64, 8);
  const SynthesisParams params{.width_px = width, .height_px = height};
  const Indices result = synthesize(plane, 1, 64, 64, params);
  std::vector<std::vector<std::size_t>> places(64 * 64);
  for (std::size_t i = 0; i < result.size(); ++i) places[result[i]].push_back(i);
  std::map<std::size_t, int> pairs;
  std::size_t most_used = 0;
  for (const auto& list : places) {
    most_used = std::max(most_used, list.size());
    for (std::size_t a = 0; a < list.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) ++pairs[list[a] - list[b]];
  }
  int most = 0;
  for (const auto& entry : pairs) most = std::max(most, entry.second);
  EXPECT_LT(most, 0.03 * width * height);
  EXPECT_LT(most_used, 16u);  // 4 if all were used equally
}

TEST(Synthesis, explains_what_is_wrong) {
  const std::vector<float> plane(25, 1.0f);
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_text(plane, 1, 5, 5, {.width_px = 0}),
            "width-px: expected a value in [1, 8192], found 0");
  EXPECT_EQ(error_text(plane, 1, 5, 5, {.width_px = 8192, .height_px = 2049}),
            "width-px x height-px: expected at most 16777216 pixels, found 8192 x 2049");
  EXPECT_EQ(error_text(plane, 1, 5, 5, {.tolerance = std::nan("")}),
            "tolerance: expected a value in [0, 10], found nan");
  EXPECT_EQ(error_text(plane, 1, 5, 5, {.seed = -1}), "seed: expected a value >= 0, found -1");
  EXPECT_EQ(error_text(std::vector<float>(15), 1, 5, 3, {}),
            "sample: expected at least 4 x 4 px, found 5 x 3 px");
  std::vector<float> planes(50, 1.0f);
  planes[25 + 5 + 3] = inf;
  EXPECT_EQ(error_text(planes, 2, 5, 5, {}),
            "plane 1 at x 3, y 1: expected a finite value, found inf");
}

TEST(Synthesis, reports_and_can_be_cancelled) {
  const std::vector<float> plane = make_clouds(32, 32, 9);
  std::vector<double> steps;
  Progress progress;
  progress.report = [&](std::string_view, double done) { steps.push_back(done); };
  const SynthesisParams params{.width_px = 64, .height_px = 64};
  synthesize(plane, 1, 32, 32, params, progress);
  EXPECT_GT(steps.size(), 4u);
  EXPECT_TRUE(std::is_sorted(steps.begin(), steps.end()));
  EXPECT_EQ(steps.back(), 1.0);

  steps.clear();
  progress.is_cancelled = [&] { return steps.size() >= 3; };
  EXPECT_THROW(synthesize(plane, 1, 32, 32, params, progress), Error);
  EXPECT_LE(steps.size(), 4u);
}

TEST(Synthesis, searches_as_a_direct_sum_does) {
  std::vector<float> planes = make_clouds(21, 18, 10);
  const std::vector<float> other = make_clouds(21, 18, 11);
  planes.insert(planes.end(), other.begin(), other.end());
  const TextureSample sample = make_texture_sample(planes, 2, 21, 18);
  ASSERT_EQ(sample.planes, 2);
  EXPECT_NEAR(sample.variance, 2.0, 1e-9);
  PatchSearch search(sample);
  const int width = 8, height = 7;
  const Overlap overlap{.left = 2, .right = 3, .top = 1, .bottom = 2};
  const auto covered = [](int y, int x) { return x < 2 || x >= 5 || y < 1 || y >= 5; };
  Rng rng = make_rng(12);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const std::size_t begin : {std::size_t{0}, sample.pixels()})
        if (covered(y, x))
          search.wanted()[begin + at(y, x, 21)] = static_cast<float>(sample_normal(rng));
  std::vector<float> found;
  search.run(width, height, overlap, found);
  ASSERT_EQ(found.size(), 14u * 12u);
  for (int v = 0; v < 12; ++v)
    for (int u = 0; u < 14; ++u) {
      double sum = 0;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          for (const std::size_t begin : {std::size_t{0}, sample.pixels()})
            if (covered(y, x))
              sum += std::pow(sample.values[begin + at(v + y, u + x, 21)] -
                                  search.wanted()[begin + at(y, x, 21)],
                              2);
      ASSERT_NEAR(found[at(v, u, 14)], sum, 1e-3);
    }
}

// All paths through a small band, by counting in base 3.
TEST(SynthesisSeams, finds_the_path_of_least_error) {
  const int length = 6, width = 4;
  Rng rng = make_rng(13);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<float> error(at(length, 0, width));
    for (float& value : error) value = static_cast<float>(sample_uniform(rng));
    double least = 1e9;
    for (int code = 0; code < width * 243; ++code) {
      int place = code % width, rest = code / width;
      double sum = error[at(0, place, width)];
      for (int step = 1; step < length; ++step, rest /= 3) {
        place += rest % 3 - 1;
        if (place < 0 || place >= width) break;
        sum += error[at(step, place, width)];
      }
      if (place >= 0 && place < width) least = std::min(least, sum);
    }
    const std::vector<int> seam = cut_seam(error, length, width);
    double sum = 0;
    for (int step = 0; step < length; ++step) {
      const int place = seam[static_cast<std::size_t>(step)];
      sum += error[at(step, place, width)];
      if (step > 0) {
        EXPECT_LE(std::abs(place - seam[static_cast<std::size_t>(step - 1)]), 1);
      }
    }
    EXPECT_NEAR(sum, least, 1e-6);
  }
}

TEST(SynthesisSeams, cuts_every_side_where_the_error_is_least) {
  const int width = 9, height = 8;
  std::vector<float> error(at(height, 0, width), 1.0f);
  for (int y = 0; y < height; ++y) error[at(y, 1, width)] = error[at(y, 7, width)] = 0;
  for (int x = 0; x < width; ++x) error[at(2, x, width)] = error[at(6, x, width)] = 0;
  const auto cut = cut_patch(error, width, height, {.left = 3, .right = 3, .top = 3, .bottom = 2});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      EXPECT_EQ(cut[at(y, x, width)], x >= 1 && x <= 7 && y >= 2 && y <= 6 ? 1 : 0);
  const auto whole = cut_patch(error, width, height, {});
  EXPECT_EQ(std::count(whole.begin(), whole.end(), 1), width * height);
}

}  // namespace
}  // namespace parian

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/sample.h"
#include "acquire/test_documents_internal.h"
#include "base/random.h"

namespace parian {
namespace {

// Coefficients that are independent random numbers at every pixel.
Sample random_sample(int width, int height) {
  Sample sample;
  sample.width = width, sample.height = height, sample.channels = 1;
  sample.pixel_pitch_mm = 0.3, sample.radius_px = 6;
  sample.description = object({});
  Rng rng = make_rng(9);
  for (std::size_t i = 0; i < sample.pixels(); ++i) {
    sample.sigma_a.push_back(static_cast<float>(0.01 + sample_uniform(rng)));
    sample.sigma_s_prime.push_back(static_cast<float>(0.5 + 2 * sample_uniform(rng)));
  }
  return sample;
}

std::vector<float> read(const SliceSource& source, int channel, Offset offset) {
  std::vector<float> slice(source.header().pixels());
  source.read_slice(channel, find_offset(source.header(), offset), slice.data());
  return slice;
}

TEST(Analytic, HomogeneousIsTheDipole) {
  for (const char* name : {"Marble", "Ketchup", "Spectralon"}) {
    const Sample sample = read_sample(locate(homogeneous_description(name)), {});
    const auto source = make_analytic_source(sample);
    const NamedMaterial& material = find_named_material(name);
    for (const Offset offset : source->header().offsets)
      for (int c = 0; c < 3; ++c) {
        const auto slice = read(*source, c, offset);
        const double expected = eval_dipole(material.channels[static_cast<std::size_t>(c)],
                                            material.eta, 0.25 * length_px(offset));
        const PixelRange range = pairs_in_grid(source->header(), offset);
        const float value = slice[static_cast<std::size_t>(range.y0 * 24 + range.x0)];
        ASSERT_NEAR(value, expected, 2e-6 * expected) << name << offset.dx << ' ' << offset.dy;
      }
  }
}

TEST(Analytic, HeaderSaysWhatItIs) {
  const Sample sample = read_sample(locate(chessboard_description()), {});
  const TableHeader header = make_analytic_source(sample)->header();
  EXPECT_EQ(header.boundary, Boundary::excluded);
  EXPECT_EQ(header.sampling, Sampling::point);
  EXPECT_TRUE(header.symmetric);
  EXPECT_EQ(header.eta, 1.5);
  EXPECT_EQ(header.offsets.size(), 41u);  // 81 lattice points in a disc of radius 5
  EXPECT_THAT(header.provenance,
              testing::StartsWith("{\"kind\":\"analytic\",\"simulated\":true,\"model\":"));
  EXPECT_THAT(header.provenance, testing::HasSubstr("\"size\":[24,20]"));
  EXPECT_THAT(header.provenance, testing::EndsWith("\"seed\":3}}"));
}

TEST(Analytic, ValuesAreFiniteAndPositiveInsideTheGridOnly) {
  const Sample sample = random_sample(19, 13);
  const auto source = make_analytic_source(sample);
  for (const Offset offset : source->header().offsets) {
    const auto slice = read(*source, 0, offset);
    for (int y = 0; y < 13; ++y)
      for (int x = 0; x < 19; ++x) {
        const int tx = x + offset.dx, ty = y + offset.dy;
        const bool is_inside = tx >= 0 && tx < 19 && ty >= 0 && ty < 13;
        const float value = slice[static_cast<std::size_t>(y * 19 + x)];
        ASSERT_EQ(std::isfinite(value), is_inside);
        ASSERT_EQ(value > 0, is_inside);
      }
  }
}

// Turned by 180 degrees, a pair's ends change places: the same bits say that neither is the source.
TEST(Analytic, IsSymmetricBitForBit) {
  const Sample sample = random_sample(19, 13);
  Sample turned = sample;
  std::reverse(turned.sigma_a.begin(), turned.sigma_a.end());
  std::reverse(turned.sigma_s_prime.begin(), turned.sigma_s_prime.end());
  const auto source = make_analytic_source(sample);
  const auto turned_source = make_analytic_source(turned);
  for (const Offset offset : source->header().offsets) {
    const auto a = read(*source, 0, offset);
    const auto b = read(*turned_source, 0, offset);
    const PixelRange range = pairs_in_grid(source->header(), offset);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const int from = y * 19 + x;
        const int to = (12 - y - offset.dy) * 19 + (18 - x - offset.dx);
        ASSERT_EQ(a[static_cast<std::size_t>(from)], b[static_cast<std::size_t>(to)]);
      }
  }
}

TEST(Analytic, TransposedSampleGivesTheTransposedTable) {
  const Sample sample = random_sample(12, 12);
  Sample transposed = sample;
  for (std::size_t y = 0; y < 12; ++y)
    for (std::size_t x = 0; x < 12; ++x) {
      transposed.sigma_a[x * 12 + y] = sample.sigma_a[y * 12 + x];
      transposed.sigma_s_prime[x * 12 + y] = sample.sigma_s_prime[y * 12 + x];
    }
  const auto source = make_analytic_source(sample);
  const auto other = make_analytic_source(transposed);
  for (const Offset d : {Offset{3, 1}, Offset{0, 4}, Offset{2, 2}}) {
    const auto a = read(*source, 0, d);
    const auto b = read(*other, 0, {d.dy, d.dx});
    for (std::size_t y = 0; y + 4 < 12; ++y)
      for (std::size_t x = 0; x + 4 < 12; ++x)
        ASSERT_NEAR(a[y * 12 + x], b[x * 12 + y], 1e-6f * a[y * 12 + x]);
  }
}

// Pairs of equal length at one pixel differ by what lies between them, which no radial profile of
// the pixel and no function of both ends alone can tell.
TEST(Analytic, DependsOnTheDirection) {
  Sample sample = random_sample(15, 15);
  std::fill(sample.sigma_a.begin(), sample.sigma_a.end(), 0.05f);
  std::fill(sample.sigma_s_prime.begin(), sample.sigma_s_prime.end(), 1.f);
  for (std::size_t y = 0; y < 15; ++y) sample.sigma_a[y * 15 + 9] = 3;  // a dark wall at x = 9
  const auto source = make_analytic_source(sample);
  const std::size_t centre = 7 * 15 + 7;
  const float across = read(*source, 0, {4, 0})[centre];
  const float along = read(*source, 0, {0, 4})[centre];
  EXPECT_LT(across, 0.8f * along);
}

TEST(Analytic, UnderflowStaysPositive) {
  Sample sample = random_sample(8, 8);
  std::fill(sample.sigma_a.begin(), sample.sigma_a.end(), 1000.f);
  const auto slice = read(*make_analytic_source(sample), 0, {6, 0});
  EXPECT_EQ(slice[0], std::numeric_limits<float>::min());
}

}  // namespace
}  // namespace parian

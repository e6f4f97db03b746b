// The vector kernels of profile shapes: against double precision, and the same bits for every
// instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "edit/shape_variants_internal.h"
#include "edit/test_states_internal.h"
#include "material/properties.h"

namespace parian {
namespace {

// Profiles of all kinds side by side: steep and flat ones, that rise, that end in the window or
// not.
struct Block {
  std::vector<double> knots;
  AlignedVector<float> rows;
  alignas(64) float scale[shape_lanes];
  alignas(64) float weight[shape_lanes];
  alignas(64) float shift[shape_lanes];
};

Block make_block(std::uint64_t seed) {
  Rng rng = make_rng(seed, 3);
  Block block;
  const int knots = 2 + static_cast<int>(seed * 5 % 31);
  for (int k = 0; k < knots; ++k)
    block.knots.push_back(
        k == 0 ? 0 : block.knots.back() + (seed % 2 == 0 ? 0.25 : random_between(rng, 0.05, 1.5)));
  block.rows = AlignedVector<float>(block.knots.size() * shape_lanes);
  const double spread = seed % 3 == 0 ? 0.02 : 1;
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const double drop = i % 7 == 0 ? 1e-3 : random_between(rng, 0.01, 4);
    double value = random_between(rng, -5, 1);
    for (std::size_t k = 0; k < block.knots.size(); ++k) {
      block.rows[k * shape_lanes + i] = static_cast<float>(value);
      value -= random_between(rng, i % 5 == 0 ? -0.3 * drop : 0, drop);
    }
    block.scale[i] = static_cast<float>(std::exp(spread * random_between(rng, -1.2, 1.2)));
    block.weight[i] = static_cast<float>(i % 9 == 0 ? 0 : random_between(rng, 0, 1));
    block.shift[i] = static_cast<float>(random_between(rng, -3, 3));
  }
  return block;
}

Profile lane(const Block& block, std::size_t i) {
  std::vector<double> values;
  for (std::size_t k = 0; k < block.knots.size(); ++k)
    values.push_back(static_cast<double>(block.rows[k * shape_lanes + i]));
  return make_profile(block.knots, values);
}

TEST(ShapeKernels, MeasureAsTheMaterialDoes) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Block block = make_block(seed);
    const KnotTable knots = make_knot_table(block.knots);
    for (const std::size_t count : {shape_lanes, std::size_t{5}}) {
      double albedo[shape_lanes], range_mm[shape_lanes];
      measure_shapes(knots, block.rows.data(), shape_lanes, count, albedo, range_mm);
      for (std::size_t i = 0; i < count; ++i) {
        const Profile profile = lane(block, i);
        EXPECT_NEAR(albedo[i] / diffuse_albedo(profile), 1, 1e-12) << seed << ' ' << i;
        EXPECT_NEAR(range_mm[i] / profile_range(profile), 1, 1e-12) << seed << ' ' << i;
      }
    }
  }
}

// Neighbouring lanes may look at places far apart.
TEST(ShapeKernels, SamplesAreTheProfilesAtOtherRadii) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Block block = make_block(seed);
    const KnotTable knots = make_knot_table(block.knots);
    double albedo[shape_lanes], range_mm[shape_lanes];
    measure_shapes(knots, block.rows.data(), shape_lanes, shape_lanes, albedo, range_mm);
    ShapeTails tails;
    find_tails(knots, block.rows.data(), range_mm, &tails);
    AlignedVector<float> found(block.rows.size());
    sample_shapes(view_rows(knots, block.rows.data(), tails), block.scale, found.data());
    for (std::size_t i = 0; i < shape_lanes; ++i) {
      const Profile profile = lane(block, i);
      for (std::size_t k = 0; k < block.knots.size(); ++k) {
        const double r = block.knots[k] * static_cast<double>(block.scale[i]);
        if (std::abs(r / profile.support_mm - 1) < 1e-4) continue;
        const float value = found[k * shape_lanes + i];
        if (r > profile.support_mm)
          EXPECT_EQ(value, log_of_zero);
        else
          EXPECT_NEAR(static_cast<double>(value), eval_log_profile(profile, r), 2e-5)
              << seed << ' ' << i << ' ' << k;
      }
    }
  }
}

TEST(ShapeKernels, MixturesAreSumsOfBothSides) {
  const Block a = make_block(2), b = make_block(33);
  const std::size_t knots = std::min(a.knots.size(), b.knots.size());
  AlignedVector<float> found(knots * shape_lanes);
  mix_shapes(a.rows.data(), a.shift, b.rows.data(), b.shift, a.weight, knots, found.data());
  for (std::size_t at = 0; at < found.size(); ++at) {
    const std::size_t i = at % shape_lanes;
    const auto w = static_cast<double>(a.weight[i]);
    const double ya = static_cast<double>(a.rows[at] + a.shift[i]),
                 yb = static_cast<double>(b.rows[at] + b.shift[i]);
    EXPECT_NEAR(static_cast<double>(found[at]), std::log((1 - w) * std::exp(ya) + w * std::exp(yb)),
                3e-6 * (1 + std::abs(ya)));
  }
}

// All that one variant makes of a block.
std::vector<unsigned char> run_variant(const ShapeVariant& variant, const Block& block) {
  const KnotTable table = make_knot_table(block.knots);
  const std::size_t n = block.knots.size();
  const float* rows = block.rows.data();
  double albedo[shape_lanes], range_mm[shape_lanes];
  measure_shapes(table, rows, shape_lanes, shape_lanes, albedo, range_mm);
  ShapeTails tails;
  find_tails(table, rows, range_mm, &tails);
  ShapeCrossings crossings;
  ShapeSums sums;
  AlignedVector<float> sampled(n * shape_lanes), mixed(n * shape_lanes);
  variant.sum(rows, shape_lanes, table.radius.data(), n, &sums);
  variant.cross(rows, shape_lanes, n, &crossings);
  variant.finish(rows + (n - 2) * shape_lanes, rows + (n - 1) * shape_lanes, block.knots[n - 1],
                 block.knots[n - 1] - block.knots[n - 2], &crossings, &sums);
  variant.sample(view_rows(table, rows, tails), block.scale, sampled.data());
  variant.mix(rows, block.shift, sampled.data(), block.shift, block.weight, n, mixed.data());
  std::vector<unsigned char> bytes;
  const auto add = [&](const void* from, std::size_t count) {
    const auto* at = static_cast<const unsigned char*>(from);
    bytes.insert(bytes.end(), at, at + count);
  };
  add(&sums, sizeof sums);
  add(&crossings, sizeof crossings);
  add(sampled.data(), sampled.size() * sizeof(float));
  add(mixed.data(), mixed.size() * sizeof(float));
  return bytes;
}

TEST(ShapeKernels, EveryInstructionSetGivesTheSameBits) {
  const std::vector<ShapeVariant> variants = supported_shape_variants();
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Block block = make_block(seed);
    const std::vector<unsigned char> expected = run_variant(variants.front(), block);
    for (const ShapeVariant& variant : variants)
      EXPECT_TRUE(run_variant(variant, block) == expected) << variant.name << ' ' << seed;
  }
}

}  // namespace
}  // namespace parian

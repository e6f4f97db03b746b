#include "transport/knot_lookup.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace parian {
namespace {

// The segment by search.
int search(const std::vector<float>& knots, float r) {
  int k = 0;
  while (k + 2 < static_cast<int>(knots.size()) && r >= knots[static_cast<std::size_t>(k) + 1]) ++k;
  return k;
}

void expect_same(const std::vector<float>& knots) {
  const KnotLookup lookup = make_knot_lookup(knots);
  Rng rng = make_rng(1);
  for (float knot : knots)
    for (float r : {knot, std::nextafter(knot, 0.0f), std::nextafter(knot, knots.back())})
      ASSERT_EQ(find_segment(view(lookup), r), search(knots, r)) << r;
  for (int i = 0; i < 20000; ++i) {
    const auto r = static_cast<float>(sample_uniform(rng)) * knots.back();
    ASSERT_EQ(find_segment(view(lookup), r), search(knots, r)) << r;
  }
}

TEST(KnotLookup, FindsTheSegment) {
  expect_same({0, 1});
  expect_same({0, 0.25f, 0.5f, 0.75f, 1, 1.25f, 1.6f, 2.2f, 4});
  expect_same({0, 1e-4f, 2, 2.001f, 2.002f, 7});
  std::vector<float> many;
  for (int k = 0; k <= 256; ++k) many.push_back(0.1f * static_cast<float>(k));
  expect_same(many);
  std::vector<float> graded{0};
  for (int k = 0; k < 100; ++k)
    graded.push_back(graded.back() + 0.001f * std::pow(1.08f, static_cast<float>(k)));
  expect_same(graded);
}

}  // namespace
}  // namespace parian

// What the tests of the rival compressions share.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "base/aligned.h"
#include "base/random.h"

namespace parian {

inline AlignedVector<float> random_values(std::size_t count, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  AlignedVector<float> values(count);
  for (float& value : values) value = static_cast<float>(sample_uniform(rng));
  return values;
}

inline void expect_not_rising(const std::vector<double>& history, double rounding) {
  ASSERT_GE(history.size(), 2u);
  for (std::size_t i = 1; i < history.size(); ++i)
    EXPECT_LE(history[i], history[i - 1] + rounding * history[0]) << i;
  EXPECT_LT(history.back(), history.front());
}

}  // namespace parian

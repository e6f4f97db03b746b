#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace parian {
namespace {

TEST(Parallel, VisitsEveryIndexOnce) {
  std::vector<std::atomic<int>> visits(1000);
  parallel_for(visits.size(), [&](std::size_t i) { ++visits[i]; });
  for (const auto& count : visits) EXPECT_EQ(count, 1);
}

TEST(Parallel, SumHasTheSameBitsForAnyNumberOfThreads) {
  const auto sum = [] {
    return parallel_sum(100'003, 1000, [](std::size_t begin, std::size_t end) {
      double part = 0;
      for (std::size_t i = begin; i < end; ++i) part += std::sin(static_cast<double>(i));
      return part;
    });
  };
  double one = 0;
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(thread_count(), 1);
    one = sum();
  }
  const ThreadLimit limit(4);
  EXPECT_EQ(sum(), one);
}

TEST(Parallel, RethrowsWhatABodyThrows) {
  EXPECT_THROW(parallel_for(10,
                            [](std::size_t i) {
                              if (i == 7) throw std::runtime_error("seven");
                            }),
               std::runtime_error);
}

TEST(Parallel, EmptyRangesDoNothing) {
  parallel_for(0, [](std::size_t) { FAIL(); });
  EXPECT_EQ(parallel_sum(0, 16, [](std::size_t, std::size_t) { return 1.0; }), 0.0);
}

}  // namespace
}  // namespace parian

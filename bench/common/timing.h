// Time taken by work.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>

#include "base/stopwatch.h"

namespace parian {

// The least of `runs`.
inline double best_seconds(int runs, const std::function<void()>& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) {
    const Stopwatch watch;
    work();
    best = std::min(best, watch.seconds());
  }
  return best;
}

}  // namespace parian

// Running minimum, mean and maximum.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace parian {

// Of a stream of numbers; infinities of the wrong sign while there is none.
struct Statistics {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;
  std::size_t count = 0;
};

inline void add(Statistics& statistics, double value) {
  statistics.min = std::min(statistics.min, value);
  statistics.max = std::max(statistics.max, value);
  statistics.sum += value;
  ++statistics.count;
}

// Not a number without values.
inline double mean(const Statistics& statistics) {
  return statistics.count == 0 ? std::numeric_limits<double>::quiet_NaN()
                               : statistics.sum / static_cast<double>(statistics.count);
}

}  // namespace parian

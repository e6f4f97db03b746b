#include "app/report/pictures.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace parian {

double largest_value(const Image& values) {
  double largest = 0;
  for (float value : values.values)
    if (std::isfinite(value)) largest = std::max(largest, static_cast<double>(value));
  return largest;
}

Image absolute_difference(const Image& a, const Image& b) {
  PARIAN_CHECK_EQ(a.values.size(), b.values.size());
  Image difference = a;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    difference.values[i] = std::abs(a.values[i] - b.values[i]);
  return difference;
}

}  // namespace parian

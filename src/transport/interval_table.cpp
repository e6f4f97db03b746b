#include "transport/interval_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"

namespace parian {
namespace {

// Through the functions' values at a quarter, the middle and three quarters of the interval: places
// at knots may count for either side.
std::array<std::array<float, 3>, 3> find_polynomials(const SplineBasis& basis, std::size_t k) {
  const double start = basis.knots[k], length = basis.knots[k + 1] - start;
  std::array<std::array<float, 3>, 3> c{};
  for (std::size_t i = 0; i <= static_cast<std::size_t>(basis.degree); ++i) {
    std::vector<double> unit(basis.size(), 0);
    unit[k + i] = 1;
    const auto at = [&](double t) { return eval_spline(basis, unit, start + t * length); };
    const double low = at(0.25), middle = at(0.5), high = at(0.75);
    const double second = 8 * (low - 2 * middle + high), first = 2 * (high - low) - second;
    c[i] = {static_cast<float>(middle - first / 2 - second / 4), static_cast<float>(first),
            static_cast<float>(second)};
  }
  return c;
}

constexpr double most_bins = 65536;

}  // namespace

IntervalTable make_interval_table(const SplineBasis& basis) {
  PARIAN_CHECK_EQ(basis.knots.front(), 0.0);
  IntervalTable table;
  table.degree = basis.degree;
  table.functions = basis.size();
  table.reach = static_cast<float>(basis.knots.back());
  double shortest = basis.knots.back();
  for (std::size_t k = 0; k < basis.intervals(); ++k) {
    const double length = basis.knots[k + 1] - basis.knots[k];
    shortest = std::min(shortest, length);
    table.c.push_back(find_polynomials(basis, k));
    table.start.push_back(static_cast<float>(basis.knots[k]));
    table.end.push_back(static_cast<float>(basis.knots[k + 1]));
    table.inverse_length.push_back(static_cast<float>(1 / length));
  }
  const double bins = std::ceil(1.01 * basis.knots.back() / shortest);
  if (!(bins <= most_bins))
    throw Error({"", "knots", fmt::format("intervals of at least 1/{} of the reach", most_bins),
                 fmt::format("one of {} mm of {} mm", shortest, basis.knots.back())});
  table.bins_per_mm = static_cast<float>(bins / basis.knots.back());
  int k = 0;
  for (std::size_t bin = 0; bin < static_cast<std::size_t>(bins) + 2; ++bin) {
    // A little before the bin, so that rounding never leads too far.
    const float start = (static_cast<float>(bin) - 0.01f) / table.bins_per_mm;
    while (k + 1 < static_cast<int>(table.end.size()) &&
           table.end[static_cast<std::size_t>(k)] <= start)
      ++k;
    table.interval_of_bin.push_back(k);
  }
  return table;
}

}  // namespace parian

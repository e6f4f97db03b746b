// Tests of random quantities, with fixed seeds and with correction for how many there are.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace parian {

// The two-sided tail of a standard normal variable.
inline double normal_tail(double z) {
  return std::erfc(std::abs(z) / std::sqrt(2.0));
}

// P(chi^2 > value) by Wilson and Hilferty, good to a few per cent of p for 5 and more degrees.
inline double chi_square_tail(double value, double degrees) {
  const double t = 2 / (9 * degrees);
  const double z = (std::cbrt(value / degrees) - (1 - t)) / std::sqrt(t);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

// Counts of bins against expected counts, all of at least 5.
inline double chi_square_p(const std::vector<double>& counts, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i)
    sum += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
  return chi_square_tail(sum, static_cast<double>(counts.size() - 1));
}
inline double chi_square_p(const std::vector<double>& counts) {
  double total = 0;
  for (const double count : counts) total += count;
  return chi_square_p(
      counts, std::vector<double>(counts.size(), total / static_cast<double>(counts.size())));
}

// What p must exceed so that `tests` sound tests together fail once in a thousand seeds (Sidak).
inline double least_p(int tests) {
  return -std::expm1(std::log1p(-1e-3) / tests);
}

}  // namespace parian

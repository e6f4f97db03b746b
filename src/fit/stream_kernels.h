// Vectorised inner loops of the streaming pass. Private to fit.
#pragma once

#include <cstddef>

namespace parian {

// Fixed partial sums: the same bits for every instruction set.
inline constexpr std::size_t lane_count = 8;
// Offsets whose contributions are added in one sweep.
inline constexpr std::size_t batch_size = 4;

// Values that are taken from logarithm to sums while they are in first-level cache.
inline constexpr std::size_t log_strip = 4 * lane_count;

// y = 2 ln R where R is known, else 0. Adds to the sums of squares [lane_count] and counts known
// values. Both arrays go on to the next multiple of log_strip: r is read there, y set to 0.
void double_logs(const float* r, float* y, std::size_t count, double* lanes, int* known);

// low += sum_j a_j (s_j + t_j), high += sum_j b_j (s_j + t_j) over a batch; sources are s0, t0, s1,
// ...
void accumulate_row(double* low, double* high, const float* const* sources, const double* a,
                    const double* b, std::size_t count);

// Sum of the positive values.
double sum_known(const float* values, std::size_t count);

}  // namespace parian

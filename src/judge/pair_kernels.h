// The inner loops of comparing and relighting, over runs of neighbouring pairs. Every sum is per
// element, so the order of summation, and with it the bits, do not depend on the instruction set.
#pragma once

#include <cstddef>
#include <vector>

namespace parian {

// The values as doubles, 0 where not measured.
void widen_measured(const float* values, std::size_t count, double* wide);

struct PairCounts {
  std::size_t compared = 0;  // both have a value
  std::size_t missing = 0;   // measured, but the model has none
};
// Data and model as doubles, both 0 where either has no value.
PairCounts widen_compared(const float* data, const float* model, std::size_t count,
                          double* wide_data, double* wide_model);

// Per element: error2 += (m - d)^2, data2 += d^2, error1 += |m - d|, data1 += |d|.
void add_errors(const double* data, const double* model, std::size_t count, double* error2,
                double* data2, double* error1, double* data1);

// sum += value
void add_values(const double* values, std::size_t count, double* sum);
// sum += value * light
void add_lit(const double* values, const float* light, std::size_t count, double* sum);

// Irradiance of one channel, and in each row the span outside of which it is 0.
struct LightPlane {
  std::size_t width = 0;
  std::vector<float> values;
  std::vector<std::size_t> begin, end;  // columns
};
LightPlane make_light_plane(std::vector<float> values, std::size_t width);
// The same for pixels of one row of the plane, from index `lit_from` on; dark ones cost nothing.
void add_lit(const double* values, const LightPlane& light, std::size_t lit_from, std::size_t count,
             double* sum);

// model / data where both have a value and data > floor (>= 0), with neither below the smallest
// normal float; 1 elsewhere. Returns the number of ratios.
std::size_t make_ratios(const float* data, const float* model, std::size_t count, double floor,
                        float* ratios);
// sum += weight * value^2
void add_squares(const float* values, std::size_t count, double weight, double* sum);

}  // namespace parian

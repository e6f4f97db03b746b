// The near term of gather.h: samples around a target, with the kernel scaled so that it keeps its
// integral, and the mean irradiance in place of samples where too few carry it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "transport/gather_kernels.h"

namespace parian {

// w(r) = (1 - (r / near_mm)^2)^2, 0 beyond near_mm.
double near_weight(double r, double near_mm);

// Normals and flux of the samples, in the emitters' order: what the near term needs beside them.
struct NearSamples {
  std::vector<Vec3> normal;
  std::vector<Rgb> flux;
  double area_mm2 = 0;
};

// Over a plane around the block's targets, [channel][lane].
struct NearIntegrals {
  std::array<double, 3 * lanes> weight{};  // I = int P_o w dA
  std::array<double, 3 * lanes> square{};  // int (P_o w)^2 dA
};
NearIntegrals integrate_near(const TargetBlock& block, const std::vector<float>& knots,
                             double near_mm);

// Adds to sum[channel][lane] what the emitters (all samples) contribute: those nearer than near_mm
// by the near term, the rest plainly.
void add_near(const EmitterView& emitters, const KnotView& lookup, const NearSamples& samples,
              const std::vector<std::uint32_t>& ids, const TargetBlock& block,
              const std::vector<float>& knots, double near_mm, double* sum);

// I / W, at most 1 + 2 / (n - 1) or its inverse, n = I^2 / (area int (P_o w)^2 dA) being the number
// of samples that carry the integral: many samples miss it by little; what they miss by more is no
// noise but a surface that is no plane.
double near_scale(double weight, double integral, double square, double area_mm2);

// How far the sum over n samples is trusted, 0 to 1: functions that fewer than 2 samples carry get
// their integral times the mean irradiance around instead, those of 8 or more the sum alone.
double near_trust(double n);
// The mean is taken over about 20 samples, weighted towards the nearest.
double near_mean_mm(double area_mm2);

}  // namespace parian

// Seeded smooth noise over the plane and in space: a stationary field of mean 0 and variance 1 at
// every point, made of cubic B-splines over a lattice of hashed random numbers. Twice
// differentiable.
#pragma once

#include <cstdint>

namespace parian {

// The lattice spacing is 1: structures are about two units across.
double eval_noise(std::uint64_t seed, double u, double v);

double eval_noise(std::uint64_t seed, double u, double v, double w);

// Sum of octaves (frequency x 2, amplitude x 1/2, each rotated), again of variance 1.
double eval_fractal_noise(std::uint64_t seed, double u, double v, int octaves);
double eval_fractal_noise(std::uint64_t seed, double u, double v, double w, int octaves);

}  // namespace parian

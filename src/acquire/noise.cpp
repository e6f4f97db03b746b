#include "acquire/noise.h"

#include <cmath>

#include "base/random.h"

namespace parian {
namespace {

// Uniform cubic B-spline at t in [0, 1): weights of the nodes at -1, 0, 1, 2.
struct Spline {
  double weight[4];
  double norm_squared;
};
Spline make_spline(double t) {
  const double s = 1 - t;
  Spline spline{{s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6,
                 (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6},
                0};
  for (const double weight : spline.weight) spline.norm_squared += weight * weight;
  return spline;
}

}  // namespace

double eval_noise(std::uint64_t seed, double u, double v) {
  const double u0 = std::floor(u);
  const double v0 = std::floor(v);
  const Spline along_u = make_spline(u - u0);
  const Spline along_v = make_spline(v - v0);
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(u0) + i);
    const std::uint64_t column_key = hash_u64(seed, column);
    double column_sum = 0;
    for (int j = 0; j < 4; ++j) {
      const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(v0) + j);
      column_sum += along_v.weight[j] * (hash_to_uniform(hash_u64(column_key ^ row)) - 0.5);
    }
    sum += along_u.weight[i] * column_sum;
  }
  // A uniform number has variance 1/12.
  return sum * std::sqrt(12 / (along_u.norm_squared * along_v.norm_squared));
}

double eval_noise(std::uint64_t seed, double u, double v, double w) {
  const double u0 = std::floor(u), v0 = std::floor(v), w0 = std::floor(w);
  const Spline along_u = make_spline(u - u0), along_v = make_spline(v - v0),
               along_w = make_spline(w - w0);
  const auto node = [](double start, int i) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(start) + i);
  };
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const std::uint64_t layer = hash_u64(seed, node(w0, k));
    for (int i = 0; i < 4; ++i) {
      const std::uint64_t column = hash_u64(layer, node(u0, i));
      double column_sum = 0;
      for (int j = 0; j < 4; ++j)
        column_sum += along_v.weight[j] * (hash_to_uniform(hash_u64(column ^ node(v0, j))) - 0.5);
      sum += along_w.weight[k] * along_u.weight[i] * column_sum;
    }
  }
  return sum * std::sqrt(12 / (along_u.norm_squared * along_v.norm_squared * along_w.norm_squared));
}

double eval_fractal_noise(std::uint64_t seed, double u, double v, int octaves) {
  constexpr double cosine = 0.8, sine = 0.6;  // keeps the lattices of the octaves apart
  double sum = 0, variance = 0, amplitude = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * eval_noise(hash_u64(seed, static_cast<std::uint64_t>(octave)), u, v);
    variance += amplitude * amplitude;
    amplitude /= 2;
    const double rotated = 2 * (cosine * u - sine * v);
    v = 2 * (sine * u + cosine * v);
    u = rotated;
  }
  return sum / std::sqrt(variance);
}

double eval_fractal_noise(std::uint64_t seed, double u, double v, double w, int octaves) {
  double sum = 0, variance = 0, amplitude = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * eval_noise(hash_u64(seed, static_cast<std::uint64_t>(octave)), u, v, w);
    variance += amplitude * amplitude;
    amplitude /= 2;
    // Columns of an orthogonal matrix, twice as long: the lattices of the octaves stay apart.
    const double turned_u = 2 * (2 * u - 2 * v + w) / 3;
    const double turned_v = 2 * (2 * u + v - 2 * w) / 3;
    w = 2 * (u + 2 * v + 2 * w) / 3;
    u = turned_u;
    v = turned_v;
  }
  return sum / std::sqrt(variance);
}

}  // namespace parian

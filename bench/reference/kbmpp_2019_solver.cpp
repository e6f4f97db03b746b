#include "bench/reference/kbmpp_2019_solver.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"

namespace parian::kbmpp {
namespace {

constexpr double epsilon = 1e-6;             // weights keep this distance to 0 and 1
constexpr double smallest_tolerance = 1e-3;  // blends scale weights to sum 1 anyway
constexpr std::size_t block = 1024;

std::size_t base_unknowns(const Solver& s) {
  return s.model.bases * s.pairs.knots * static_cast<std::size_t>(s.pairs.channels);
}

// Distinct for each pixel.
void draw_indices(Model& model, std::size_t pixels, Rng& rng) {
  const std::size_t per_pixel = model.per_pixel;
  model.index.resize(pixels * per_pixel);
  for (std::size_t x = 0; x < pixels; ++x)
    for (std::size_t k = 0; k < per_pixel;) {
      std::uint16_t* own = model.index.data() + x * per_pixel;
      own[k] = static_cast<std::uint16_t>(sample_uniform(rng) * static_cast<double>(model.bases));
      if (std::find(own, own + k, own[k]) == own + k) ++k;
    }
}

void write_model(Solver& s, const double* x) {
  const auto channels = static_cast<std::size_t>(s.pairs.channels);
  for (std::size_t i = 0; i < s.model.bases * s.pairs.knots; ++i)
    for (std::size_t c = 0; c < channels; ++c)
      s.model.base_rows[4 * i + c] = static_cast<float>(x[i * channels + c]);
  const double* t = x + base_unknowns(s);
  const std::size_t count = s.x.size() - base_unknowns(s);
  for (std::size_t i = 0; i < count; ++i) {
    if (s.model.per_pixel == 2) {
      s.model.weight[2 * i] = static_cast<float>(t[i]);
      s.model.weight[2 * i + 1] = static_cast<float>(1 - t[i]);
    } else {
      s.model.weight[i] = static_cast<float>(t[i]);
    }
  }
}

// lambda E_reg (Eq. 5, second part); its gradient is added where wanted.
double add_curvature(const Solver& s, const double* x, double* gradient) {
  const auto channels = static_cast<std::size_t>(s.pairs.channels);
  const double lambda = s.params.lambda_reg;
  double energy = 0;
  for (std::size_t b = 0; b < s.model.bases; ++b)
    for (std::size_t h = 0; h + 2 < s.pairs.knots; ++h)
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t at = (b * s.pairs.knots + h) * channels + c;
        const double d = x[at] - 2 * x[at + channels] + x[at + 2 * channels];
        energy += 0.5 * lambda * d * d;
        if (gradient == nullptr) continue;
        gradient[at] += lambda * d;
        gradient[at + channels] -= 2 * lambda * d;
        gradient[at + 2 * channels] += lambda * d;
      }
  return energy;
}

// Barriers on t and 1 - t, both of which are weights.
double add_single_weights(const Solver& s, const double* t, double* gradient) {
  const double scale = 2 * s.params.lambda_barr * s.params.gamma;
  return parallel_sum(s.pairs.pixels(), block, [&](std::size_t begin, std::size_t end) {
    double energy = 0;
    for (std::size_t x = begin; x < end; ++x) {
      energy -= scale * std::log(t[x] * (1 - t[x]));
      gradient[x] = static_cast<double>(s.work.weight_gradient[2 * x]) -
                    static_cast<double>(s.work.weight_gradient[2 * x + 1]) -
                    scale * (1 / t[x] - 1 / (1 - t[x]));
    }
    return energy;
  });
}

double constraint(const double* t, std::size_t per_pixel) {
  double sum = -1;
  for (std::size_t k = 0; k < per_pixel; ++k) sum += t[k];
  return sum;
}

// Barriers and the terms of the Lagrangian.
double add_many_weights(const Solver& s, const double* t, double* gradient) {
  const double scale = s.params.lambda_barr * s.params.gamma;
  const std::size_t per_pixel = s.model.per_pixel;
  const double penalty = s.lagrangian.penalty;
  return parallel_sum(s.pairs.pixels(), block, [&](std::size_t begin, std::size_t end) {
    double energy = 0;
    for (std::size_t x = begin; x < end; ++x) {
      const double c = constraint(t + x * per_pixel, per_pixel);
      const double slope = s.lagrangian.multiplier[x] + c / penalty;
      energy += s.lagrangian.multiplier[x] * c + c * c / (2 * penalty);
      for (std::size_t i = x * per_pixel; i < (x + 1) * per_pixel; ++i) {
        energy -= scale * std::log(t[i] * (1 - t[i]));
        gradient[i] = static_cast<double>(s.work.weight_gradient[i]) -
                      scale * (1 / t[i] - 1 / (1 - t[i])) + slope;
      }
    }
    return energy;
  });
}

void set_variables(Solver& s) {
  const std::size_t bases = base_unknowns(s), per_pixel = s.model.per_pixel;
  const std::size_t per = per_pixel == 1 ? 0 : per_pixel == 2 ? 1 : per_pixel;
  const std::size_t count = bases + per * s.pairs.pixels();
  s.x.assign(count, 0.0);
  s.box.lower.assign(count, epsilon);
  s.box.upper.assign(count, 1 - epsilon);
  s.box.kind.assign(count, 2);
  std::fill(s.box.kind.begin(), s.box.kind.begin() + static_cast<std::ptrdiff_t>(bases), 0);
  if (per_pixel > 2) s.lagrangian.multiplier.assign(s.pairs.pixels(), 0.0);
}

// Multipliers follow where the constraint is as small as it should be by now; otherwise the
// penalty is sharpened.
void update_lagrangian(Solver& s, double largest) {
  constexpr double alpha = 0.1, beta = 0.9, eta_s = 0.1258925, tau = 0.1;
  Lagrangian& l = s.lagrangian;
  if (largest <= l.tolerance) {
    const double* t = s.x.data() + base_unknowns(s);
    for (std::size_t x = 0; x < s.pairs.pixels(); ++x)
      l.multiplier[x] += constraint(t + x * s.model.per_pixel, s.model.per_pixel) / l.penalty;
    l.tolerance = std::max(l.tolerance * std::pow(l.penalty, beta), smallest_tolerance);
  } else {
    l.penalty *= tau;
    l.tolerance = eta_s * std::pow(l.penalty, alpha);
  }
}

}  // namespace

Solver make_solver(const Pairs& pairs, const KbmppParams& params) {
  Solver s{pairs, params, {}, {}, {}, {}, {}, 0, 0};
  s.model.bases = static_cast<std::size_t>(params.bases);
  s.model.per_pixel = static_cast<std::size_t>(params.per_pixel);
  s.model.base_rows.assign(s.model.bases * pairs.row, 0.0f);
  s.model.weight.assign(pairs.pixels() * s.model.per_pixel,
                        1.0f / static_cast<float>(params.per_pixel));
  Rng rng = make_rng(params.seed);
  draw_indices(s.model, pairs.pixels(), rng);
  for (std::size_t i = 0; i < s.model.bases * pairs.knots; ++i)
    for (std::size_t c = 0; c < static_cast<std::size_t>(pairs.channels); ++c)
      s.model.base_rows[4 * i + c] = static_cast<float>(2 * sample_uniform(rng) - 1);
  set_variables(s);
  read_model(s);
  return s;
}

void read_model(Solver& s) {
  const auto channels = static_cast<std::size_t>(s.pairs.channels);
  for (std::size_t i = 0; i < s.model.bases * s.pairs.knots; ++i)
    for (std::size_t c = 0; c < channels; ++c)
      s.x[i * channels + c] = static_cast<double>(s.model.base_rows[4 * i + c]);
  double* t = s.x.data() + base_unknowns(s);
  const std::size_t count = s.x.size() - base_unknowns(s);
  for (std::size_t i = 0; i < count; ++i)
    t[i] = static_cast<double>(s.model.weight[s.model.per_pixel == 2 ? 2 * i : i]);
}

double eval_objective(Solver& s, const double* x, double* gradient) {
  const Stopwatch watch;
  write_model(s, x);
  double energy = eval_energy(s.pairs, s.model, s.work);
  const auto channels = static_cast<std::size_t>(s.pairs.channels);
  for (std::size_t i = 0; i < s.model.bases * s.pairs.knots; ++i)
    for (std::size_t c = 0; c < channels; ++c)
      gradient[i * channels + c] = static_cast<double>(s.work.base_gradient[4 * i + c]);
  energy += add_curvature(s, x, gradient);
  const std::size_t bases = base_unknowns(s);
  if (s.model.per_pixel == 2) energy += add_single_weights(s, x + bases, gradient + bases);
  if (s.model.per_pixel > 2) energy += add_many_weights(s, x + bases, gradient + bases);
  ++s.evaluations;
  s.seconds_evaluations += watch.seconds();
  return energy;
}

double eval_feasible_energy(Solver& s) {
  Model model = s.model;
  const std::size_t per_pixel = model.per_pixel;
  for (std::size_t x = 0; x < s.pairs.pixels(); ++x) {
    float sum = 0;
    float* t = model.weight.data() + x * per_pixel;
    for (std::size_t k = 0; k < per_pixel; ++k) sum += t[k];
    for (std::size_t k = 0; k < per_pixel; ++k) t[k] /= sum;
  }
  return eval_energy(s.pairs, model, s.work) + add_curvature(s, s.x.data(), nullptr);
}

double solve(Solver& s) {
  minimise_lbfgsb(
      s.x, s.box, s.params.memory, inner_iterations(s.params),
      [&](const double* x, double* gradient) { return eval_objective(s, x, gradient); });
  if (s.model.per_pixel <= 2) return 0;
  const double* t = s.x.data() + base_unknowns(s);
  double largest = 0;
  for (std::size_t x = 0; x < s.pairs.pixels(); ++x)
    largest = std::max(largest, std::abs(constraint(t + x * s.model.per_pixel, s.model.per_pixel)));
  update_lagrangian(s, largest);
  return largest;
}

}  // namespace parian::kbmpp

#include "fit/noise_fit.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "fit/hessian.h"
#include "fit/hessian_internal.h"
#include "fit/pair_weights.h"
#include "fit/reduced_internal.h"
#include "fit/solve.h"

namespace parian {
namespace {

constexpr double inner_tolerance = 1e-2;  // of the linear system of a step
constexpr double largest_step = 1.5;      // in ln P: beyond, the linearisation means nothing
constexpr double least_gain = 0.5;        // part of a step's slope that must be gone at its end
constexpr int trials = 6;                 // lengths of a step
constexpr int prior_steps = 3;            // after which the weights of the slopes stay
constexpr std::size_t block = std::size_t{1} << 14u;

constexpr std::size_t memory = 5;  // steps that the quasi-Newton direction remembers

// A step and how the residual fell along it.
struct Secant {
  std::vector<double> step, fall;
  double curvature = 0;  // step . fall > 0
};

// A run: everything about the present field p.
struct Descent {
  const SliceSource& table;
  int channel;
  const ReducedParams& params;
  const NoisyFitParams& noisy;
  const Progress& progress;
  NoisyFit fit;
  std::vector<double> slope_weight;  // of the prior
  std::vector<double> centre;        // mean over the pixels of p
  std::vector<double> r;             // minus the gradient at p, prior included
  std::deque<Secant> secants;        // newest last
};

std::vector<double> distance_weights(const ReducedSystem& geometry, PairWeight weight,
                                     const std::vector<double>& means) {
  if (weight == PairWeight::noise) return std::vector<double>(means.size(), 1.0);
  if (weight != PairWeight::energy) return geometry.weights[0].phi;
  const double largest = *std::max_element(means.begin(), means.end());
  std::vector<double> phi = means;
  for (double& value : phi) value = std::max(0.0, value) / largest;
  return phi;
}

PairNoise noise_of(const TableHeader& header, int channel) {
  const auto c = static_cast<std::size_t>(channel);
  return {static_cast<float>(header.noise_floor[c]), static_cast<float>(header.noise_gain[c])};
}

// From the means over all pixels of each offset, whose noise is small: ln of those that stand out
// of it, weighted by its variance.
std::vector<double> make_start(const ReducedSystem& geometry, const OffsetMeans& means,
                               const NoiseStep& step) {
  const auto floor = static_cast<double>(step.noise.floor),
             gain = static_cast<double>(step.noise.gain);
  std::vector<double> weight(means.mean.size()), right(geometry.knots());
  for (std::size_t i = 0; i < weight.size(); ++i) {
    const double mean = means.mean[i];
    if (!(mean > 0)) continue;
    const double variance = (floor * floor + gain * mean) / means.known[i];
    if (variance > mean * mean) continue;
    weight[i] = geometry.pair_count[i] * step.phi[i] * means.known[i] * mean * mean /
                (mean * mean + variance);
    const auto k = static_cast<std::size_t>(geometry.segment[i]);
    right[k] += weight[i] * (1 - geometry.fraction[i]) * std::log(mean);
    right[k + 1] += weight[i] * geometry.fraction[i] * std::log(mean);
  }
  return solve_profile(geometry, weight, right);
}

// One pass over the table about a field.
ReducedSystem make_step(const SliceSource& table, int channel, const ReducedParams& params,
                        NoiseStep& step, const std::vector<double>& p, const Progress& progress) {
  step.field.assign(p.begin(), p.end());
  ReducedParams about = params;
  about.weight = PairWeight::uniform;
  about.about = &step;
  return make_reduced_system(table, channel, about, {{}, progress.is_cancelled});
}

// The mean over the pixels that have data.
std::vector<double> mean_profile(const ReducedSystem& system, const std::vector<double>& p) {
  std::vector<double> mean(system.knots());
  const std::vector<float>& u = system.weights[0].u;
  parallel_for(mean.size(), [&](std::size_t k) {
    double sum = 0, count = 0;
    for (std::size_t x = 0; x < system.pixels(); ++x) {
      const double use = u.empty() ? 1.0 : static_cast<double>(u[x]);
      sum += use * p[k * system.pixels() + x];
      count += use;
    }
    mean[k] = sum / count;
  });
  return mean;
}

// 8 s^2 phi (1 - mean w) of the offsets that see a knot, geometric mean at both ends of a segment,
// over the variance of a random walk that reaches `spread` at the last knot.
std::vector<double> make_slope_weights(const ReducedSystem& system, const NoiseStep& step,
                                       double spread) {
  std::vector<double> noisy(system.knots()), all(system.knots());
  for (std::size_t i = 0; i < system.offsets.size(); ++i) {
    const auto k = static_cast<std::size_t>(system.segment[i]);
    const double f = system.fraction[i];
    const double lost = std::max(0.0, step.phi[i] - system.weights[0].phi[i]);
    noisy[k] += (1 - f) * (1 - f) * lost;
    noisy[k + 1] += f * f * lost;
    all[k] += (1 - f) * (1 - f);
    all[k + 1] += f * f;
  }
  constexpr double s = static_cast<double>(model_error);
  std::vector<double> weights;
  const auto at_knot = [&](std::size_t k) { return all[k] > 0 ? noisy[k] / all[k] : 0; };
  for (std::size_t k = 0; k + 1 < system.knots(); ++k) {
    const double share = (system.knots_mm[k + 1] - system.knots_mm[k]) / system.knots_mm.back();
    weights.push_back(8 * s * s * std::sqrt(at_knot(k) * at_knot(k + 1)) /
                      (spread * spread * share));
  }
  return weights;
}

// r = b - (lambda^2 L^T L + S) p + S centre, S the slopes' part.
std::vector<double> eval_residual(const Descent& descent, const ReducedSystem& system,
                                  const std::vector<double>& p) {
  std::vector<double> r(p.size(), 0.0);
  add_curvature(system, p.data(), r.data());
  std::vector<double> pull(system.knots());
  for (std::size_t k = 0; k < system.slope_weight.size(); ++k) {
    const double slope = system.slope_weight[k] * (descent.centre[k + 1] - descent.centre[k]);
    pull[k + 1] += slope;
    pull[k] -= slope;
  }
  parallel_for(system.knots(), [&](std::size_t k) {
    for (std::size_t i = k * system.pixels(); i < (k + 1) * system.pixels(); ++i)
      r[i] = system.right_hand_side[i] - r[i] + pull[k];
  });
  return r;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return parallel_sum(a.size(), block, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i] * b[i];
    return sum;
  });
}

// H delta = r
std::vector<double> solve_step(Descent& descent, std::vector<double> r) {
  NoisyFit& fit = descent.fit;
  fit.system.right_hand_side = std::move(r);
  const Hessian hessian = make_hessian(fit.system, ProductMethod::automatic, false);
  const Preconditioner preconditioner = make_preconditioner(fit.system, hessian);
  std::vector<double> delta(fit.p.size(), 0.0);
  const std::vector<double> zero(fit.system.knots(), 0.0);
  const SolveReport solved = solve_reduced(fit.system, hessian, preconditioner,
                                           {inner_tolerance, descent.noisy.max_iterations}, zero,
                                           delta, {{}, descent.progress.is_cancelled});
  fit.iterations += solved.iterations;
  return delta;
}

void add(double factor, const std::vector<double>& v, std::vector<double>& to) {
  parallel_for_blocks(v.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) to[i] += factor * v[i];
  });
}

// The limited-memory BFGS direction (Nocedal 1980) whose first inverse is H's: H has mean weights
// only, and the secants make up for what pixels far from the mean need.
std::vector<double> make_direction(Descent& descent) {
  std::vector<double> q = descent.r;
  std::vector<double> factors;
  for (auto secant = descent.secants.rbegin(); secant != descent.secants.rend(); ++secant) {
    factors.push_back(dot(secant->step, q) / secant->curvature);
    add(-factors.back(), secant->fall, q);
  }
  std::vector<double> delta = solve_step(descent, std::move(q));
  for (const Secant& secant : descent.secants) {
    add(factors.back() - dot(secant.fall, delta) / secant.curvature, secant.step, delta);
    factors.pop_back();
  }
  for (double& value : delta) value = std::clamp(value, -largest_step, largest_step);
  return delta;
}

// Sum over pairs of m and their mean weights: what steps are measured by.
double total_weight(const ReducedSystem& system, const OffsetMeans& means) {
  double sum = 0;
  for (std::size_t i = 0; i < means.known.size(); ++i)
    sum += system.pair_count[i] * system.weights[0].phi[i] * means.known[i];
  return sum;
}

// `there`: the residual at the end of the step.
void remember(Descent& descent, const std::vector<double>& delta, double length,
              std::vector<double> there, double fall) {
  if (!(fall > 0)) return;
  Secant secant{std::vector<double>(delta.size()), std::move(there), length * fall};
  for (std::size_t i = 0; i < delta.size(); ++i) {
    secant.step[i] = length * delta[i];
    secant.fall[i] = descent.r[i] - secant.fall[i];
  }
  descent.secants.push_back(std::move(secant));
  if (descent.secants.size() > memory) descent.secants.pop_front();
}

// Goes along delta until the slope has fallen by half, or rises no more than that: the objective
// falls. Returns the length, 0 when rounding allows none.
double go_along(Descent& descent, const std::vector<double>& delta, double slope) {
  NoisyFit& fit = descent.fit;
  double length = 1;
  std::vector<double> p(fit.p.size());
  for (int trial = 0; trial < trials; ++trial) {
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = fit.p[i] + length * delta[i];
    ReducedSystem system =
        make_step(descent.table, descent.channel, descent.params, fit.step, p, descent.progress);
    ++fit.steps;
    system.slope_weight = descent.slope_weight;
    std::vector<double> fall = eval_residual(descent, system, p);
    const double there = dot(fall, delta);
    if (there > -least_gain * slope) {
      remember(descent, delta, length, std::move(fall), slope - there);
      fit.system = std::move(system);
      fit.p = std::move(p);
      return length;
    }
    length *= slope / (slope - there);  // where a parabola has its minimum
  }
  return 0;
}

// What changes with the field: the prior's weights, its centre and the residual.
void settle(Descent& descent, int step) {
  NoisyFit& fit = descent.fit;
  if (step < prior_steps)
    descent.slope_weight = make_slope_weights(fit.system, fit.step, descent.noisy.spread);
  fit.system.slope_weight = descent.slope_weight;
  descent.centre = mean_profile(fit.system, fit.p);
  descent.r = eval_residual(descent, fit.system, fit.p);
}

void descend(Descent& descent, const OffsetMeans& means) {
  NoisyFit& fit = descent.fit;
  settle(descent, 0);
  const double first = std::sqrt(dot(descent.r, descent.r));
  double done = 0;
  fit.last_step = 1;
  for (int step = 1; step <= descent.noisy.max_steps; ++step) {
    const std::vector<double> delta = make_direction(descent);
    const double slope = dot(descent.r, delta);
    if (!(slope > 0)) break;
    const double length = go_along(descent, delta, slope);
    if (length == 0) break;
    settle(descent, step);
    fit.last_step = std::sqrt(length * slope / total_weight(fit.system, means));
    done = std::max(done, std::log(fit.last_step) / std::log(descent.noisy.tolerance));
    advance_progress(descent.progress, "solving", std::clamp(done, 0.0, 1.0));
    if (fit.last_step <= descent.noisy.tolerance) break;
  }
  fit.relative_residual = first > 0 ? std::sqrt(dot(descent.r, descent.r)) / first : 0;
}

double eval_curvature(const ReducedSystem& system, const std::vector<double>& p) {
  ReducedSystem plain;
  plain.width = system.width;
  plain.height = system.height;
  plain.knots_mm = system.knots_mm;
  plain.lambda = system.lambda;
  std::vector<double> product(p.size(), 0.0);
  add_curvature(plain, p.data(), product.data());
  return 0.5 * dot(p, product);
}

}  // namespace

NoisyFit fit_noisy(const SliceSource& table, int channel, const ReducedParams& params,
                   const NoisyFitParams& noisy, const Progress& progress) {
  const ReducedSystem geometry = make_geometry(table, channel, params);
  advance_progress(progress, "reading the table", 0);
  const OffsetMeans means = measure_offset_means(table, geometry, progress);
  if (std::none_of(means.mean.begin(), means.mean.end(), [](double mean) { return mean > 0; }))
    throw Error({table.name(), "channel " + std::to_string(channel),
                 "values of positive mean at some offset", "nothing but noise about 0"});
  Descent descent{table, channel, params, noisy, progress, {}, {}, {}, {}, {}};
  NoisyFit& fit = descent.fit;
  fit.step.noise = noise_of(table.header(), channel);
  fit.step.phi = distance_weights(geometry, params.weight, means.mean);
  fit.p = make_constant_field(geometry, make_start(geometry, means, fit.step));
  fit.system = make_step(table, channel, params, fit.step, fit.p, progress);
  fit.steps = 2;
  descend(descent, means);
  return std::move(fit);
}

double eval_noisy_energy(const SliceSource& table, const ReducedParams& params, const NoisyFit& fit,
                         const std::vector<double>& p) {
  NoiseStep step = fit.step;
  const ReducedSystem system = make_step(table, fit.system.channel, params, step, p, {});
  return system.constant + eval_curvature(system, p);
}

ReducedSystem make_noisy_system(const SliceSource& table, int channel, const ReducedParams& params,
                                const std::vector<double>& p, const Progress& progress) {
  const ReducedSystem geometry = make_geometry(table, channel, params);
  const OffsetMeans means = measure_offset_means(table, geometry, progress);
  NoiseStep step{noise_of(table.header(), channel), {}, {}};
  step.phi = distance_weights(geometry, params.weight, means.mean);
  ReducedSystem system = make_step(table, channel, params, step, p, progress);
  // E(p + d) = c - r^T d + 1/2 d^T H d, without the regulariser, in terms of p + d
  const double lambda = std::exchange(system.lambda, 0.0);
  const Hessian hessian = make_hessian(system, ProductMethod::automatic);
  std::vector<double> hp(p.size());
  HessianWorkspace workspace;
  apply_hessian(system, hessian, p.data(), hp.data(), workspace);
  system.constant += dot(system.right_hand_side, p) + 0.5 * dot(hp, p);
  for (std::size_t i = 0; i < p.size(); ++i) system.right_hand_side[i] += hp[i];
  system.lambda = lambda;
  return system;
}

}  // namespace parian

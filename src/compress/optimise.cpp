#include "compress/optimise.h"

#include <algorithm>

#include "base/parallel.h"
#include "compress/assign.h"
#include "compress/bases.h"

namespace parian {
namespace {

constexpr double largest_scale = 64;

// sum of squared second differences of all base profiles
double sum_curvature(const Mixture& mixture) {
  const RowShape& shape = mixture.shape;
  double sum = 0;
  for (std::size_t j = 0; j < mixture.base_count(); ++j)
    for (std::size_t c = 0; c < shape.channels; ++c)
      for (std::size_t k = 0; k + 2 < shape.knots; ++k) {
        const float* v = mixture.base(j) + c * shape.knots + k;
        const double bend =
            static_cast<double>(v[0]) - 2 * static_cast<double>(v[1]) + static_cast<double>(v[2]);
        sum += bend * bend;
      }
  return sum;
}

double eval(const BlendObjective& objective, const Mixture& mixture,
            AlignedVector<float>* gradient_rows, PixelErrors* errors) {
  const RowShape& shape = objective.shape;
  const AlignedVector<float> rows = mix_rows(mixture);
  const std::size_t values = shape.channels * shape.knots * shape.pixels;
  AlignedVector<float> field(values), gradient(gradient_rows == nullptr ? 0 : values);
  scatter_rows(shape, rows.data(), field.data());
  double value = objective.eval(field.data(), gradient_rows ? gradient.data() : nullptr, errors);
  if (gradient_rows != nullptr) *gradient_rows = make_rows(shape, gradient.data());
  if (objective.curvature_weight > 0)
    value += 0.5 * objective.curvature_weight * sum_curvature(mixture);
  return value;
}

// v <- (scale D)^-1 v for a row; knots without weight give 0.
void divide_by_metric(const float* diagonal, const float* coupling, double scale,
                      std::size_t stride, double* work, float* v) {
  double* pivot = work;
  double* x = work + stride;
  for (std::size_t i = 0; i < stride; ++i) {
    const double d = static_cast<double>(diagonal[i]) * scale * (1 + 1e-6);
    pivot[i] = d;
    x[i] = static_cast<double>(v[i]);
    if (i == 0 || !(pivot[i - 1] > 0)) continue;
    const double o = static_cast<double>(coupling[i - 1]) * scale;
    pivot[i] -= o * o / pivot[i - 1];
    x[i] -= o / pivot[i - 1] * x[i - 1];
  }
  for (std::size_t i = stride; i-- > 0;) {
    if (!(pivot[i] > 0)) {
      x[i] = 0;
    } else {
      const double next = i + 1 < stride ? static_cast<double>(coupling[i]) * scale * x[i + 1] : 0;
      x[i] = (x[i] - next) / pivot[i];
    }
    v[i] = static_cast<float>(x[i]);
  }
}

// q_x = p_x - (scale D_x)^-1 g_x: where each pixel alone would lower the bound most.
AlignedVector<float> make_target(const LocalMetric& metric, const Mixture& mixture,
                                 const AlignedVector<float>& gradient, double scale) {
  const std::size_t stride = metric.shape.stride();
  AlignedVector<float> target = mix_rows(mixture);
  parallel_for_blocks(metric.shape.pixels, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<double> work(2 * stride);
    std::vector<float> step(stride);
    for (std::size_t x = begin; x < end; ++x) {
      const std::size_t row = x * stride;
      std::copy_n(&gradient[row], stride, step.begin());
      divide_by_metric(&metric.diagonal[row], &metric.coupling[row], scale, stride, work.data(),
                       step.data());
      for (std::size_t i = 0; i < stride; ++i) target[row + i] -= step[i];
    }
  });
  return target;
}

// Both steps lower the bound. One of each is worth most for its time: the bound moves on with p.
void step_on_bound(const BlendObjective& objective, const AlignedVector<float>& target,
                   double scale, const OptimiseParams& params, Mixture& mixture) {
  if (!params.fixed_bases)
    update_bases(objective.metric, target, objective.curvature_weight / scale, /*sweeps=*/1,
                 mixture);
  assign_mixtures(objective.metric, target, {params.weight_levels, params.width}, mixture);
}

void evaluate(const BlendObjective& objective, OptimiseState& state) {
  state.energy = eval(objective, state.mixture, &state.gradient, nullptr);
}

}  // namespace

double eval_energy(const BlendObjective& objective, const Mixture& mixture, PixelErrors* errors) {
  return eval(objective, mixture, nullptr, errors);
}

OptimiseState make_optimise_state(const BlendObjective& objective, Mixture start,
                                  const OptimiseParams& params) {
  OptimiseState state;
  state.params = params;
  state.mixture = std::move(start);
  while (state.mixture.per_pixel < params.per_pixel) state.mixture = with_one_more(state.mixture);
  evaluate(objective, state);
  state.history.push_back({static_cast<int>(params.per_pixel), state.energy, true});
  return state;
}

OptimiseState make_optimise_state(const BlendObjective& objective,
                                  const AlignedVector<float>& target_rows,
                                  const OptimiseParams& params) {
  Mixture start = start_mixture(objective.metric, target_rows, params.bases, params.seed);
  for (std::size_t k = 1; k < params.per_pixel; ++k) {
    start = with_one_more(start);
    assign_mixtures(objective.metric, target_rows, {params.weight_levels, params.width}, start);
  }
  return make_optimise_state(objective, std::move(start), params);
}

void advance(const BlendObjective& objective, OptimiseState& state) {
  if (state.done) return;
  OptimiseState trial = state;
  const AlignedVector<float> target =
      make_target(objective.metric, state.mixture, state.gradient, state.bound_scale);
  step_on_bound(objective, target, state.bound_scale, state.params, trial.mixture);
  evaluate(objective, trial);
  const double before = state.energy;
  const bool accepted = trial.energy < before;
  if (accepted) {
    state = std::move(trial);
    // Steps get longer slowly: that ends lower than long steps from the first round.
    state.bound_scale = std::max(0.25, 0.9 * state.bound_scale);
  } else {
    state.bound_scale *= 1.7;
  }
  ++state.round;
  state.history.push_back({static_cast<int>(state.params.per_pixel), state.energy, accepted});
  const bool stuck = !accepted && state.bound_scale > largest_scale;
  const bool slow = accepted && before - state.energy < state.params.tolerance * before;
  state.done = stuck || slow || state.round >= state.params.rounds;
}

}  // namespace parian

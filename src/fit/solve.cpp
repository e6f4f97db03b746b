#include "fit/solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <numeric>

#include "base/aligned.h"
#include "base/check.h"
#include "base/hot.h"
#include "base/parallel.h"
#include "fit/hessian_internal.h"

namespace parian {
namespace {

constexpr std::size_t block = std::size_t{1} << 15u;
// A single-precision solve gains at most about this much before rounding stops it.
constexpr double largest_gain = 1e-5;
constexpr std::size_t lanes = 8;

PARIAN_HOT double dot_block(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                            std::size_t count) {
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    for (std::size_t j = 0; j < lanes; ++j)
      partial[j] += static_cast<double>(a[i + j]) * static_cast<double>(b[i + j]);
  for (; i < count; ++i) partial[0] += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  double sum = 0;
  for (double value : partial) sum += value;
  return sum;
}
// x += alpha d; r -= alpha hd; returns |r|^2
PARIAN_HOT double step_block(float alpha, const float* PARIAN_RESTRICT d,
                             const float* PARIAN_RESTRICT hd, float* PARIAN_RESTRICT x,
                             float* PARIAN_RESTRICT r, std::size_t count) {
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) {
      x[i + j] += alpha * d[i + j];
      r[i + j] -= alpha * hd[i + j];
      partial[j] += static_cast<double>(r[i + j]) * static_cast<double>(r[i + j]);
    }
  }
  for (; i < count; ++i) {
    x[i] += alpha * d[i];
    r[i] -= alpha * hd[i];
    partial[0] += static_cast<double>(r[i]) * static_cast<double>(r[i]);
  }
  double sum = 0;
  for (double value : partial) sum += value;
  return sum;
}
PARIAN_HOT void direction_block(float beta, const float* PARIAN_RESTRICT z,
                                float* PARIAN_RESTRICT d, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) d[i] = z[i] + beta * d[i];
}

double dot(const AlignedVector<float>& a, const AlignedVector<float>& b) {
  return parallel_sum(a.size(), block, [&](std::size_t begin, std::size_t end) {
    return dot_block(&a[begin], &b[begin], end - begin);
  });
}

double norm(const std::vector<double>& v) {
  return std::sqrt(parallel_sum(v.size(), block, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += v[i] * v[i];
    return sum;
  }));
}

void for_all(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body) {
  parallel_for_blocks(count, block, body);
}

struct Solver {
  const ReducedSystem& system;
  const Hessian& hessian;
  const Preconditioner& preconditioner;
  const SolveParams& params;
  const Progress& progress;
  HessianWorkspace workspace;
  AlignedVector<float> x, r, z, d;  // z also holds H d
  double norm_b = 0;
  SolveReport report;
};

// Adds to x what brings the residual r = rhs - H x down to `target`.
void conjugate_gradient(Solver& s, double target) {
  const std::size_t pixels = s.system.pixels(), knots = s.system.knots();
  std::vector<double> partial(knots);  // of inner products, per plane
  const auto total = [&] { return std::accumulate(partial.begin(), partial.end(), 0.0); };
  const double start = std::sqrt(dot(s.r, s.r));
  double rz = 0;
  float beta = 0;
  PlaneHooks residual_hooks, direction_hooks;
  residual_hooks.after = [&](std::size_t k) {
    partial[k] = dot_block(&s.r[k * pixels], &s.z[k * pixels], pixels);
  };
  direction_hooks.before = [&](std::size_t k) {
    direction_block(beta, &s.z[k * pixels], &s.d[k * pixels], pixels);
  };
  direction_hooks.after = [&](std::size_t k) {
    partial[k] = dot_block(&s.d[k * pixels], &s.z[k * pixels], pixels);
  };
  for (double norm_r = start; s.report.iterations < s.params.max_iterations && norm_r > target;
       ++s.report.iterations) {
    advance_progress(s.progress, "solving",
                     std::clamp(std::log(norm_r / start) / std::log(target / start), 0.0, 1.0));
    apply_preconditioner(s.preconditioner, s.hessian, s.r.data(), s.z.data(), s.workspace,
                         residual_hooks);
    const double rz_new = total();
    if (!(rz_new > 0)) break;  // rounding has the last word
    beta = static_cast<float>(rz > 0 ? rz_new / rz : 0);
    rz = rz_new;
    // z is the new direction's input until its plane has been read, and H d from then on.
    apply_hessian(s.system, s.hessian, s.d.data(), s.z.data(), s.workspace, direction_hooks);
    const double curvature = total();
    if (!(curvature > 0)) break;
    const auto alpha = static_cast<float>(rz / curvature);
    norm_r = std::sqrt(parallel_sum(s.d.size(), block, [&](std::size_t begin, std::size_t end) {
      return step_block(alpha, &s.d[begin], &s.z[begin], &s.x[begin], &s.r[begin], end - begin);
    }));
  }
}

// In single precision throughout but for the gradient g at the constant field m = profile:
//   p = m + x,  r = -g - H x,  E(p) = E(m) + g^T x / 2 - x^T r / 2
void solve_single(Solver& s, const std::vector<double>& profile, std::vector<double>& p) {
  const std::size_t n = p.size(), pixels = s.system.pixels();
  const std::vector<double>& b = s.system.right_hand_side;
  AlignedVector<double> g(n);  // first H m
  apply_hessian_to_constant(s.system, s.hessian, profile, g.data(), s.workspace);
  std::atomic<bool> start_is_mean{true};
  // Blocks are planes, so the profile's value is the same within each.
  const double energy_of_mean =
      s.system.constant + parallel_sum(n, pixels, [&](std::size_t begin, std::size_t end) {
        const double m = profile[begin / pixels];
        double sum = 0;
        bool same = true;
        for (std::size_t i = begin; i < end; ++i) {
          sum += m * (0.5 * g[i] - b[i]);
          g[i] -= b[i];
          s.x[i] = static_cast<float>(p[i] - m);
          same = same && s.x[i] == 0;
        }
        if (!same) start_is_mean = false;
        return sum;
      });
  const bool from_mean = start_is_mean;
  if (!from_mean) apply_hessian(s.system, s.hessian, s.x.data(), s.r.data(), s.workspace);
  for_all(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      s.r[i] = static_cast<float>(-g[i] - (from_mean ? 0.0 : static_cast<double>(s.r[i])));
      s.d[i] = 0;
    }
  });
  conjugate_gradient(s, s.params.tolerance * s.norm_b);
  s.report.relative_residual = s.norm_b > 0 ? std::sqrt(dot(s.r, s.r)) / s.norm_b : 0;
  s.report.energy =
      energy_of_mean + 0.5 * parallel_sum(n, pixels, [&](std::size_t begin, std::size_t end) {
                         const double m = profile[begin / pixels];
                         double sum = 0;
                         for (std::size_t i = begin; i < end; ++i) {
                           const auto x = static_cast<double>(s.x[i]);
                           sum += x * (g[i] - static_cast<double>(s.r[i]));
                           p[i] = m + x;
                         }
                         return sum;
                       });
}

// Residual b - Hp in double precision; sets the report's residual and energy.
void measure(Solver& s, const std::vector<double>& p, std::vector<double>& residual) {
  const std::vector<double>& b = s.system.right_hand_side;
  apply_hessian(s.system, s.hessian, p.data(), residual.data(), s.workspace);
  s.report.energy =
      s.system.constant + parallel_sum(p.size(), block, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) {
          sum += p[i] * (0.5 * residual[i] - b[i]);
          residual[i] = b[i] - residual[i];
        }
        return sum;
      });
  s.report.relative_residual = s.norm_b > 0 ? norm(residual) / s.norm_b : 0;
}

// Rounds of single-precision solves of H x = b - Hp, each taken back if rounding made it useless.
void refine(Solver& s, std::vector<double>& p) {
  std::vector<double> residual(p.size());
  measure(s, p, residual);
  const auto add_step = [&](double factor) {
    for (std::size_t i = 0; i < p.size(); ++i) p[i] += factor * static_cast<double>(s.x[i]);
  };
  while (s.report.relative_residual > s.params.tolerance &&
         s.report.iterations < s.params.max_iterations) {
    const SolveReport before = s.report;
    const double norm = before.relative_residual * s.norm_b;
    for (std::size_t i = 0; i < p.size(); ++i) s.r[i] = static_cast<float>(residual[i] / norm);
    std::fill(s.x.begin(), s.x.end(), 0.0f);
    std::fill(s.d.begin(), s.d.end(), 0.0f);
    const double gain = 0.9 * s.params.tolerance / before.relative_residual;
    conjugate_gradient(s, std::clamp(gain, largest_gain, 0.5));
    add_step(norm);
    measure(s, p, residual);
    if (s.report.relative_residual < 0.5 * before.relative_residual) continue;
    if (s.report.relative_residual < before.relative_residual) return;
    add_step(-norm);
    s.report.energy = before.energy;
    s.report.relative_residual = before.relative_residual;
    return;
  }
}

}  // namespace

std::vector<double> fit_mean_profile(const ReducedSystem& system) {
  const std::size_t knots = system.knots(), pixels = system.pixels();
  // The hats, coupled through the pairs of each offset. A pair count per offset is enough:
  // boundaries and missing pairs only change how often a pair counts, and the start needs no more
  // than that.
  Eigen::MatrixXd normal =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(knots), static_cast<Eigen::Index>(knots));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(knots));
  for (std::size_t i = 0; i < system.offsets.size(); ++i) {
    const double in_grid =
        std::max(0.0, static_cast<double>(system.width - std::abs(system.offsets[i].dx))) *
        std::max(0, system.height - std::abs(system.offsets[i].dy));
    const double known = in_grid - static_cast<double>(system.missing[i].size());
    double phi = 0;
    for (const WeightTerm& term : system.weights) phi += term.phi[i];
    const double w = 4 * system.pair_count[i] * phi * known;
    const auto k = static_cast<Eigen::Index>(system.segment[i]);
    const double f = system.fraction[i];
    normal(k, k) += w * (1 - f) * (1 - f);
    normal(k, k + 1) += w * f * (1 - f);
    normal(k + 1, k) += w * f * (1 - f);
    normal(k + 1, k + 1) += w * f * f;
  }
  for (std::size_t k = 0; k < knots; ++k)
    right(static_cast<Eigen::Index>(k)) =
        parallel_sum(pixels, block, [&](std::size_t begin, std::size_t end) {
          double sum = 0;
          for (std::size_t i = begin; i < end; ++i) sum += system.right_hand_side[k * pixels + i];
          return sum;
        });
  // A little curvature settles knots that no offset sees.
  const double smooth = 1e-6 * normal.diagonal().maxCoeff() + 1e-300;
  for (std::size_t k = 0; k + 2 < knots; ++k) {
    const auto [l, m, r] = second_difference(system.knots_mm, k);
    Eigen::Vector3d row(l, m, r);
    const auto first = static_cast<Eigen::Index>(k);
    normal.block<3, 3>(first, first) += smooth * row * row.transpose();
  }
  normal.diagonal().array() += 1e-12 * smooth;
  const Eigen::VectorXd profile = normal.ldlt().solve(right);
  return {profile.data(), profile.data() + profile.size()};
}

SolveReport solve_reduced(const ReducedSystem& system, const Hessian& hessian,
                          const Preconditioner& preconditioner, const SolveParams& params,
                          const std::vector<double>& profile, std::vector<double>& p,
                          const Progress& progress) {
  const std::size_t n = system.unknowns();
  PARIAN_CHECK_EQ(p.size(), n);
  const std::vector<double>& b = system.right_hand_side;
  Solver solver{system, hessian, preconditioner, params, progress, {}, {}, {}, {}, {}, 0, {}};
  for (auto* vector : {&solver.x, &solver.r, &solver.z, &solver.d}) vector->resize(n);
  solver.norm_b = norm(b);
  if (params.tolerance >= single_precision_tolerance) {
    solve_single(solver, profile, p);
  } else {
    refine(solver, p);
  }
  return solver.report;
}

}  // namespace parian

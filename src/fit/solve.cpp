#include "fit/solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/aligned.h"
#include "base/check.h"
#include "base/parallel.h"
#include "fit/hessian_internal.h"
#include "fit/solve_kernels.h"

namespace parian {
namespace {

constexpr std::size_t block = std::size_t{1} << 15u;
// A single-precision solve gains at most about this much before rounding stops it.
constexpr double largest_gain = 1e-5;

double dot(const AlignedVector<float>& a, const AlignedVector<float>& b) {
  return parallel_sum(a.size(), block, [&](std::size_t begin, std::size_t end) {
    return dot_block(&a[begin], &b[begin], end - begin);
  });
}

double norm(const std::vector<double>& v) {
  return std::sqrt(parallel_sum(v.size(), block, [&](std::size_t begin, std::size_t end) {
    double sum = 0, squares = 0;
    sums_block(&v[begin], end - begin, &sum, &squares);
    return squares;
  }));
}

struct Solver {
  const ReducedSystem& system;
  const Hessian& hessian;
  const Preconditioner& preconditioner;
  const SolveParams& params;
  const Progress& progress;
  HessianWorkspace workspace;
  AlignedVector<float> x, r, d, hd;  // hd = H d
  double norm_b = 0;
  SolveReport report;
};

// Adds to x what brings the residual r = rhs - H x down to `target`. What touches one plane only is
// done with the plane's transform, while it is in cache.
void conjugate_gradient(Solver& s, double target) {
  const std::size_t pixels = s.system.pixels(), knots = s.system.knots();
  std::vector<double> squares(knots);
  std::vector<StepSums> sums(knots);
  double rr = dot(s.r, s.r), rz = 0;
  float alpha = 0, beta = 0;  // alpha: of the last direction's step, which is still to be made
  const auto step = [&](std::size_t k) {
    if (alpha == 0) return;
    const std::size_t at = k * pixels;
    squares[k] = step_block(alpha, &s.d[at], &s.hd[at], &s.x[at], &s.r[at], pixels);
  };
  PlaneHooks hooks;
  hooks.before = [&](std::size_t k) {
    float* d = &s.d[k * pixels];
    if (beta == 0) return finish_preconditioner(s.preconditioner, s.hessian, k, s.workspace, d);
    AlignedVector<float> z(pixels);
    finish_preconditioner(s.preconditioner, s.hessian, k, s.workspace, z.data());
    direction_block(beta, z.data(), d, pixels);
  };
  hooks.after = [&](std::size_t k) {
    sums[k] = {};
    step_sums_block(&s.d[k * pixels], &s.hd[k * pixels], &s.r[k * pixels], &sums[k], pixels);
  };
  const double start = std::sqrt(rr);
  for (double norm_r = start; s.report.iterations < s.params.max_iterations && norm_r > target;
       ++s.report.iterations) {
    advance_progress(s.progress, "solving",
                     std::clamp(std::log(norm_r / start) / std::log(target / start), 0.0, 1.0));
    const double rz_new =
        apply_preconditioner(s.preconditioner, s.hessian, s.r.data(), s.workspace, step);
    if (alpha != 0) rr = std::accumulate(squares.begin(), squares.end(), 0.0);
    alpha = 0;
    if (!(rz_new > 0)) break;  // rounding has the last word
    beta = static_cast<float>(rz > 0 ? rz_new / rz : 0);
    rz = rz_new;
    apply_hessian(s.system, s.hessian, s.d.data(), s.hd.data(), s.workspace, hooks);
    StepSums total;
    for (const StepSums& plane : sums) {
      total.d_hd += plane.d_hd;
      total.r_hd += plane.r_hd;
      total.hd_hd += plane.hd_hd;
    }
    if (!(total.d_hd > 0)) break;
    const double length = rz / total.d_hd;
    alpha = static_cast<float>(length);
    // |r - alpha H d|^2, before the step is made
    norm_r = std::sqrt(std::max(0.0, rr - length * (2 * total.r_hd - length * total.hd_hd)));
  }
  parallel_for(knots, step);
}

// x and H x to start from: those of `start` times the factor that minimises E, or p - profile.
// Returns the factor for both.
double prepare_start(Solver& s, const std::vector<double>& profile, const std::vector<double>& p,
                     const AlignedVector<double>& g, SolveStart* start) {
  const std::size_t n = p.size(), pixels = s.system.pixels();
  const bool given = start != nullptr && !start->deviation.empty();
  if (given) {
    s.x = std::move(start->deviation);
  } else {
    parallel_for_blocks(n, pixels, [&](std::size_t begin, std::size_t end) {
      const double m = profile[begin / pixels];
      for (std::size_t i = begin; i < end; ++i) s.x[i] = static_cast<float>(p[i] - m);
    });
  }
  const bool known = given && !start->product.empty();
  if (known) s.hd = std::move(start->product);
  std::vector<double> gx(s.system.knots()), xhx(s.system.knots());
  const auto measure = [&](std::size_t k) {
    gx[k] = dot_mixed_block(&g[k * pixels], &s.x[k * pixels], pixels);
    xhx[k] = dot_block(&s.x[k * pixels], &s.hd[k * pixels], pixels);
  };
  if (known) {
    parallel_for(gx.size(), measure);
  } else if (dot(s.x, s.x) == 0) {
    return 0;
  } else {
    apply_hessian(s.system, s.hessian, s.x.data(), s.hd.data(), s.workspace, {{}, measure});
  }
  const double curvature = std::accumulate(xhx.begin(), xhx.end(), 0.0);
  return curvature > 0 ? -std::accumulate(gx.begin(), gx.end(), 0.0) / curvature : 0;
}

// In single precision throughout but for the gradient g at the constant field m = profile:
//   p = m + x,  r = -g - H x,  E(p) = E(m) + g^T x / 2 - x^T r / 2
void solve_single(Solver& s, const std::vector<double>& profile, std::vector<double>& p,
                  SolveStart* start) {
  const std::size_t n = p.size(), pixels = s.system.pixels();
  const std::vector<double>& b = s.system.right_hand_side;
  AlignedVector<double> g(n);  // first H m
  apply_hessian_to_constant(s.system, s.hessian, profile, g.data(), s.workspace);
  // Blocks are planes, so the profile's value is the same within each.
  const double energy_of_mean =
      s.system.constant + parallel_sum(n, pixels, [&](std::size_t begin, std::size_t end) {
        return subtract_block(profile[begin / pixels], &b[begin], &g[begin], end - begin);
      });
  const auto factor = static_cast<float>(prepare_start(s, profile, p, g, start));
  parallel_for_blocks(n, pixels, [&](std::size_t begin, std::size_t end) {
    start_block(factor, &g[begin], &s.hd[begin], &s.x[begin], &s.r[begin], end - begin);
  });
  conjugate_gradient(s, s.params.tolerance * s.norm_b);
  s.report.relative_residual = s.norm_b > 0 ? std::sqrt(dot(s.r, s.r)) / s.norm_b : 0;
  s.report.energy =
      energy_of_mean + 0.5 * parallel_sum(n, pixels, [&](std::size_t begin, std::size_t end) {
                         return finish_block(profile[begin / pixels], &g[begin], &s.x[begin],
                                             &s.r[begin], &s.hd[begin], &p[begin], end - begin);
                       });
  if (start != nullptr) *start = {std::move(s.x), std::move(s.hd)};
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

std::vector<double> solve_profile(const ReducedSystem& system, const std::vector<double>& weight,
                                  const std::vector<double>& right) {
  const std::size_t knots = system.knots();
  const auto n = static_cast<Eigen::Index>(knots);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < system.offsets.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(system.segment[i]);
    const double f = system.fraction[i], w = weight[i];
    normal(k, k) += w * (1 - f) * (1 - f);
    normal(k, k + 1) += w * f * (1 - f);
    normal(k + 1, k) += w * f * (1 - f);
    normal(k + 1, k + 1) += w * f * f;
  }
  // A little curvature settles knots that no offset sees.
  const double smooth = 1e-6 * normal.diagonal().maxCoeff() + 1e-300;
  for (std::size_t k = 0; k + 2 < knots; ++k) {
    const auto [l, m, r] = second_difference(system.knots_mm, k);
    Eigen::Vector3d row(l, m, r);
    const auto first = static_cast<Eigen::Index>(k);
    normal.block<3, 3>(first, first) += smooth * row * row.transpose();
  }
  normal.diagonal().array() += 1e-12 * smooth;
  const Eigen::VectorXd profile =
      normal.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(right.data(), n));
  return {profile.data(), profile.data() + profile.size()};
}

std::vector<double> fit_mean_profile(const ReducedSystem& system) {
  const std::size_t pixels = system.pixels();
  // The hats, coupled through the pairs of each offset. A pair count per offset is enough:
  // boundaries and missing pairs only change how often a pair counts, and the start needs no more
  // than that.
  std::vector<double> weight, right;
  for (std::size_t i = 0; i < system.offsets.size(); ++i) {
    const double in_grid =
        std::max(0.0, static_cast<double>(system.width - std::abs(system.offsets[i].dx))) *
        std::max(0, system.height - std::abs(system.offsets[i].dy));
    const double known = in_grid - static_cast<double>(system.missing[i].size());
    double phi = 0;
    for (const WeightTerm& term : system.weights) phi += term.phi[i];
    weight.push_back(4 * system.pair_count[i] * phi * known);
  }
  for (std::size_t k = 0; k < system.knots(); ++k)
    right.push_back(parallel_sum(pixels, block, [&](std::size_t begin, std::size_t end) {
      double sum = 0, squares = 0;
      sums_block(&system.right_hand_side[k * pixels + begin], end - begin, &sum, &squares);
      return sum;
    }));
  return solve_profile(system, weight, right);
}

SolveReport solve_reduced(const ReducedSystem& system, const Hessian& hessian,
                          const Preconditioner& preconditioner, const SolveParams& params,
                          const std::vector<double>& profile, std::vector<double>& p,
                          const Progress& progress, SolveStart* start) {
  const std::size_t n = system.unknowns();
  PARIAN_CHECK_EQ(p.size(), n);
  const std::vector<double>& b = system.right_hand_side;
  Solver solver{system, hessian, preconditioner, params, progress, {}, {}, {}, {}, {}, 0, {}};
  for (auto* vector : {&solver.x, &solver.r, &solver.d, &solver.hd}) vector->resize(n);
  solver.norm_b = norm(b);
  if (params.tolerance >= single_precision_tolerance) {
    solve_single(solver, profile, p, start);
  } else {
    refine(solver, p);
  }
  return solver.report;
}

}  // namespace parian

#include "fit/solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

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

double dot(const std::vector<float>& a, const std::vector<float>& b) {
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

struct Solver {
  const ReducedSystem& system;
  const Hessian& hessian;
  const Preconditioner& preconditioner;
  const Progress& progress;
  HessianWorkspace workspace;
  std::vector<float> x, r, z, d;  // z also holds H d
};

// Solves H x = r until |r| has fallen by `gain`; returns the iterations.
int conjugate_gradient(Solver& s, double gain, int max_iterations) {
  std::fill(s.x.begin(), s.x.end(), 0.0f);
  const double start = std::sqrt(dot(s.r, s.r));
  double rz = 0;
  int iteration = 0;
  for (double norm_r = start; iteration < max_iterations && norm_r > gain * start; ++iteration) {
    advance_progress(s.progress, "solving",
                     std::clamp(std::log(norm_r / start) / std::log(gain), 0.0, 1.0));
    apply_preconditioner(s.preconditioner, s.hessian, s.r.data(), s.z.data(), s.workspace);
    const double rz_new = dot(s.r, s.z);
    if (!(rz_new > 0)) break;  // rounding has the last word
    const auto beta = static_cast<float>(rz > 0 ? rz_new / rz : 0);
    parallel_for_blocks(s.d.size(), block, [&](std::size_t begin, std::size_t end) {
      direction_block(beta, &s.z[begin], &s.d[begin], end - begin);
    });
    rz = rz_new;
    apply_hessian(s.system, s.hessian, s.d.data(), s.z.data(), s.workspace);
    const double curvature = dot(s.d, s.z);
    if (!(curvature > 0)) break;
    const auto alpha = static_cast<float>(rz / curvature);
    norm_r = std::sqrt(parallel_sum(s.d.size(), block, [&](std::size_t begin, std::size_t end) {
      return step_block(alpha, &s.d[begin], &s.z[begin], &s.x[begin], &s.r[begin], end - begin);
    }));
  }
  return iteration;
}

// p += factor x
void add_step(const Solver& solver, double factor, std::vector<double>& p) {
  parallel_for_blocks(p.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) p[i] += factor * static_cast<double>(solver.x[i]);
  });
}

}  // namespace

std::vector<double> make_mean_start(const ReducedSystem& system) {
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
  std::vector<double> start(system.unknowns());
  for (std::size_t k = 0; k < knots; ++k)
    std::fill_n(start.begin() + static_cast<std::ptrdiff_t>(k * pixels), pixels,
                profile(static_cast<Eigen::Index>(k)));
  return start;
}

SolveReport solve_reduced(const ReducedSystem& system, const Hessian& hessian,
                          const Preconditioner& preconditioner, const SolveParams& params,
                          std::vector<double>& p, const Progress& progress) {
  const std::size_t n = system.unknowns();
  Solver solver{system,
                hessian,
                preconditioner,
                progress,
                {},
                std::vector<float>(n),
                std::vector<float>(n),
                std::vector<float>(n),
                std::vector<float>(n)};
  std::vector<double> residual(n);
  const std::vector<double>& b = system.right_hand_side;
  const double norm_b = norm(b);
  SolveReport report;
  double last = 0, last_energy = 0, step = 0;
  for (int round = 0;; ++round) {
    if (round == 0 && params.start_is_constant && system.restream == nullptr) {
      apply_hessian_to_constant(system, hessian, p.data(), residual.data());
    } else {
      apply_hessian(system, hessian, p.data(), residual.data(), solver.workspace);
    }
    report.energy = eval_energy(system, p.data(), residual.data());
    parallel_for_blocks(n, block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) residual[i] = b[i] - residual[i];
    });
    const double norm_r = norm(residual);
    report.relative_residual = norm_b > 0 ? norm_r / norm_b : 0;
    if (round > 0 && !(report.relative_residual < last)) {  // rounding undid the last step
      add_step(solver, -step, p);
      report.relative_residual = last;
      report.energy = last_energy;
      break;
    }
    const bool stalled = round > 0 && report.relative_residual > 0.5 * last;
    if (report.relative_residual <= params.tolerance || stalled ||
        report.iterations >= params.max_iterations)
      break;
    last = report.relative_residual;
    last_energy = report.energy;
    step = norm_r;
    // The residual is scaled to norm 1, so that nothing underflows in single precision.
    parallel_for_blocks(n, block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        solver.r[i] = static_cast<float>(residual[i] / norm_r);
    });
    std::fill(solver.d.begin(), solver.d.end(), 0.0f);
    const double gain =
        std::clamp(0.9 * params.tolerance / report.relative_residual, largest_gain, 0.5);
    report.iterations +=
        conjugate_gradient(solver, gain, params.max_iterations - report.iterations);
    add_step(solver, step, p);
  }
  return report;
}

}  // namespace parian

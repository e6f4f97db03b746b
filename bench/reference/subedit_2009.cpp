#include "bench/reference/subedit_2009.h"

#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "fit/hessian.h"

namespace parian {
namespace {

constexpr std::size_t block = std::size_t{1} << 15u;

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  return parallel_sum(a.size(), block, [&](std::size_t begin, std::size_t end) {
    double lanes[8] = {};
    std::size_t i = begin;
    for (; i + 8 <= end; i += 8)
      for (std::size_t j = 0; j < 8; ++j)
        lanes[j] += static_cast<double>(a[i + j]) * static_cast<double>(b[i + j]);
    for (; i < end; ++i) lanes[0] += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    double sum = 0;
    for (double lane : lanes) sum += lane;
    return sum;
  });
}

// y += factor x
void add(std::vector<float>& y, double factor, const std::vector<float>& x) {
  const auto f = static_cast<float>(factor);
  parallel_for_blocks(y.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) y[i] += f * x[i];
  });
}

// x = r + factor x
void add_to(std::vector<float>& x, double factor, const std::vector<float>& r) {
  const auto f = static_cast<float>(factor);
  parallel_for_blocks(x.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) x[i] = r[i] + f * x[i];
  });
}

// Eq. 8 has a row for each ordered pair: (x, x + d) and (x + d, x) are two.
void list_ordered_pairs(ReducedSystem& system) {
  PARIAN_CHECK_EQ(system.not_measured,
                  std::size_t{0});  // rows of missing pairs are not left out here
  const std::size_t listed = system.offsets.size();
  for (std::size_t i = 0; i < listed; ++i) {
    if (system.pair_count[i] < 2) continue;
    system.pair_count[i] = 1;
    system.offsets.push_back({-system.offsets[i].dx, -system.offsets[i].dy});
    system.pair_count.push_back(1);
    system.segment.push_back(system.segment[i]);
    system.fraction.push_back(system.fraction[i]);
    system.weights[0].phi.push_back(system.weights[0].phi[i]);
    system.missing.emplace_back();
  }
}

}  // namespace

ReferenceResult fit_subedit_2009(const SliceSource& table, int channel, int segments, double lambda,
                                 double tolerance, int max_iterations) {
  FitParams params;
  params.segments = segments;
  ReducedParams reduced;
  reduced.knots_mm = make_knots(table.header(), params);
  reduced.lambda = lambda;
  reduced.weight = PairWeight::uniform;
  // A^T y and the row geometry; the products below go over the pairs, row by row.
  ReducedSystem system = make_reduced_system(table, channel, reduced);
  list_ordered_pairs(system);
  Hessian rows;
  rows.method = ProductMethod::explicit_;
  rows.knots = system.knots();
  HessianWorkspace workspace;

  const std::size_t n = system.unknowns();
  ReferenceResult result{std::vector<float>(n), 0, 0};
  std::vector<float> r(system.right_hand_side.begin(), system.right_hand_side.end()), d = r, hd(n);
  const double norm_b = std::sqrt(dot(r, r));
  double rr = norm_b * norm_b;
  for (; result.iterations < max_iterations && std::sqrt(rr) > tolerance * norm_b;
       ++result.iterations) {
    apply_hessian(system, rows, d.data(), hd.data(), workspace);
    const double alpha = rr / dot(d, hd);
    add(result.log_profile, alpha, d);
    add(r, -alpha, hd);
    const double rr_new = dot(r, r);
    add_to(d, rr_new / rr, r);
    rr = rr_new;
  }
  const std::vector<double> p(result.log_profile.begin(), result.log_profile.end());
  std::vector<double> product(n);
  apply_hessian(system, rows, p.data(), product.data(), workspace);
  double square = 0;
  for (std::size_t i = 0; i < n; ++i) square += std::pow(system.right_hand_side[i] - product[i], 2);
  result.relative_residual = std::sqrt(square) / norm_b;
  return result;
}

}  // namespace parian

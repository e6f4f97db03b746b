#include "fit/reduced_system.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <string>

#include "base/test_errors.h"
#include "fit/hessian.h"
#include "fit/pair_weights.h"
#include "fit/solve.h"
#include "fit/test_tables.h"

namespace parian {
namespace {

// E summed over pairs, as in the 2009 paper's Eq. 7 and 9: nothing of the reduced system.
double energy_over_pairs(const BssrdfTable& table, int channel, const ReducedSystem& system,
                         const std::vector<double>& p,
                         const std::function<double(std::size_t offset, std::size_t x,
                                                    std::size_t y, double value)>& weight) {
  const TableHeader& header = table.header;
  double energy = 0;
  const auto& knots = system.knots_mm;
  const auto log_profile = [&](std::size_t pixel, double r) {
    std::size_t k = 0;
    while (k + 2 < knots.size() && r > knots[k + 1]) ++k;
    const double w = (r - knots[k]) / (knots[k + 1] - knots[k]);
    return (1 - w) * p[k * system.pixels() + pixel] + w * p[(k + 1) * system.pixels() + pixel];
  };
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const Offset d = header.offsets[i];
    const double r = length_px(d) * header.pixel_pitch_mm;
    if (r > knots.back() * (1 + 1e-9)) continue;
    const float* slice = slice_of(table, channel, static_cast<int>(i));
    const PixelRange range = pairs_in_grid(header, d);
    for (int y = range.y0; y < range.y1; ++y) {
      for (int x = range.x0; x < range.x1; ++x) {
        const auto from = static_cast<std::size_t>(y * header.width + x);
        const auto to = static_cast<std::size_t>((y + d.dy) * header.width + x + d.dx);
        if (!(slice[from] > 0) || is_held_out(system.hold_out, x, y, d)) continue;
        const double value = static_cast<double>(slice[from]);
        const double e = log_profile(from, r) + log_profile(to, r) - 2 * std::log(value);
        energy += 0.5 * pair_count(header, d) * weight(i, from, to, value) * e * e;
      }
    }
  }
  for (std::size_t k = 0; k + 2 < knots.size(); ++k) {
    const auto [l, m, r] = second_difference(knots, k);
    for (std::size_t x = 0; x < system.pixels(); ++x) {
      const double curvature = l * p[k * system.pixels() + x] +
                               m * p[(k + 1) * system.pixels() + x] +
                               r * p[(k + 2) * system.pixels() + x];
      energy += 0.5 * system.lambda * system.lambda * curvature * curvature;
    }
  }
  return energy;
}

std::vector<double> random_field(const ReducedSystem& system, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<double> p(system.unknowns());
  for (double& value : p) value = -3 + sample_normal(rng);
  return p;
}

std::vector<double> product(const ReducedSystem& system, const std::vector<double>& p,
                            ProductMethod method) {
  HessianWorkspace workspace;
  std::vector<double> out(p.size());
  apply_hessian(system, make_hessian(system, method), p.data(), out.data(), workspace);
  return out;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
    scale = std::max(scale, std::abs(b[i]));
  }
  return worst / scale;
}

struct Case {
  const char* name;
  BssrdfTable table;
  ReducedParams params;
};

ReducedParams params_with(PairWeight weight, double radius_px, int segments) {
  ReducedParams params;
  params.weight = weight;
  params.lambda = 0.3;
  for (int k = 0; k <= segments; ++k) params.knots_mm.push_back(0.5 * radius_px * k / segments);
  return params;
}

std::vector<Case> make_cases() {
  std::vector<Case> cases;
  cases.push_back({"uniform", make_test_table(9, 7, 3), params_with(PairWeight::uniform, 3, 3)});
  cases.push_back({"inverse quadratic, fine knots", make_test_table(8, 9, 4),
                   params_with(PairWeight::inverse_quadratic, 4, 7)});
  cases.push_back({"energy", make_test_table(10, 6, 3), params_with(PairWeight::energy, 3, 4)});
  cases.push_back({"radius below the table's", make_test_table(8, 8, 4),
                   params_with(PairWeight::uniform, 2.5, 2)});
  cases.push_back({"both directions", make_test_table(7, 6, 3, 1, false),
                   params_with(PairWeight::uniform, 3, 3)});
  cases.push_back(
      {"radius of one pixel", make_test_table(5, 4, 1), params_with(PairWeight::uniform, 1, 1)});
  Case missing{"missing pairs", make_test_table(9, 8, 3),
               params_with(PairWeight::inverse_quadratic, 3, 3)};
  remove_pairs(missing.table, 0.1, 5);
  cases.push_back(missing);
  Case many{"most pairs missing: restreamed", make_test_table(9, 8, 3.2),
            params_with(PairWeight::uniform, 3, 1)};
  remove_pairs(many.table, 0.7, 6);
  cases.push_back(many);
  Case held{"held out", make_test_table(9, 8, 3), params_with(PairWeight::energy, 3, 3)};
  held.params.hold_out = {0.2, 4};
  cases.push_back(held);
  Case terms{"two weight terms", make_test_table(8, 7, 3), params_with(PairWeight::uniform, 3, 3)};
  Rng rng = make_rng(8);
  for (int q = 0; q < 2; ++q) {
    WeightTerm term;
    for (std::size_t x = 0; x < terms.table.header.pixels(); ++x)
      term.u.push_back(static_cast<float>(0.2 + sample_uniform(rng)));
    for (std::size_t i = 0; i < terms.table.header.offsets.size(); ++i)
      term.phi.push_back(0.1 + sample_uniform(rng));
    terms.params.weights.push_back(term);
  }
  cases.push_back(terms);
  return cases;
}

double weight_of(const ReducedSystem& system, std::size_t table_offset, std::size_t x,
                 std::size_t y) {
  std::size_t i = 0;
  while (system.table_index[i] != static_cast<int>(table_offset)) ++i;
  double sum = 0;
  for (const WeightTerm& term : system.weights)
    sum += term.phi[i] *
           (term.u.empty() ? 1.0 : static_cast<double>(term.u[x]) * static_cast<double>(term.u[y]));
  return sum;
}

TEST(ReducedSystem, EnergyIsTheEnergySummedOverPairs) {
  for (const Case& c : make_cases()) {
    const auto source = make_slices(c.table);
    const ReducedSystem system = make_reduced_system(*source, 0, c.params);
    for (ProductMethod method : {ProductMethod::fft, ProductMethod::explicit_}) {
      if (system.restream != nullptr && method == ProductMethod::fft) continue;
      const std::vector<double> p = random_field(system, 1);
      const double direct = energy_over_pairs(
          c.table, 0, system, p, [&](std::size_t i, std::size_t x, std::size_t y, double) {
            return weight_of(system, i, x, y);
          });
      EXPECT_NEAR(eval_energy(system, make_hessian(system, method), p.data()) / direct, 1, 1e-6)
          << c.name;
    }
  }
}

TEST(ReducedSystem, WeightsAndCountsAreAsStated) {
  std::vector<Case> cases = make_cases();
  const auto source = make_slices(cases[2].table);
  const ReducedSystem energy = make_reduced_system(*source, 0, cases[2].params);
  EXPECT_EQ(energy.weights[0].phi[0], 1.0);  // (0,0) is brightest
  for (double phi : energy.weights[0].phi) EXPECT_TRUE(phi > 0 && phi <= 1);
  cases[0].table.header.noise_floor = {0.01};
  cases[0].table.header.noise_gain = {0.002};
  slice_of(cases[0].table, 0, 2)[3] = -0.001f;
  const auto noisy = make_slices(cases[0].table);
  EXPECT_EQ(make_reduced_system(*noisy, 0, cases[0].params).not_positive, 1u);
  std::size_t ordered = 0;
  for (Offset d : energy.offsets) {
    const PixelRange range = pairs_in_grid(source->header(), d);
    ordered += static_cast<std::size_t>((range.x1 - range.x0) * (range.y1 - range.y0)) *
               (d == Offset{} ? 1u : 2u);
  }
  EXPECT_EQ(energy.pairs, ordered);
}

TEST(Hessian, FftProductIsTheDirectProduct) {
  for (const Case& c : make_cases()) {
    const auto source = make_slices(c.table);
    const ReducedSystem system = make_reduced_system(*source, 0, c.params);
    if (system.restream != nullptr) continue;
    const std::vector<double> p = random_field(system, 2);
    EXPECT_LT(largest_difference(product(system, p, ProductMethod::fft),
                                 product(system, p, ProductMethod::explicit_)),
              1e-7)
        << c.name;
  }
}

TEST(Hessian, ConstantFieldsNeedNoConvolution) {
  for (const Case& c : make_cases()) {
    const auto source = make_slices(c.table);
    const ReducedSystem system = make_reduced_system(*source, 0, c.params);
    if (system.restream != nullptr) continue;
    const std::vector<double> profile = fit_mean_profile(system);
    const std::vector<double> p = make_constant_field(system, profile);
    std::vector<double> out(p.size());
    HessianWorkspace workspace;
    apply_hessian_to_constant(system, make_hessian(system, ProductMethod::fft), profile, out.data(),
                              workspace);
    EXPECT_LT(largest_difference(out, product(system, p, ProductMethod::explicit_)), 1e-7)
        << c.name;
  }
}

TEST(Hessian, SinglePrecisionAgrees) {
  const BssrdfTable table = make_test_table(12, 11, 4);
  const auto source = make_slices(table);
  const ReducedSystem system =
      make_reduced_system(*source, 0, params_with(PairWeight::inverse_quadratic, 4, 4));
  const std::vector<double> p = random_field(system, 3);
  const std::vector<float> single(p.begin(), p.end());
  std::vector<float> out(p.size());
  HessianWorkspace workspace;
  apply_hessian(system, make_hessian(system, ProductMethod::fft), single.data(), out.data(),
                workspace);
  EXPECT_LT(largest_difference({out.begin(), out.end()}, product(system, p, ProductMethod::fft)),
            1e-5);
}

TEST(ReducedSystem, GradientMatchesFiniteDifferences) {
  for (const Case& c : make_cases()) {
    const auto source = make_slices(c.table);
    const ReducedSystem system = make_reduced_system(*source, 0, c.params);
    const Hessian hessian = make_hessian(system);
    std::vector<double> p = random_field(system, 4);
    const std::vector<double> hp = product(system, p, hessian.method);
    Rng rng = make_rng(9);
    for (int trial = 0; trial < 6; ++trial) {
      const std::size_t i = sample_u32(rng) % p.size();
      const double step = 0.01, before = p[i];  // E is quadratic: central differences are exact
      p[i] = before + step;
      const double up = eval_energy(system, hessian, p.data());
      p[i] = before - step;
      const double down = eval_energy(system, hessian, p.data());
      p[i] = before;
      const double gradient = hp[i] - system.right_hand_side[i];
      EXPECT_NEAR((up - down) / (2 * step), gradient,
                  1e-5 * (std::abs(gradient) + std::abs(hp[i]) + 1))
          << c.name;
    }
  }
}

Eigen::MatrixXd dense_hessian(const ReducedSystem& system) {
  const Hessian hessian = make_hessian(system, ProductMethod::explicit_);
  const auto n = static_cast<Eigen::Index>(system.unknowns());
  Eigen::MatrixXd h(n, n);
  HessianWorkspace workspace;
  std::vector<double> unit(system.unknowns());
  for (Eigen::Index i = 0; i < n; ++i) {
    unit[static_cast<std::size_t>(i)] = 1;
    apply_hessian(system, hessian, unit.data(), h.col(i).data(), workspace);
    unit[static_cast<std::size_t>(i)] = 0;
  }
  return h;
}

TEST(Solve, AgreesWithADenseFactorisation) {
  for (const Case& c : make_cases()) {
    const auto source = make_slices(c.table);
    const ReducedSystem system = make_reduced_system(*source, 0, c.params);
    const Eigen::MatrixXd h = dense_hessian(system);
    EXPECT_LT((h - h.transpose()).norm(), 1e-6 * h.norm()) << c.name;
    const Eigen::Map<const Eigen::VectorXd> b(system.right_hand_side.data(), h.rows());
    const Eigen::VectorXd exact = h.ldlt().solve(b);

    const Hessian hessian = make_hessian(system);
    const std::vector<double> profile = fit_mean_profile(system);
    std::vector<double> p = make_constant_field(system, profile);
    const SolveReport report = solve_reduced(system, hessian, make_preconditioner(system, hessian),
                                             {1e-11, 500}, profile, p);
    // With offsets of one pixel only, a checkerboard on the outer knot changes nothing: H is
    // singular.
    const bool singular = system.offsets.size() == 3;
    EXPECT_LE(report.relative_residual, singular ? 1e-5 : 1e-9) << c.name;
    if (singular) continue;
    const Eigen::Map<const Eigen::VectorXd> solved(p.data(), h.rows());
    EXPECT_LT((solved - exact).norm(), 2e-4 * exact.norm()) << c.name;
  }
}

TEST(Solve, SinglePrecisionReportsItsTrueResidualAndEnergy) {
  for (const Case& c : make_cases()) {
    const auto source = make_slices(c.table);
    const ReducedSystem system = make_reduced_system(*source, 0, c.params);
    const Hessian hessian = make_hessian(system);
    const std::vector<double> profile = fit_mean_profile(system);
    std::vector<double> p = make_constant_field(system, profile);
    const SolveReport report = solve_reduced(system, hessian, make_preconditioner(system, hessian),
                                             {1e-5, 500}, profile, p);
    EXPECT_LE(report.relative_residual, 1e-5) << c.name;
    const std::vector<double> hp = product(system, p, hessian.method);
    double residual = 0, norm_b = 0, energy = system.constant;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double b = system.right_hand_side[i];
      residual += (b - hp[i]) * (b - hp[i]);
      norm_b += b * b;
      energy += p[i] * (0.5 * hp[i] - b);
    }
    EXPECT_LE(std::sqrt(residual / norm_b), 1.1e-5) << c.name;
    // What single precision may cost is relative to the energy that the deviations explain.
    const double explained =
        eval_energy(system, hessian, make_constant_field(system, profile).data()) - energy;
    EXPECT_NEAR(report.energy, energy, 1e-5 * explained) << c.name;
    const Hessian single = make_hessian(system, hessian.method, false);
    EXPECT_NEAR(eval_energy(system, single, p.data()), energy, 1e-5 * explained) << c.name;
  }
}

TEST(ReducedSystem, PixelsWithoutAPairAreAnErrorOrMasked) {
  BssrdfTable table = make_test_table(6, 5, 2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
    float* slice = slice_of(table, 0, static_cast<int>(i));
    slice[2 * 6 + 3] = nan;  // as x
    const Offset d = table.header.offsets[i];
    const int x = 3 - d.dx, y = 2 - d.dy;  // as x + d
    if (x >= 0 && x < 6 && y >= 0) slice[y * 6 + x] = nan;
  }
  const auto source = make_slices(table, "a.h5");
  ReducedParams params = params_with(PairWeight::energy, 2, 2);
  EXPECT_EQ(
      error_of([&] { make_reduced_system(*source, 0, params); }),
      "a.h5: channel 0, pixel (3, 2): expected at least one measured pair within the radius (or "
      "--fill-unmeasured), found none");
  params.allow_unmeasured = true;
  const ReducedSystem system = make_reduced_system(*source, 0, params);
  EXPECT_EQ(unmeasured_pixels(system), (std::vector<std::uint32_t>{2 * 6 + 3}));
  for (const auto& list : system.missing) EXPECT_TRUE(list.empty());
}

}  // namespace
}  // namespace parian

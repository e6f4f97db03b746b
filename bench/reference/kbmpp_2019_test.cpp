#include "bench/reference/kbmpp_2019.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "bench/reference/kbmpp_2019_match.h"
#include "bench/reference/kbmpp_2019_pairs.h"
#include "bench/reference/kbmpp_2019_solver.h"
#include "compress/test_materials.h"

namespace parian {
namespace {

// Unevenly spaced, the last one between two lengths of offsets.
const std::vector<double> uneven_knots{0, 0.5, 0.8, 1.7, 2.4};

// Every seventh value is not measured, and only in one channel.
BssrdfTable make_holes(BssrdfTable table) {
  for (std::size_t i = 3; i < table.reflectance.size(); i += 7)
    table.reflectance[i] = std::numeric_limits<float>::quiet_NaN();
  return table;
}

KbmppParams small_params(int per_pixel) {
  KbmppParams params;
  params.per_pixel = per_pixel;
  params.bases = 6;
  params.iterations = 4;
  params.inner = 15;
  params.random_candidates = 4;
  return params;
}

// A solver away from its start: weights differ, multipliers act.
kbmpp::Solver make_stirred_solver(const kbmpp::Pairs& pairs, const KbmppParams& params) {
  kbmpp::Solver solver = kbmpp::make_solver(pairs, params);
  Rng rng = make_rng(3);
  for (std::size_t i = 0; i < solver.x.size(); ++i)
    solver.x[i] =
        solver.box.kind[i] == 0 ? -3 + 2 * sample_uniform(rng) : 0.2 + 0.5 * sample_uniform(rng);
  for (double& multiplier : solver.lagrangian.multiplier) multiplier = 40 * sample_uniform(rng);
  solver.lagrangian.penalty = 0.01;
  return solver;
}

struct KbmppOf : testing::TestWithParam<int> {};

TEST_P(KbmppOf, GradientIsTheDerivative) {
  const BssrdfTable table = make_holes(make_test_table(make_test_map(9, 8), 0.1));
  KbmppParams params = small_params(GetParam());
  params.lambda_reg = 10;  // so that every term can be seen
  params.lambda_barr = 5e3;
  const kbmpp::Pairs pairs = kbmpp::make_pairs(table, uneven_knots);
  kbmpp::Solver solver = make_stirred_solver(pairs, params);
  std::vector<double> gradient(solver.x.size()), ignored(solver.x.size());
  kbmpp::eval_objective(solver, solver.x.data(), gradient.data());
  double largest = 0;
  for (const double g : gradient) largest = std::max(largest, std::abs(g));
  for (std::size_t i = 0; i < solver.x.size(); i += 5) {
    const double h = 0.005, x = solver.x[i];
    solver.x[i] = x + h;
    const double above = kbmpp::eval_objective(solver, solver.x.data(), ignored.data());
    solver.x[i] = x - h;
    const double below = kbmpp::eval_objective(solver, solver.x.data(), ignored.data());
    solver.x[i] = x;
    EXPECT_NEAR((above - below) / (2 * h), gradient[i],
                1e-4 * largest + 5e-3 * std::abs(gradient[i]))
        << "variable " << i;
  }
}

TEST_P(KbmppOf, EnergyIsThatOfThePairs) {
  const BssrdfTable table = make_holes(make_test_table(make_test_map(), 0.1));
  double energy = 0;
  const ProfileBlend blend = run_kbmpp(table, uneven_knots, small_params(GetParam()),
                                       [&](const KbmppRound& round) { energy = round.energy; });
  EXPECT_GT(energy, 1);
  EXPECT_NEAR(eval_kbmpp_energy(table, blend) / energy, 1, 2e-5);
}

TEST_P(KbmppOf, SolverDoesNotRaiseItsEnergy) {
  const BssrdfTable table = make_test_table(make_test_map(), 0.1);
  const kbmpp::Pairs pairs = kbmpp::make_pairs(table, uneven_knots);
  const KbmppParams params = small_params(GetParam());
  kbmpp::Solver solver = kbmpp::make_solver(pairs, params);
  std::vector<double> gradient(solver.x.size());
  double before = kbmpp::eval_objective(solver, solver.x.data(), gradient.data());
  const double start = before;
  for (int i = 0; i < 5; ++i) {
    const double after_same_function = [&] {
      minimise_lbfgsb(solver.x, solver.box, 5, 1, [&](const double* x, double* g) {
        return kbmpp::eval_objective(solver, x, g);
      });
      return kbmpp::eval_objective(solver, solver.x.data(), gradient.data());
    }();
    EXPECT_LE(after_same_function, before);
    before = after_same_function;
  }
  EXPECT_LT(before, 0.9 * start);
}

TEST_P(KbmppOf, PlantedBlendIsFoundAgain) {
  const BssrdfTable data = make_test_table(make_test_map());
  KbmppParams params = small_params(GetParam());
  params.bases = 4;
  const std::vector<double> knots{0, 0.5, 1, 1.5, 2, 2.5};
  const ProfileBlend planted = run_kbmpp(data, knots, params);
  const Material material = planted;
  const BssrdfTable table = read_table(*make_slices(material, data.header));
  params.seed = 7;
  params.iterations = 20;
  params.inner = 30;
  params.run_iterations = 1;
  std::vector<double> energies;
  const auto record = [&](const KbmppRound& round) { energies.push_back(round.energy); };
  run_kbmpp(table, knots, params, record);
  params.run_iterations = 0;
  run_kbmpp(table, knots, params, record);
  EXPECT_LT(energies.back(), 0.1 * energies.front());
}

TEST_P(KbmppOf, WeightsLieOnTheSimplex) {
  const BssrdfTable table = make_test_table(make_test_map());
  const ProfileBlend blend = run_kbmpp(table, uneven_knots, small_params(GetParam()));
  float weights[max_bases_per_pixel];
  for (std::size_t x = 0; x < blend.pixels(); ++x) {
    get_weights(blend, x, weights);
    float sum = 0;
    for (int k = 0; k < GetParam(); ++k) {
      EXPECT_GE(weights[k], 0);
      sum += weights[k];
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(PerPixel, KbmppOf, testing::Values(1, 2, 3));

void expect_near_rows(const AlignedVector<float>& a, const AlignedVector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  float largest = 0;
  for (const float value : b) largest = std::max(largest, std::abs(value));
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 2e-5f * largest) << i;
}

// What the sweep keeps up to date must be what an evaluation finds: curvature, increments, border,
// holes; and a sweep with several tiles.
void test_sweep(const BssrdfTable& table, int iteration) {
  const KbmppParams params = small_params(2);
  const kbmpp::Pairs pairs = kbmpp::make_pairs(table, uneven_knots);
  kbmpp::Solver solver = make_stirred_solver(pairs, params);
  std::vector<double> gradient(solver.x.size());
  kbmpp::eval_objective(solver, solver.x.data(), gradient.data());
  kbmpp::Workspace& work = solver.work;
  const double before = kbmpp::eval_energy(pairs, solver.model, work);
  const auto mask = kbmpp::make_pair_mask(pairs);
  EXPECT_EQ(mask.empty(), pairs.complete);
  EXPECT_EQ(kbmpp::sweep(pairs, mask, {iteration, 0, 4, 1}, solver.model, work), 0u);
  EXPECT_GT(kbmpp::sweep(pairs, mask, {iteration, 1, 4, 1}, solver.model, work),
            pairs.pixels() / 4);
  const kbmpp::Workspace kept = work;
  EXPECT_LT(kbmpp::eval_energy(pairs, solver.model, work), 0.9 * before);
  expect_near_rows(kept.rows, work.rows);
  expect_near_rows(kept.gradient, work.gradient);
}

TEST(Kbmpp, SweepKeepsItsStateInACompleteTable) {
  test_sweep(make_test_table(make_test_map(70, 40), 0.1), 0);
}
TEST(Kbmpp, SweepKeepsItsStateInATableWithHoles) {
  test_sweep(make_holes(make_test_table(make_test_map(40, 36), 0.1)), 1);
}

// The change that a candidate is judged by is the change of the energy.
TEST(Kbmpp, OneCopyChangesTheEnergyAsItWasJudged) {
  TableHeader header = make_test_table(make_test_map()).header;
  header.width = 1;
  header.height = 2;
  header.offsets = {{0, 0}, {0, 1}};
  BssrdfTable table = make_bssrdf_table(header);
  for (std::size_t i = 0; i < table.reflectance.size(); ++i)
    if (i % 4 != 3) table.reflectance[i] = 0.1f / static_cast<float>(1 + i % 5);
  const KbmppParams params = small_params(2);
  const kbmpp::Pairs pairs = kbmpp::make_pairs(table, uneven_knots);
  int lowered = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    KbmppParams seeded = params;
    seeded.seed = seed;
    kbmpp::Solver solver = kbmpp::make_solver(pairs, seeded);
    const double before = kbmpp::eval_energy(pairs, solver.model, solver.work);
    // Only the lower pixel has a neighbour above; it copies if that is an improvement.
    kbmpp::Model copied = solver.model;
    for (std::size_t k = 0; k < 2; ++k) copied.index[2 + k] = copied.index[k];
    kbmpp::Workspace work;
    const double after = kbmpp::eval_energy(pairs, copied, work);
    const auto mask = kbmpp::make_pair_mask(pairs);
    const auto count = kbmpp::sweep(pairs, mask, {0, 1, 0, 1}, solver.model, solver.work);
    EXPECT_EQ(count, after < before ? 1u : 0u) << before << " " << after;
    lowered += after < before ? 1 : 0;
  }
  EXPECT_GT(lowered, 5);
  EXPECT_LT(lowered, 35);
}

TEST(Kbmpp, SameBitsForAnyNumberOfThreads) {
  const BssrdfTable table = make_test_table(make_test_map(70, 40), 0.1);
  std::vector<ProfileBlend> blends;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    blends.push_back(run_kbmpp(table, uneven_knots, small_params(2)));
  }
  EXPECT_EQ(blends[0].base_log_profile, blends[1].base_log_profile);
  EXPECT_EQ(blends[0].index, blends[1].index);
  EXPECT_EQ(blends[0].weight, blends[1].weight);
}

TEST(Kbmpp, WrongParametersAreNamed) {
  KbmppParams params;
  params.per_pixel = 9;
  EXPECT_EQ(error_of([&] { check(params); }), "per_pixel: expected a value in [1, 8], found 9");
  params.per_pixel = 3;
  params.bases = 2;
  EXPECT_EQ(error_of([&] { check(params); }),
            "bases: expected a value in [per_pixel, 65535], found 2");
}

}  // namespace
}  // namespace parian

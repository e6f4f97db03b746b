// Conjugate gradients on the neighbour graph, preconditioned by the diagonal plus an exact solve
// for what is constant on each group of like pixels (two-level additive Schwarz).
#include "edit/propagate.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "edit/propagate_kernels.h"
#include "edit/stroke_reach.h"
#include "math/fast_math.h"

namespace parian {
namespace {

constexpr std::size_t row_block = 1024;
using Lanes = std::array<double, lanes>;

struct System {
  const NeighbourGraph& graph;
  std::vector<float> weight;    // lambda a_ij, of each edge
  std::vector<float> diagonal;  // of each node
  std::vector<float> inverse;   // 1 / diagonal
  std::vector<float> right;     // [stroke][pixel]
  Eigen::MatrixXd coarse;       // inverse of the matrix between groups

  GraphMatrix matrix() const {
    return {graph.first.data(), graph.to.data(), weight.data(), diagonal.data()};
  }
};

// Edges' weights; their sums on the diagonal.
void add_edges(System& system, const PropagateParams& params) {
  const NeighbourGraph& graph = system.graph;
  const double lambda = params.strength * default_smoothness / graph.neighbours;
  const float near = static_cast<float>(lambda),
              beside = static_cast<float>(lambda * spatial_factor);
  const float inverse = static_cast<float>(-1 / params.sigma);
  system.weight.resize(graph.to.size());
  parallel_for_blocks(graph.pixels(), row_block, [&](std::size_t begin, std::size_t end) {
    const std::size_t first = graph.first[begin], last = graph.first[end];
    for (std::size_t e = first; e < last; ++e)
      system.weight[e] = std::max(graph.distance2[e] * inverse, -100.0F);
    exp_array(system.weight.data() + first, system.weight.data() + first, last - first);
    for (std::size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
        system.weight[e] *= graph.spatial[e] != 0 ? beside : near;
        sum += static_cast<double>(system.weight[e]);
      }
      system.diagonal[i] += static_cast<float>(sum);
    }
  });
}

// Strokes, their reach, the rest of the image and the prior: all that pulls a pixel to a value.
void add_pulls(System& system, const Features& features, const std::vector<StrokePixel>& pixels,
               std::size_t strokes, const PropagateParams& params) {
  const std::size_t n = features.pixels();
  const std::vector<std::uint32_t>& node = system.graph.node;
  system.diagonal.assign(n, static_cast<float>(params.prior));
  system.right.assign(strokes * n, 0.0F);
  if (params.direct > 0) {
    const float direct = static_cast<float>(params.direct);
    const StrokeReach reach = sample_strokes(features, pixels, static_cast<int>(strokes));
    parallel_for_blocks(n, row_block, [&](std::size_t begin, std::size_t end) {
      std::vector<float> z(end - begin), largest(end - begin, 0.0F);
      for (std::size_t s = 0; s < strokes; ++s) {
        measure_reach(reach, features, s, params.sigma, begin, end, z.data());
        for (std::size_t i = begin; i < end; ++i) {
          system.right[s * n + i] = direct * z[i - begin];
          system.diagonal[node[i]] += direct * z[i - begin];
          largest[i - begin] = std::max(largest[i - begin], z[i - begin]);
        }
      }
      if (params.rest)
        for (std::size_t i = begin; i < end; ++i)
          system.diagonal[node[i]] += direct * (1 - largest[i - begin]);
    });
  }
  for (const StrokePixel& p : pixels) {
    system.diagonal[node[p.pixel]] += p.weight;
    system.right[static_cast<std::size_t>(p.stroke) * n + p.pixel] += p.weight;
  }
}

// The matrix between groups: P^T M P with P the indicator of each group.
void factor_coarse(System& system) {
  const NeighbourGraph& graph = system.graph;
  const std::size_t groups = graph.groups();
  std::vector<std::uint32_t> group_of(graph.pixels());
  for (std::size_t g = 0; g < groups; ++g)
    std::fill(group_of.begin() + static_cast<std::ptrdiff_t>(graph.group_first[g]),
              group_of.begin() + static_cast<std::ptrdiff_t>(graph.group_first[g + 1]),
              static_cast<std::uint32_t>(g));
  Eigen::MatrixXd between(groups, groups);
  between.setZero();
  parallel_for(groups, [&](std::size_t g) {
    double* column = &between(0, static_cast<Eigen::Index>(g));
    for (std::size_t i = graph.group_first[g]; i < graph.group_first[g + 1]; ++i) {
      column[g] += static_cast<double>(system.diagonal[i]);
      for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
        column[group_of[graph.to[e]]] -= static_cast<double>(system.weight[e]);
    }
  });
  const Eigen::LLT<Eigen::MatrixXd> factor(between);
  system.coarse = Eigen::MatrixXd::Identity(between.rows(), between.cols());
  factor.solveInPlace(system.coarse);
  system.inverse.resize(system.diagonal.size());
  for (std::size_t i = 0; i < system.inverse.size(); ++i)
    system.inverse[i] = 1 / system.diagonal[i];
}

// Conjugate gradients for up to four strokes at once, each with its own step lengths.
struct Solver {
  const System& system;
  std::vector<float> x, r, p, q;             // [node][lane]
  std::vector<Lanes> squares, scaled, sums;  // of each group
  std::vector<float> correction;             // of each group and lane
  Lanes rz{}, rr{};
  std::array<float, lanes> alpha{}, beta{};
};

void step(Solver& s) {
  const NeighbourGraph& graph = s.system.graph;
  const std::size_t groups = graph.groups();
  parallel_for_blocks(groups, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      step_rows(s.system.inverse.data(), s.alpha.data(), s.p.data(), s.q.data(), s.x.data(),
                s.r.data(), graph.group_first[g], graph.group_first[g + 1], s.squares[g].data(),
                s.scaled[g].data(), s.sums[g].data());
  });
  using Sums = Eigen::Matrix<double, Eigen::Dynamic, lanes, Eigen::RowMajor>;
  const Eigen::Map<const Sums> sums(s.sums[0].data(), static_cast<Eigen::Index>(groups), lanes);
  const Sums solved = s.system.coarse * sums;
  s.rr = {};
  for (std::size_t l = 0; l < lanes; ++l) {
    double rz =
        sums.col(static_cast<Eigen::Index>(l)).dot(solved.col(static_cast<Eigen::Index>(l)));
    for (std::size_t g = 0; g < groups; ++g) {
      s.rr[l] += s.squares[g][l];
      rz += s.scaled[g][l];
      s.correction[g * lanes + l] =
          static_cast<float>(solved(static_cast<Eigen::Index>(g), static_cast<Eigen::Index>(l)));
    }
    s.beta[l] = s.rz[l] > 0 ? static_cast<float>(rz / s.rz[l]) : 0.0F;
    s.rz[l] = rz;
  }
  parallel_for_blocks(groups, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      turn_rows(s.system.inverse.data(), &s.correction[g * lanes], s.beta.data(), s.r.data(),
                s.p.data(), graph.group_first[g], graph.group_first[g + 1]);
  });
}

// q = M p and the step lengths
void multiply(Solver& s) {
  const std::size_t pixels = s.system.graph.pixels();
  std::vector<Lanes> part((pixels + row_block - 1) / row_block);
  parallel_for_blocks(pixels, row_block, [&](std::size_t begin, std::size_t end) {
    multiply_rows(s.system.matrix(), s.p.data(), s.q.data(), begin, end,
                  part[begin / row_block].data());
  });
  for (std::size_t l = 0; l < lanes; ++l) {
    double curvature = 0;
    for (const Lanes& sum : part) curvature += sum[l];
    s.alpha[l] = curvature > 0 ? static_cast<float>(s.rz[l] / curvature) : 0.0F;
  }
}

void solve_lanes(const System& system, std::size_t first_stroke, std::size_t count,
                 const PropagateParams& params, Propagation& out) {
  const std::size_t pixels = system.graph.pixels(), groups = system.graph.groups();
  const std::vector<float> zero(pixels * lanes, 0.0F);
  Solver s{.system = system, .x = zero, .r = zero, .p = zero, .q = zero};
  s.squares.resize(groups);
  s.scaled.resize(groups);
  s.sums.resize(groups);
  s.correction.resize(groups * lanes);
  for (std::size_t l = 0; l < count; ++l)
    for (std::size_t i = 0; i < pixels; ++i)
      s.r[i * lanes + l] = system.right[(first_stroke + l) * pixels + system.graph.pixel[i]];
  step(s);
  const Lanes start = s.rr;
  const auto residual = [&] {
    double worst = 0;
    for (std::size_t l = 0; l < lanes; ++l)
      if (start[l] > 0) worst = std::max(worst, std::sqrt(s.rr[l] / start[l]));
    return worst;
  };
  int iterations = 0;
  for (; iterations < params.max_iterations && residual() > params.tolerance; ++iterations) {
    multiply(s);
    step(s);
  }
  out.iterations = std::max(out.iterations, iterations);
  out.residual = std::max(out.residual, residual());
  for (std::size_t l = 0; l < count; ++l)
    for (std::size_t i = 0; i < pixels; ++i)
      out.indicators[(first_stroke + l) * pixels + system.graph.pixel[i]] = s.x[i * lanes + l];
}

}  // namespace

Param appearance_sigma_param(double& sigma) {
  return {.name = "sigma",
          .help =
              "squared distance of appearance at which similarity falls to 1/e; 1 is the mean "
              "over random pairs",
          .target = &sigma,
          .min = 1e-6,
          .max = 1e6,
          .symbol = "sigma_a"};
}

ParamList describe(PropagateParams& params) {
  return {
      appearance_sigma_param(params.sigma),
      {.name = "strength",
       .help = "smoothness along the graph, relative to its default",
       .target = &params.strength,
       .min = 0,
       .max = 1000,
       .symbol = "lambda"},
      {.name = "direct",
       .help = "weight of the similarity between a pixel and the strokes themselves; 0 leaves the "
               "edges alone to carry them",
       .target = &params.direct,
       .min = 0,
       .max = 1000},
      {.name = "prior",
       .help = "weight that pulls pixels no stroke reaches to 0",
       .target = &params.prior,
       .min = 1e-8,
       .max = 1000,
       .symbol = "w_0"},
      {.name = "tolerance",
       .help = "relative residual at which the solver stops",
       .target = &params.tolerance,
       .min = 1e-7,
       .max = 1},
      {.name = "max-iterations",
       .help = "limit of conjugate-gradient iterations",
       .target = &params.max_iterations,
       .min = 0,
       .max = 100'000},
  };
}

Propagation propagate(const NeighbourGraph& graph, const Features& features,
                      const std::vector<StrokePixel>& pixels, int strokes,
                      const PropagateParams& params) {
  PropagateParams checked = params;
  check(describe(checked));
  check_strokes(features, pixels, strokes);
  if (graph.width != features.width || graph.height != features.height)
    throw Error({.place = "neighbour graph",
                 .expected = fmt::format("{} x {} pixels as the features have", features.width,
                                         features.height),
                 .found = fmt::format("{} x {}", graph.width, graph.height)});
  const auto count = static_cast<std::size_t>(strokes);
  System system{.graph = graph};
  add_pulls(system, features, pixels, count, params);
  add_edges(system, params);
  factor_coarse(system);
  Propagation out{.width = graph.width, .height = graph.height, .strokes = strokes};
  out.indicators.resize(count * graph.pixels());
  for (std::size_t s = 0; s < count; s += lanes)
    solve_lanes(system, s, std::min(lanes, count - s), params, out);
  clamp_indicators(out);
  return out;
}

}  // namespace parian

#include "compress/log_objective.h"

#include <algorithm>
#include <memory>

#include "base/check.h"
#include "base/parallel.h"
#include "fit/hessian.h"

namespace parian {
namespace {

struct LogProblem {
  std::vector<ReducedSystem> systems;
  std::vector<std::shared_ptr<const Hessian>> hessians;  // equal weights share one
};

// D = 2 blockdiag(H): (u + v)^2 <= 2 u^2 + 2 v^2 for both ends of every pair.
LocalMetric make_metric(const RowShape& shape, const LogProblem& problem) {
  std::vector<float> diagonal(shape.channels * shape.knots * shape.pixels, 0.0f);
  std::vector<float> coupling = diagonal;
  for (std::size_t c = 0; c < shape.channels; ++c) {
    const Hessian& hessian = *problem.hessians[c];
    const auto width = static_cast<std::size_t>(problem.systems[c].width);
    for (std::size_t k = 0; k < shape.knots; ++k)
      for (std::size_t i = 0; i < shape.pixels; ++i) {
        const std::size_t from =
            (k * hessian.block_rows + hessian.block_row[i / width]) * width + i % width;
        const std::size_t to = (c * shape.knots + k) * shape.pixels + i;
        diagonal[to] = static_cast<float>(2 * hessian.diagonal[from]);
        if (k + 1 < shape.knots) coupling[to] = static_cast<float>(2 * hessian.coupling[from]);
      }
  }
  return {shape, make_rows(shape, diagonal.data()), make_rows(shape, coupling.data())};
}

// 1/2 p^T H p - b^T p + c and its gradient H p - b.
double eval_channel(const ReducedSystem& system, const Hessian& hessian, const float* field,
                    float* gradient) {
  const std::size_t count = system.unknowns();
  std::vector<double> p(field, field + count), product(count);
  HessianWorkspace workspace;
  apply_hessian(system, hessian, p.data(), product.data(), workspace);
  const std::vector<double>& b = system.right_hand_side;
  constexpr std::size_t block = 1u << 14u;
  const double value = parallel_sum(count, block, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      sum += p[i] * (0.5 * product[i] - b[i]);
      if (gradient != nullptr) gradient[i] = static_cast<float>(product[i] - b[i]);
    }
    return sum;
  });
  return value + system.constant;
}

}  // namespace

BlendObjective make_log_objective(std::vector<ReducedSystem> systems) {
  PARIAN_CHECK(!systems.empty());
  const auto problem = std::make_shared<LogProblem>();
  problem->systems = std::move(systems);
  for (const ReducedSystem& system : problem->systems) {
    const bool shared = !problem->hessians.empty() && shares_hessian(system, problem->systems[0]);
    problem->hessians.push_back(
        shared ? problem->hessians[0]
               : std::make_shared<const Hessian>(make_hessian(system, ProductMethod::automatic)));
  }
  BlendObjective objective;
  const ReducedSystem& first = problem->systems[0];
  objective.shape = {first.pixels(), problem->systems.size(), first.knots()};
  objective.metric = make_metric(objective.shape, *problem);
  objective.curvature_weight = paper_curvature_weight;
  objective.eval = [problem](const float* field, float* gradient, PixelErrors*) {
    double value = 0;
    for (std::size_t c = 0; c < problem->systems.size(); ++c) {
      const std::size_t offset = c * problem->systems[c].unknowns();
      value += eval_channel(problem->systems[c], *problem->hessians[c], field + offset,
                            gradient == nullptr ? nullptr : gradient + offset);
    }
    return value;
  };
  return objective;
}

}  // namespace parian

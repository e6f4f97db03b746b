// The 2019 paper's energy (Eq. 5 and 6 without barriers) through the reduced system:
//
//   F(p) = 1/2 sum over ordered pairs phi(r) [ln P_x(r) + ln P_y(r) - 2 ln R_xy]^2
//
// plus 1/2 lambda_reg sum of squared second differences of the base profiles, which is
// curvature_weight's.
#pragma once

#include <vector>

#include "compress/local_model.h"
#include "fit/reduced_system.h"

namespace parian {

// lambda_reg of the paper
inline constexpr double paper_curvature_weight = 1e-3;

// One system per channel, with lambda = 0, over the same grid and knots.
BlendObjective make_log_objective(std::vector<ReducedSystem> systems);

}  // namespace parian

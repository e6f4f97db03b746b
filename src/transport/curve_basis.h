// The bases in which R_d and the attenuation E are edited (Xu et al. 2007, section 5): knots that
// suit a whole range of coefficients, and projections whose equations are factored once.
//
// `published` takes the paper's choice: knots for the mean of three curves by a plain sum of
// squares, ten places in each interval, all with the same weight. That mean is almost the steepest
// curve alone. `balanced` (the default) divides each curve by its integral and weights errors by dA
// / curve, dA = r dr for R_d and ds for E: by Cauchy and Schwarz
//
//   (int |f - f'| dA)^2 <= int (f - f')^2 / f dA  int f dA,
//
// so the sum bounds what an error does to radiance, for steep and flat curves alike.
#pragma once

#include "base/params.h"
#include "math/spline_basis.h"

namespace parian {

enum class KnotChoice { balanced, published };

struct CurveBasisParams {
  int intervals = 16;
  int degree = 1;  // 1: hats, 2: quadratic B-splines
  KnotChoice knots = KnotChoice::balanced;
};
ParamList describe(CurveBasisParams& params);

// For R_d(r), r from 0 to reach_mm, of classic dipoles with sigma_s from 0.2 to 10 / mm.
SplineBasis make_reflectance_basis(double reach_mm, double eta,
                                   const CurveBasisParams& params = {});
// For E(s) = exp(-sigma_t s), s from 0 to reach_mm.
SplineBasis make_attenuation_basis(double reach_mm, const CurveBasisParams& params = {});

// Least squares weighted by r dr, or by ds; the published choice takes no weights.
SplineProjection make_reflectance_projection(const SplineBasis& basis, KnotChoice knots);
SplineProjection make_attenuation_projection(const SplineBasis& basis, KnotChoice knots);

}  // namespace parian

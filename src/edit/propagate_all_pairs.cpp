// Nystrom approximation and the Woodbury identity:
//   (D - 2 lambda U A^-1 U^T)^-1 = D^-1 + D^-1 U (A / (2 lambda) - U^T D^-1 U)^-1 U^T D^-1
#include "edit/propagate_all_pairs.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "edit/stroke_reach.h"

namespace parian {
namespace {

constexpr std::size_t block_size = 512;
constexpr std::size_t groups = 16;  // partial sums, added in order
constexpr double ridge = 1e-8;
// Pixels whose D is below this part of the mean are reached by nothing.
constexpr double smallest_diagonal = 1e-9;

using Matrix = Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Coordinates whose squared distance is the exponent of z, [pixel][dim].
RowMajor scaled_points(const Features& features, const AllPairsParams& params) {
  const auto pixels = static_cast<Eigen::Index>(features.pixels());
  const bool space = params.sigma_space > 0;
  RowMajor points(pixels, features.dims + (space ? 2 : 0));
  const double diagonal = std::hypot(features.width, features.height);
  for (Eigen::Index i = 0; i < pixels; ++i) {
    for (Eigen::Index d = 0; d < features.dims; ++d)
      points(i, d) =
          static_cast<double>(features.values[static_cast<std::size_t>(i * features.dims + d)]) /
          std::sqrt(params.sigma);
    if (!space) continue;
    const Eigen::Index row = i / features.width;
    points(i, features.dims) =
        static_cast<double>(i % features.width) / (params.sigma_space * diagonal);
    points(i, features.dims + 1) = static_cast<double>(row) / (params.sigma_space * diagonal);
  }
  return points;
}

// m different pixels, the first of a seeded shuffle.
std::vector<Eigen::Index> sample_columns(std::size_t pixels, const AllPairsParams& params) {
  std::vector<Eigen::Index> all(pixels);
  for (std::size_t i = 0; i < pixels; ++i) all[i] = static_cast<Eigen::Index>(i);
  const std::size_t m = std::min(static_cast<std::size_t>(params.columns), pixels);
  for (std::size_t i = 0; i < m; ++i)
    std::swap(all[i], all[i + hash_u64(params.seed, i) % (pixels - i)]);
  all.resize(m);
  return all;
}

// exp(-|a_i - b_j|^2); distances by |a|^2 + |b|^2 - 2 a.b would lose what is small.
Matrix similarities(const RowMajor& points, Eigen::Index begin, Eigen::Index end,
                    const RowMajor& columns) {
  Matrix z(end - begin, columns.rows());
  for (Eigen::Index j = 0; j < columns.rows(); ++j)
    z.col(j) =
        (points.middleRows(begin, end - begin).rowwise() - columns.row(j)).rowwise().squaredNorm();
  return (-z.array()).exp().matrix();
}

// Sum of body(begin, end) over blocks of pixels: the same bits for any number of threads.
template <typename Body>
Matrix sum_blocks(std::size_t pixels, Eigen::Index rows, Eigen::Index columns, const Body& body) {
  std::vector<Matrix> part(groups, Matrix::Zero(rows, columns));
  parallel_for(groups, [&](std::size_t group) {
    for (std::size_t b = group * block_size; b < pixels; b += groups * block_size)
      body(static_cast<Eigen::Index>(b),
           static_cast<Eigen::Index>(std::min(pixels, b + block_size)), part[group]);
  });
  for (std::size_t group = 1; group < groups; ++group) part[0] += part[group];
  return part[0];
}

struct LowRank {
  RowMajor u;  // [pixel][column]
  Matrix a;
  Eigen::LLT<Matrix> factor;

  // U^T x
  Matrix restrict_to_columns(const Matrix& x) const {
    return sum_blocks(static_cast<std::size_t>(u.rows()), u.cols(), x.cols(),
                      [&](Eigen::Index begin, Eigen::Index end, Matrix& sum) {
                        sum.noalias() += u.middleRows(begin, end - begin).transpose() *
                                         x.middleRows(begin, end - begin);
                      });
  }
  // U y
  Matrix extend(const Matrix& y) const {
    Matrix out(u.rows(), y.cols());
    parallel_for_blocks(static_cast<std::size_t>(u.rows()), block_size,
                        [&](std::size_t begin, std::size_t end) {
                          const auto first = static_cast<Eigen::Index>(begin);
                          const auto count = static_cast<Eigen::Index>(end - begin);
                          out.middleRows(first, count).noalias() = u.middleRows(first, count) * y;
                        });
    return out;
  }
  // Z x
  Matrix multiply(const Matrix& x) const { return extend(factor.solve(restrict_to_columns(x))); }
};

LowRank make_low_rank(const Features& features, const AllPairsParams& params) {
  const RowMajor points = scaled_points(features, params);
  const std::vector<Eigen::Index> chosen = sample_columns(features.pixels(), params);
  const auto m = static_cast<Eigen::Index>(chosen.size());
  RowMajor columns(m, points.cols());
  for (Eigen::Index j = 0; j < m; ++j)
    columns.row(j) = points.row(chosen[static_cast<std::size_t>(j)]);
  LowRank z;
  z.a = similarities(columns, 0, m, columns);
  z.a.diagonal().array() += ridge;  // the mean of A's diagonal is 1
  z.factor.compute(z.a);
  z.u.resize(points.rows(), m);
  parallel_for_blocks(features.pixels(), block_size, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Eigen::Index>(begin), last = static_cast<Eigen::Index>(end);
    z.u.middleRows(first, last - first) = similarities(points, first, last, columns);
  });
  return z;
}

// U^T D^-1 U, with D^-1 = 0 where nothing reaches.
Matrix weighted_gram(const LowRank& z, const Eigen::VectorXd& inverse) {
  Matrix gram = sum_blocks(static_cast<std::size_t>(z.u.rows()), z.u.cols(), z.u.cols(),
                           [&](Eigen::Index begin, Eigen::Index end, Matrix& sum) {
                             const Matrix half =
                                 inverse.segment(begin, end - begin).cwiseSqrt().asDiagonal() *
                                 z.u.middleRows(begin, end - begin);
                             sum.selfadjointView<Eigen::Lower>().rankUpdate(half.transpose());
                           });
  return gram.selfadjointView<Eigen::Lower>();
}

}  // namespace

ParamList describe(AllPairsParams& params) {
  return {
      {.name = "columns",
       .help = "random pixels whose similarities to all others are computed",
       .target = &params.columns,
       .min = 1,
       .max = 2000,
       .symbol = "m"},
      appearance_sigma_param(params.sigma),
      {.name = "sigma-space",
       .help = "distance in the image at which similarity falls to 1/e, relative to the diagonal; "
               "0: no limit",
       .target = &params.sigma_space,
       .min = 0,
       .max = 1000,
       .symbol = "sigma_s"},
      {.name = "lambda",
       .help = "smoothness; 0 takes the strokes' total weight per pixel",
       .target = &params.lambda,
       .min = 0,
       .max = 1e6,
       .symbol = "lambda"},
      {.name = "seed", .help = "which pixels are the columns", .target = &params.seed},
  };
}

Propagation propagate_all_pairs(const Features& features, const std::vector<StrokePixel>& pixels,
                                int strokes, const AllPairsParams& params) {
  AllPairsParams checked = params;
  check(describe(checked));
  check_strokes(features, pixels, strokes);
  const auto n = static_cast<Eigen::Index>(features.pixels());
  const LowRank z = make_low_rank(features, params);
  // Columns: w on each stroke, then 1.
  Matrix source = Matrix::Zero(n, strokes + 1);
  for (const StrokePixel& p : pixels) source(p.pixel, p.stroke) += static_cast<double>(p.weight);
  source.col(strokes).setOnes();
  const double total = source.leftCols(strokes).sum();
  const double lambda = params.lambda > 0 ? params.lambda : total / static_cast<double>(n);
  const Matrix product = z.multiply(source);
  const Matrix right = product.leftCols(strokes);
  const Eigen::VectorXd diagonal = right.rowwise().sum() + 2 * lambda * product.col(strokes);
  const double least = smallest_diagonal * diagonal.cwiseAbs().mean();
  const Eigen::VectorXd inverse =
      (diagonal.array() > least).select(diagonal.array().inverse(), 0).matrix();
  const Matrix small = z.a / (2 * lambda) - weighted_gram(z, inverse);
  const Eigen::PartialPivLU<Matrix> factor(small);
  const auto apply_inverse = [&](const Matrix& b) {
    const Matrix scaled = inverse.asDiagonal() * b;
    return Matrix(scaled +
                  inverse.asDiagonal() * z.extend(factor.solve(z.restrict_to_columns(scaled))));
  };
  const auto residual_of = [&](const Matrix& e) {  // 0 where nothing reaches
    const Matrix r = right - diagonal.asDiagonal() * e + 2 * lambda * z.multiply(e);
    return Matrix((inverse.array() > 0).select(Eigen::ArrayXd::Ones(n), 0).matrix().asDiagonal() *
                  r);
  };
  Matrix e = apply_inverse(right);
  e += apply_inverse(residual_of(e));  // one step of refinement: A is nearly singular
  Propagation out{.width = features.width, .height = features.height, .strokes = strokes};
  out.residual = residual_of(e).norm() / right.norm();
  const Eigen::MatrixXf values = e.cast<float>();
  out.indicators.assign(values.data(), values.data() + values.size());
  clamp_indicators(out);
  return out;
}

}  // namespace parian

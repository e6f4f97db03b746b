#include "edit/poisson_multigrid.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace parian {
namespace {

constexpr int coarsest_cells = 64;

// Calls body(first row, end row) with enough rows each to be worth a task.
void over_rows(const GridShape& shape, const std::function<void(int, int)>& body) {
  const int block = std::max(1, 12288 / (shape.planes * shape.count()));
  parallel_for_blocks(static_cast<std::size_t>(shape.height), static_cast<std::size_t>(block),
                      [&](std::size_t begin, std::size_t end) {
                        body(static_cast<int>(begin), static_cast<int>(end));
                      });
}

StencilRows stencil_rows(const MultigridLevel& level, int y) {
  const std::size_t at = level.shape.row(y), above = level.shape.row(y - 1);
  return {level.self.data() + at,          level.right.data() + at,       level.down.data() + at,
          level.down_right.data() + at,    level.down_left.data() + at,   level.down.data() + above,
          level.down_right.data() + above, level.down_left.data() + above};
}

// out = keep x + omega scale (b - A x)
void sweep(const MultigridLevel& level, int planes, const std::vector<float>& scale,
           const std::vector<float>& b, const std::vector<float>& x, float omega, float keep,
           std::vector<float>& out) {
  const GridShape one = level.shape, all = one.with(planes);
  const int count = one.count();
  over_rows(all, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const std::size_t at = one.row(y);
      for (int p = 0; p < planes; ++p) {
        const float *x0 = x.data() + all.row(y, p), *up = x.data() + all.row(y - 1, p),
                    *down = x.data() + all.row(y + 1, p), *b0 = b.data() + all.row(y, p);
        float* out0 = out.data() + all.row(y, p);
        if (level.down_right.empty())
          sweep_laplacian(level.self.data() + at, scale.data() + at, b0, x0, up, down, omega, keep,
                          count, out0);
        else
          sweep_stencil(stencil_rows(level, y), scale.data() + at, b0, x0, up, down, omega, keep,
                        count, out0);
      }
    }
  });
}

// coarse = Pᵀ fine, where fine already carries the weights of P's rows.
void restrict_to(const MultigridLevel& from, const MultigridLevel& to, int planes,
                 const std::vector<float>& fine, std::vector<float>& coarse) {
  const GridShape f = from.shape.with(planes), c = to.shape.with(planes);
  over_rows(c, [&](int begin, int end) {
    std::vector<float> work(static_cast<std::size_t>(f.count()) + 2 * row_align);
    for (int y = begin; y < end; ++y) {
      const float next_weight = 2 * y + 2 == f.height ? 1.0f : 0.5f;
      for (int p = 0; p < planes; ++p)
        restrict_rows(fine.data() + f.row(2 * y - 1, p), fine.data() + f.row(2 * y, p),
                      fine.data() + f.row(2 * y + 1, p), next_weight,
                      to.mask.data() + to.shape.row(y), f.width, c.width, work.data(),
                      coarse.data() + c.row(y, p));
    }
  });
}

// fine += P coarse
void prolong_to(const MultigridLevel& from, const MultigridLevel& to, int planes,
                const std::vector<float>& coarse, std::vector<float>& fine) {
  const GridShape c = from.shape.with(planes), f = to.shape.with(planes);
  over_rows(f, [&](int begin, int end) {
    std::vector<float> work(static_cast<std::size_t>(c.width) + 1);
    for (int y = begin; y < end; ++y) {
      const int a = y / 2, b = std::min((y + 1) / 2, c.height - 1);
      for (int p = 0; p < planes; ++p)
        prolong_row(coarse.data() + c.row(a, p), coarse.data() + c.row(b, p),
                    to.weight.data() + to.shape.row(y), f.width, c.width, work.data(),
                    fine.data() + f.row(y, p));
    }
  });
}

// Sums of the couplings of a pixel to the column on its left and to the row above.
float couple_column(const MultigridLevel& level, std::size_t i, std::size_t step) {
  float sum = level.right[i - 1];
  if (!level.down_right.empty()) sum += level.down_right[i - step - 1] + level.down_left[i];
  return sum;
}
float couple_row(const MultigridLevel& level, std::size_t i, std::size_t step) {
  float sum = level.down[i - step];
  if (!level.down_right.empty())
    sum += level.down_right[i - step - 1] + level.down_left[i - step + 1];
  return sum;
}

// Weights of the rows of the prolongation: 1, but less for a last column or row that has no coarse
// pixel beyond it and is held near 0 by pixels outside the region just behind it: there the value
// that the couplings across, lumped, give (operator-dependent interpolation).
void weigh_border(MultigridLevel& level) {
  level.weight = level.mask;
  const GridShape shape = level.shape;
  const std::size_t step = shape.row(1) - shape.row(0);
  const auto ratio = [](float across, float own) {
    return own > 0 ? std::clamp(-across / own, 0.0f, 1.0f) : 1.0f;
  };
  if (shape.width % 2 == 0)
    for (int y = 0; y < shape.height; ++y) {
      const std::size_t i = shape.row(y) + static_cast<std::size_t>(shape.width) - 1;
      level.weight[i] *= ratio(couple_column(level, i, step),
                               level.self[i] + (level.down[i] + level.down[i - step]));
    }
  if (shape.height % 2 == 0)
    for (int x = 0; x < shape.width; ++x) {
      const std::size_t i = shape.row(shape.height - 1) + static_cast<std::size_t>(x);
      level.weight[i] *=
          ratio(couple_row(level, i, step), level.self[i] + (level.right[i] + level.right[i - 1]));
    }
}

// Inverse diagonal, and the two steps whose product is smallest on the upper 3/4 of the spectrum
// of D⁻¹A: the roots of the Chebyshev polynomial there. The bound is Gershgorin's.
void finish_level(MultigridLevel& level) {
  const GridShape shape = level.shape;
  const std::size_t step = shape.row(1) - shape.row(0);
  level.inverse.assign(shape.size(), 0.0f);
  double bound = 1;
  for (int y = 0; y < shape.height; ++y)
    for (std::size_t i = shape.row(y), end = i + static_cast<std::size_t>(shape.width); i < end;
         ++i) {
      if (!(level.self[i] > 0)) continue;
      level.inverse[i] = 1 / level.self[i];
      float sum = std::abs(level.right[i]) + std::abs(level.right[i - 1]) +
                  std::abs(level.down[i]) + std::abs(level.down[i - step]);
      if (!level.down_right.empty())
        sum += std::abs(level.down_right[i]) + std::abs(level.down_right[i - step - 1]) +
               std::abs(level.down_left[i]) + std::abs(level.down_left[i - step + 1]);
      bound = std::max(bound, 1 + static_cast<double>(sum * level.inverse[i]));
    }
  weigh_border(level);
  const double high = bound, low = 0.25 * bound;
  const double middle = 0.5 * (high + low), half = 0.5 * (high - low) * std::sqrt(0.5);
  level.omega = {static_cast<float>(1 / (middle + half)), static_cast<float>(1 / (middle - half))};
}

MultigridLevel make_finest(int width, int height, const std::vector<std::uint8_t>& region) {
  MultigridLevel level;
  level.shape = {width, height, 1};
  for (auto* a : {&level.mask, &level.self, &level.right, &level.down})
    a->assign(level.shape.size(), 0.0f);
  const auto inside = [&](int x, int y) {
    return x < width && y < height &&
           region[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)] != 0;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!inside(x, y)) continue;
      const std::size_t i = level.shape.row(y) + static_cast<std::size_t>(x);
      level.mask[i] = 1;
      level.self[i] = static_cast<float>((x > 0) + (x + 1 < width) + (y > 0) + (y + 1 < height));
      level.right[i] = inside(x + 1, y) ? -1.0f : 0.0f;
      level.down[i] = inside(x, y + 1) ? -1.0f : 0.0f;
    }
  finish_level(level);
  return level;
}

// A coarse pixel is active where its fine pixel is: the borders of the region stay in place, and
// parts thinner than the coarse grid, well conditioned by their borders, are left to the smoother.
MultigridLevel make_coarse_mask(const MultigridLevel& fine) {
  MultigridLevel level;
  level.shape = {(fine.shape.width + 1) / 2, (fine.shape.height + 1) / 2, 1};
  level.mask.assign(level.shape.size(), 0.0f);
  for (int y = 0; y < level.shape.height; ++y)
    for (int x = 0; x < level.shape.width; ++x)
      level.mask[level.shape.row(y) + static_cast<std::size_t>(x)] =
          fine.mask[fine.shape.row(2 * y) + static_cast<std::size_t>(2 * x)];
  return level;
}

// Reads the couplings of a level off the images of its nine probes.
void read_couplings(const std::vector<float>& images, MultigridLevel& level) {
  struct Coupling {
    std::vector<float>* values;
    int dx, dy;
  };
  const Coupling couplings[] = {{&level.self, 0, 0},
                                {&level.right, 1, 0},
                                {&level.down, 0, 1},
                                {&level.down_right, 1, 1},
                                {&level.down_left, -1, 1}};
  const GridShape one = level.shape, all = one.with(9);
  for (const Coupling& coupling : couplings) {
    coupling.values->assign(one.size(), 0.0f);
    for (int y = 0; y < one.height - coupling.dy; ++y)
      for (int x = std::max(0, -coupling.dx); x < one.width - std::max(0, coupling.dx); ++x) {
        const int to_x = x + coupling.dx, to_y = y + coupling.dy;
        if (level.mask[one.row(to_y) + static_cast<std::size_t>(to_x)] == 0) continue;
        (*coupling.values)[one.row(y) + static_cast<std::size_t>(x)] =
            images[all.row(y, to_y % 3 * 3 + to_x % 3) + static_cast<std::size_t>(x)];
      }
  }
}

// The diagonal of an operator that annihilates constants, from the couplings without rounding.
void balance_diagonal(MultigridLevel& level) {
  const GridShape one = level.shape;
  const std::size_t step = one.row(1) - one.row(0);
  for (int y = 0; y < one.height; ++y)
    for (std::size_t i = one.row(y), end = i + static_cast<std::size_t>(one.width); i < end; ++i)
      level.self[i] =
          -((level.right[i] + level.right[i - 1]) + (level.down[i] + level.down[i - step]) +
            (level.down_right[i] + level.down_right[i - step - 1]) +
            (level.down_left[i] + level.down_left[i - step + 1]));
}

// Galerkin operator PᵀAP, read off nine probes at once: a coarse pixel couples to its eight
// neighbours only, so pixels three apart in x and y share a probe.
MultigridLevel make_coarse(const MultigridLevel& fine, bool singular) {
  MultigridLevel level = make_coarse_mask(fine);
  const GridShape one = level.shape, all = one.with(9), f = fine.shape.with(9);
  std::vector<float> probes(all.size()), spread(f.size()), images(f.size());
  const std::vector<float> zero(f.size());
  for (int y = 0; y < one.height; ++y)
    for (int x = 0; x < one.width; ++x)
      probes[all.row(y, y % 3 * 3 + x % 3) + static_cast<std::size_t>(x)] =
          level.mask[one.row(y) + static_cast<std::size_t>(x)];
  prolong_to(level, fine, 9, probes, spread);
  sweep(fine, 9, fine.weight, zero, spread, -1, 0, images);
  restrict_to(fine, level, 9, images, probes);
  read_couplings(probes, level);
  if (singular) balance_diagonal(level);
  finish_level(level);
  return level;
}

// Dense inverse of the coarsest operator. Cells outside the region get a 1 on the diagonal; where
// constants are annihilated they are added as one more direction.
std::vector<float> invert_coarsest(const MultigridLevel& level, bool singular) {
  const int width = level.shape.width, n = width * level.shape.height;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (int y = 0; y < level.shape.height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = level.shape.row(y) + static_cast<std::size_t>(x);
      const int k = y * width + x;
      const auto couple = [&](const std::vector<float>& values, int to) {
        if (values.empty() || values[i] == 0) return;
        a(k, to) = a(to, k) = static_cast<double>(values[i]);
      };
      a(k, k) = level.mask[i] != 0 ? static_cast<double>(level.self[i]) : 1.0;
      couple(level.right, k + 1);
      couple(level.down, k + width);
      couple(level.down_right, k + width + 1);
      couple(level.down_left, k + width - 1);
    }
  if (singular) a.array() += 1.0 / n;
  const Eigen::MatrixXd inverse = a.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  std::vector<float> out(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      out[static_cast<std::size_t>(i * n + j)] =
          static_cast<float>(0.5 * (inverse(i, j) + inverse(j, i)));
  return out;
}

void solve_coarsest(Multigrid& grid) {
  MultigridLevel& level = grid.levels.back();
  const GridShape all = level.shape.with(grid.planes);
  const int width = all.width, n = width * all.height;
  for (int p = 0; p < grid.planes; ++p)
    for (int i = 0; i < n; ++i) {
      double sum = 0;
      const float* row =
          grid.coarse_inverse.data() + static_cast<std::size_t>(i) * static_cast<std::size_t>(n);
      for (int y = 0; y < all.height; ++y)
        for (int x = 0; x < width; ++x)
          sum += static_cast<double>(row[y * width + x]) *
                 static_cast<double>(level.b[all.row(y, p) + static_cast<std::size_t>(x)]);
      const std::size_t at = all.row(i / width, p) + static_cast<std::size_t>(i % width);
      level.x[at] = static_cast<float>(sum) *
                    level.mask[level.shape.row(i / width) + static_cast<std::size_t>(i % width)];
    }
}

void run_level(Multigrid& grid, std::size_t index) {
  MultigridLevel& level = grid.levels[index];
  const int planes = grid.planes;
  if (index + 1 == grid.levels.size()) return solve_coarsest(grid);
  MultigridLevel& coarse = grid.levels[index + 1];
  const GridShape all = level.shape.with(planes);
  over_rows(all, [&](int begin, int end) {  // the first step of the smoother, from 0
    for (int y = begin; y < end; ++y)
      for (int p = 0; p < planes; ++p)
        scale_row(level.inverse.data() + level.shape.row(y), level.b.data() + all.row(y, p),
                  level.omega[0], all.count(), level.work.data() + all.row(y, p));
  });
  sweep(level, planes, level.inverse, level.b, level.work, level.omega[1], 1, level.x);
  sweep(level, planes, level.weight, level.b, level.x, 1, 0, level.work);
  restrict_to(level, coarse, planes, level.work, coarse.b);
  run_level(grid, index + 1);
  prolong_to(coarse, level, planes, coarse.x, level.x);
  sweep(level, planes, level.inverse, level.b, level.x, level.omega[1], 1, level.work);
  sweep(level, planes, level.inverse, level.b, level.work, level.omega[0], 1, level.x);
}

}  // namespace

Multigrid make_multigrid(int width, int height, int planes,
                         const std::vector<std::uint8_t>& region) {
  Multigrid grid;
  grid.planes = planes;
  const bool singular = std::find(region.begin(), region.end(), 0) == region.end();
  grid.levels.push_back(make_finest(width, height, region));
  const auto cells = [&] {
    const GridShape& shape = grid.levels.back().shape;
    return static_cast<long long>(shape.width) * shape.height;
  };
  while (cells() > coarsest_cells) grid.levels.push_back(make_coarse(grid.levels.back(), singular));
  for (MultigridLevel& level : grid.levels)
    for (auto* values : {&level.b, &level.x, &level.work})
      values->assign(level.shape.with(planes).size(), 0.0f);
  grid.coarse_inverse = invert_coarsest(grid.levels.back(), singular);
  return grid;
}

void run_cycle(Multigrid& grid) {
  run_level(grid, 0);
}

}  // namespace parian

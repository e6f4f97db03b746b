#include "edit/poisson.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "edit/poisson_multigrid.h"

namespace parian {
namespace {

using Values = std::vector<double>;

struct Problem {
  int width, height, planes;
  const std::vector<std::uint8_t>& region;
  const Values &target, &gradient_x, &gradient_y;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t row(int plane, int y) const {
    return static_cast<std::size_t>(plane) * pixels() +
           static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  bool inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height && region[pixel(x, y)] != 0;
  }
};

void check_value(const Problem& problem, const Values& values, const char* name, int p, int x,
                 int y) {
  const double value = values[static_cast<std::size_t>(p) * problem.pixels() + problem.pixel(x, y)];
  if (std::abs(value) <= 1e300) return;
  throw Error{{.place = fmt::format("{}, plane {}, pixel ({}, {})", name, p, x, y),
               .expected = "a number of magnitude at most 1e300",
               .found = fmt::format("{}", value)}};
}

bool is_bounded(const Values& values) {
  bool bounded = true;
  for (const double value : values) bounded &= std::abs(value) <= 1e300;
  return bounded;
}

void check_values(const Problem& problem) {
  if (is_bounded(problem.target) && is_bounded(problem.gradient_x) &&
      is_bounded(problem.gradient_y))
    return;
  const int width = problem.width, height = problem.height;
  for (int p = 0; p < problem.planes; ++p)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool here = problem.inside(x, y), right = problem.inside(x + 1, y),
                   below = problem.inside(x, y + 1);
        if (here || right || below || problem.inside(x - 1, y) || problem.inside(x, y - 1))
          check_value(problem, problem.target, "target", p, x, y);
        if (x + 1 < width && (here || right))
          check_value(problem, problem.gradient_x, "gradient x", p, x, y);
        if (y + 1 < height && (here || below))
          check_value(problem, problem.gradient_y, "gradient y", p, x, y);
      }
}

// Adds up rows in order: sums[y * planes + p], the same bits for any number of threads.
Values add_rows(const Values& sums, int planes) {
  Values total(static_cast<std::size_t>(planes), 0.0);
  for (std::size_t i = 0; i < sums.size(); ++i) total[i % total.size()] += sums[i];
  return total;
}

// Calls body(y, p) -> double for all rows of all planes; returns the sums of planes.
template <typename Body>
Values sum_rows(const GridShape& shape, const Body& body) {
  Values sums(static_cast<std::size_t>(shape.height) * static_cast<std::size_t>(shape.planes));
  const int block = std::max(1, 8192 / (shape.planes * shape.count()));
  parallel_for_blocks(
      static_cast<std::size_t>(shape.height), static_cast<std::size_t>(block),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
          for (int p = 0; p < shape.planes; ++p)
            sums[y * static_cast<std::size_t>(shape.planes) + static_cast<std::size_t>(p)] =
                body(static_cast<int>(y), p);
      });
  return add_rows(sums, shape.planes);
}

// r = (b - A f) / scale in the region (Eq. 7); returns its squared norms. mask: one padded plane.
Values find_residual(const Problem& problem, const Values& f, const Values& mask,
                     const Values& scales, const GridShape& shape, Values& r) {
  const Values zero(static_cast<std::size_t>(problem.width));
  return sum_rows(shape, [&](int y, int p) {
    const std::size_t at = problem.row(p, y), width = static_cast<std::size_t>(problem.width);
    const bool first = y == 0, last = y + 1 == problem.height;
    const double *row = f.data() + at, *gy = problem.gradient_y.data() + at;
    double* out = r.data() + shape.row(y, p);
    find_residual_row({.f = row,
                       .up = first ? row : row - width,
                       .down = last ? row : row + width,
                       .gradient_x = problem.gradient_x.data() + at,
                       .gradient_y = last ? zero.data() : gy,
                       .gradient_y_up = first ? zero.data() : gy - width},
                      mask.data() + shape.with(1).row(y), 1 / scales[static_cast<std::size_t>(p)],
                      problem.width, out);
    return square_row(out, shape.count());
  });
}

// The largest residual of each plane, 0 where it is the rounding of the target's own values.
Values find_scales(const Problem& problem, const Values& mask, const GridShape& shape,
                   const Values& r) {
  const auto planes = static_cast<std::size_t>(problem.planes);
  Values sizes(planes, 0.0), scales(planes, 0.0);
  for (int y = 0; y < problem.height; ++y)
    for (int p = 0; p < problem.planes; ++p) {
      const auto k = static_cast<std::size_t>(p);
      const double* row_mask = mask.data() + shape.with(1).row(y);
      sizes[k] = std::max(
          sizes[k], max_row(problem.target.data() + problem.row(p, y), row_mask, problem.width));
      scales[k] = std::max(scales[k], max_row(r.data() + shape.row(y, p), row_mask, shape.count()));
    }
  for (std::size_t k = 0; k < planes; ++k)
    if (scales[k] <= 4e-15 * sizes[k] || scales[k] < 1e-300) scales[k] = 0;
  return scales;
}

// Brings every plane of the residual to magnitude 1, or to 0 where its scale is 0.
void normalise(const GridShape& shape, const Values& scales, Values& r) {
  sum_rows(shape, [&](int y, int p) {
    const double scale = scales[static_cast<std::size_t>(p)];
    const double factor = scale > 0 ? 1 / scale : 0.0;
    double* row = r.data() + shape.row(y, p);
    for (int x = 0; x < shape.width; ++x) row[x] *= factor;
    return 0.0;
  });
}

// Preconditioned conjugate gradients for A e = r, all planes side by side, each with its own
// coefficients; a plane that has converged stands still.
struct Solver {
  GridShape shape;  // all planes
  Multigrid grid;
  Values self, mask;    // one plane
  Values e, r, p, q;    // all planes
  Values goal, rr, rz;  // per plane: wanted and present squared norm, r·z
  int iterations = 0;
};

void start_coefficients(Solver& solver) {
  const MultigridLevel& finest = solver.grid.levels.front();
  solver.self.assign(finest.self.begin(), finest.self.end());
  solver.mask.assign(finest.mask.begin(), finest.mask.end());
  for (Values* values : {&solver.e, &solver.r, &solver.p, &solver.q})
    values->assign(solver.shape.size(), 0.0);
}

bool is_done(const Solver& solver) {
  for (std::size_t p = 0; p < solver.rr.size(); ++p)
    if (solver.rr[p] > solver.goal[p]) return false;
  return true;
}

// q = A p; returns p·q.
Values apply(Solver& solver) {
  const GridShape& s = solver.shape;
  return sum_rows(s, [&](int y, int p) {
    const std::size_t at = s.with(1).row(y), here = s.row(y, p);
    return apply_laplacian(solver.self.data() + at, solver.mask.data() + at, solver.p.data() + here,
                           solver.p.data() + s.row(y - 1, p), solver.p.data() + s.row(y + 1, p),
                           s.count(), solver.q.data() + here);
  });
}

// e += alpha p, r -= alpha q; keeps r as the right-hand side of the preconditioner.
void step(Solver& solver, const Values& alpha) {
  const GridShape& s = solver.shape;
  std::vector<float>& b = solver.grid.levels.front().b;
  solver.rr = sum_rows(s, [&](int y, int p) {
    const std::size_t here = s.row(y, p);
    return step_row(solver.p.data() + here, solver.q.data() + here,
                    alpha[static_cast<std::size_t>(p)], s.count(), solver.e.data() + here,
                    solver.r.data() + here, b.data() + here);
  });
}

// z = M⁻¹ r; p = z + (r·z / last r·z) p.
void turn(Solver& solver) {
  run_cycle(solver.grid);
  const GridShape& s = solver.shape;
  const std::vector<float>& z = solver.grid.levels.front().x;
  const Values last = solver.rz;
  solver.rz = sum_rows(s, [&](int y, int p) {
    return dot_row(solver.r.data() + s.row(y, p), z.data() + s.row(y, p), s.count());
  });
  sum_rows(s, [&](int y, int p) {
    const auto k = static_cast<std::size_t>(p);
    const double beta = last[k] > 0 ? solver.rz[k] / last[k] : 0.0;
    turn_row(z.data() + s.row(y, p), beta, s.count(), solver.p.data() + s.row(y, p));
    return 0.0;
  });
}

// Returns the squared norms of r before the first iteration.
Values iterate(Solver& solver, const PoissonParams& params) {
  const auto planes = static_cast<std::size_t>(solver.shape.planes);
  Values alpha(planes, 0.0);
  solver.rz.assign(planes, 0.0);
  step(solver, alpha);  // fills rr and the preconditioner's right-hand side
  Values before = solver.rr;
  solver.goal = before;
  for (double& goal : solver.goal) goal *= params.tolerance * params.tolerance;
  while (solver.iterations < params.max_iterations && !is_done(solver)) {
    turn(solver);
    const Values curvature = apply(solver);
    for (std::size_t p = 0; p < planes; ++p) {
      const bool moves = solver.rr[p] > solver.goal[p] && curvature[p] > 0;
      alpha[p] = moves ? solver.rz[p] / curvature[p] : 0.0;
    }
    step(solver, alpha);
    ++solver.iterations;
  }
  return before;
}

// Takes the mean off every plane: where the region is the whole image the equations are solvable
// only for a residual of mean 0, up to rounding, and say nothing about the mean of the solution.
void centre(const GridShape& shape, Values& values) {
  for (int p = 0; p < shape.planes; ++p) {
    double sum = 0;
    for (int y = 0; y < shape.height; ++y)
      for (int x = 0; x < shape.width; ++x)
        sum += values[shape.row(y, p) + static_cast<std::size_t>(x)];
    const double mean = sum / (static_cast<double>(shape.width) * shape.height);
    for (int y = 0; y < shape.height; ++y)
      for (int x = 0; x < shape.width; ++x)
        values[shape.row(y, p) + static_cast<std::size_t>(x)] -= mean;
  }
}

// f + scale e in the region.
Values add_solution(const Problem& problem, const Solver& solver, const Values& scales) {
  Values f = problem.target;
  sum_rows(solver.shape, [&](int y, int p) {
    add_row(solver.e.data() + solver.shape.row(y, p),
            solver.mask.data() + solver.shape.with(1).row(y), scales[static_cast<std::size_t>(p)],
            problem.width, f.data() + problem.row(p, y));
    return 0.0;
  });
  return f;
}

// The largest |b - A f| / |b - A target| over the planes.
double measure(const Problem& problem, const Values& f, const Values& scales, const Values& before,
               Solver& solver) {
  Values divisors = scales;
  for (double& divisor : divisors) divisor = divisor > 0 ? divisor : 1.0;
  const Values after = find_residual(problem, f, solver.mask, divisors, solver.shape, solver.q);
  double worst = 0;
  for (std::size_t p = 0; p < scales.size(); ++p)
    if (before[p] > 0) worst = std::max(worst, std::sqrt(after[p] / before[p]));
  return worst;
}

void check_sizes(int width, int height, int planes, std::size_t values, std::size_t pixels) {
  PARIAN_CHECK(width > 0 && height > 0 && planes > 0);
  PARIAN_CHECK_EQ(pixels, static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  PARIAN_CHECK_EQ(values, pixels * static_cast<std::size_t>(planes));
}

}  // namespace

ParamList describe(PoissonParams& params) {
  return {{.name = "tolerance",
           .help = "residual at which the solver stops, relative to that of the target",
           .target = &params.tolerance,
           .min = 1e-14,
           .max = 1},
          {.name = "max-iterations",
           .help = "most iterations of the solver",
           .target = &params.max_iterations,
           .min = 1,
           .max = 10000}};
}

std::vector<double> solve_poisson(int width, int height, int planes,
                                  const std::vector<std::uint8_t>& region, const Values& target,
                                  const Values& gradient_x, const Values& gradient_y,
                                  const PoissonParams& params, PoissonReport* report) {
  PoissonParams copy = params;
  check(describe(copy));
  check_sizes(width, height, planes, target.size(), region.size());
  PARIAN_CHECK_EQ(gradient_x.size(), target.size());
  PARIAN_CHECK_EQ(gradient_y.size(), target.size());
  PoissonReport unused;
  PoissonReport& out = report != nullptr ? *report : unused;
  out = {};
  const auto inside = std::count_if(region.begin(), region.end(), [](auto v) { return v != 0; });
  if (inside == 0) return target;
  const Problem problem{width, height, planes, region, target, gradient_x, gradient_y};
  check_values(problem);
  out.free_components = static_cast<std::size_t>(inside) == region.size() ? 1 : 0;

  Solver solver;
  solver.shape = {width, height, planes};
  solver.grid = make_multigrid(width, height, planes, region);
  start_coefficients(solver);
  const auto count = static_cast<std::size_t>(planes);
  find_residual(problem, target, solver.mask, Values(count, 1.0), solver.shape, solver.r);
  const Values scales = find_scales(problem, solver.mask, solver.shape, solver.r);
  normalise(solver.shape, scales, solver.r);
  if (out.free_components > 0) centre(solver.shape, solver.r);
  const Values before = iterate(solver, params);
  if (out.free_components > 0) centre(solver.shape, solver.e);
  Values f = add_solution(problem, solver, scales);
  out.iterations = solver.iterations;
  out.relative_residual = measure(problem, f, scales, before, solver);
  return f;
}

void make_gradients(int width, int height, int planes, const Values& values, Values& gradient_x,
                    Values& gradient_y) {
  const std::size_t row = static_cast<std::size_t>(width);
  check_sizes(width, height, planes, values.size(), row * static_cast<std::size_t>(height));
  gradient_x.assign(values.size(), 0.0);
  gradient_y.assign(values.size(), 0.0);
  for (int line = 0; line < planes * height; ++line)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(line) * row + static_cast<std::size_t>(x);
      if (x + 1 < width) gradient_x[i] = values[i + 1] - values[i];
      if ((line + 1) % height != 0) gradient_y[i] = values[i + row] - values[i];
    }
}

void mix_gradients(const Values& target_x, const Values& target_y, Values& gradient_x,
                   Values& gradient_y) {
  PARIAN_CHECK_EQ(target_x.size(), gradient_x.size());
  PARIAN_CHECK_EQ(target_y.size(), gradient_y.size());
  for (std::size_t i = 0; i < target_x.size(); ++i)
    if (std::abs(target_x[i]) > std::abs(gradient_x[i])) gradient_x[i] = target_x[i];
  for (std::size_t i = 0; i < target_y.size(); ++i)
    if (std::abs(target_y[i]) > std::abs(gradient_y[i])) gradient_y[i] = target_y[i];
}

}  // namespace parian

#include "compress/pair_objective.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "base/check.h"
#include "base/parallel.h"
#include "compress/pair_kernels.h"
#include "compress/table_residual.h"

namespace parian {
namespace {

// All ordered pairs of one distance: both directions of each offset.
struct Ring {
  std::vector<Offset> offsets;
  std::size_t segment = 0;  // between this knot and the next,
  float fraction = 0;       // at this fraction
};

std::vector<Ring> make_rings(const ProfileMap& map, const std::vector<Offset>& offsets) {
  std::map<int, Ring> by_square;
  for (Offset d : offsets) {
    if (std::abs(d.dx) >= map.width || std::abs(d.dy) >= map.height) continue;
    Ring& ring = by_square[d.dx * d.dx + d.dy * d.dy];
    ring.offsets.push_back(d);
    if (d != Offset{}) ring.offsets.push_back({-d.dx, -d.dy});
  }
  std::vector<Ring> rings;
  const auto& knots = map.knots_mm;
  for (auto& [square, ring] : by_square) {
    const double r = std::sqrt(square) * map.pixel_pitch_mm;
    const auto above = std::upper_bound(knots.begin(), knots.end(), r) - knots.begin();
    ring.segment = std::min(static_cast<std::size_t>(above) - 1, knots.size() - 2);
    const double left = knots[ring.segment];
    ring.fraction =
        static_cast<float>(std::min(1.0, (r - left) / (knots[ring.segment + 1] - left)));
    rings.push_back(std::move(ring));
  }
  return rings;
}

// Planes with a margin of zeros, so that partners outside the grid need no test.
struct PaddedGrid {
  std::size_t width = 0, height = 0, margin_x = 0, margin_y = 0, stride = 0;

  PaddedGrid(const ProfileMap& map, const std::vector<Ring>& rings)
      : width(static_cast<std::size_t>(map.width)), height(static_cast<std::size_t>(map.height)) {
    for (const Ring& ring : rings)
      for (Offset d : ring.offsets) {
        margin_x = std::max(margin_x, static_cast<std::size_t>(std::abs(d.dx)));
        margin_y = std::max(margin_y, static_cast<std::size_t>(std::abs(d.dy)));
      }
    stride = (width + ring_block - 1) / ring_block * ring_block + 2 * margin_x;
  }
  std::size_t plane() const { return (height + 2 * margin_y) * stride; }
  std::size_t row(std::size_t y) const { return (y + margin_y) * stride + margin_x; }
  std::size_t padded_width() const { return stride - 2 * margin_x; }
};

// Everything that stays from evaluation to evaluation.
struct PairProblem {
  RowShape shape;
  std::vector<Ring> rings;
  PaddedGrid grid;
  AlignedVector<float> target;       // [channel][knot][pixel]
  std::vector<float> weight;         // relative_x / sum_y R_xy^2
  std::vector<float> albedo_weight;  // albedo_x / |rho_x|^2
  std::vector<float> albedo;         // rho [channel][pixel], of the table where there is one
  std::vector<float> linear;         // TableResidual's, or empty,
  double constant = 0;               // and what F is where R' = R*

  const float* target_plane(std::size_t channel, std::size_t knot) const {
    return target.data() + (channel * shape.knots + knot) * shape.pixels;
  }
};

std::vector<std::ptrdiff_t> make_shifts(const PaddedGrid& grid, const Ring& ring) {
  std::vector<std::ptrdiff_t> shifts;
  shifts.reserve(ring.offsets.size());
  for (Offset d : ring.offsets)
    shifts.push_back(static_cast<std::ptrdiff_t>(d.dy) * static_cast<std::ptrdiff_t>(grid.stride) +
                     d.dx);
  return shifts;
}

// Calls body(y, row_sums) for each row with the ring sums of `count` padded planes.
template <std::size_t count, typename Body>
void for_each_row(const PairProblem& problem, const Ring& ring, const float* planes, Body body) {
  const PaddedGrid& grid = problem.grid;
  const std::vector<std::ptrdiff_t> shifts = make_shifts(grid, ring);
  constexpr std::size_t rows = 8;
  parallel_for_blocks(grid.height, rows, [&](std::size_t begin, std::size_t end) {
    AlignedVector<float> sums(count * grid.padded_width());
    std::array<const float*, count> row_sums;
    for (std::size_t i = 0; i < count; ++i) row_sums[i] = &sums[i * grid.padded_width()];
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t i = 0; i < count; ++i)
        sum_ring(planes + i * grid.plane() + grid.row(y), shifts.data(), shifts.size(),
                 &sums[i * grid.padded_width()], grid.width);
      body(y, row_sums.data());
    }
  });
}

void for_rows(const PaddedGrid& grid, const std::function<void(std::size_t)>& body) {
  parallel_for_blocks(grid.height, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) body(y);
  });
}

// Root profiles of a field at a ring's radius, unpadded.
void eval_ring(const PairProblem& problem, const Ring& ring, const float* field,
               std::size_t channel, float* out) {
  const std::size_t width = problem.grid.width, pixels = problem.shape.pixels;
  const float* knot = field + (channel * problem.shape.knots + ring.segment) * pixels;
  for_rows(problem.grid, [&](std::size_t y) {
    eval_root_profile(knot + y * width, knot + pixels + y * width, ring.fraction, out + y * width,
                      width);
  });
}

// rho [channel][pixel] of a field.
std::vector<float> sum_albedo(const PairProblem& problem, const float* field) {
  const PaddedGrid& grid = problem.grid;
  const std::size_t pixels = problem.shape.pixels;
  std::vector<float> albedo(problem.shape.channels * pixels, 0.0f);
  std::vector<float> root(pixels), padded(grid.plane(), 0.0f);
  for (std::size_t c = 0; c < problem.shape.channels; ++c)
    for (const Ring& ring : problem.rings) {
      eval_ring(problem, ring, field, c, root.data());
      for_rows(grid, [&](std::size_t y) {
        std::copy_n(&root[y * grid.width], grid.width, &padded[grid.row(y)]);
      });
      for_each_row<1>(problem, ring, padded.data(), [&](std::size_t y, const float* const* sums) {
        float* to = &albedo[c * pixels + y * grid.width];
        for (std::size_t x = 0; x < grid.width; ++x) to[x] += root[y * grid.width + x] * sums[0][x];
      });
    }
  return albedo;
}

// sum_y R_xy^2 over all channels.
std::vector<float> sum_energy(const PairProblem& problem) {
  const PaddedGrid& grid = problem.grid;
  std::vector<float> energy(problem.shape.pixels, 0.0f), root(problem.shape.pixels);
  std::vector<float> padded(grid.plane(), 0.0f);
  for (std::size_t c = 0; c < problem.shape.channels; ++c)
    for (const Ring& ring : problem.rings) {
      eval_ring(problem, ring, problem.target.data(), c, root.data());
      for_rows(grid, [&](std::size_t y) {
        for (std::size_t x = 0; x < grid.width; ++x) {
          const float s = root[y * grid.width + x];
          padded[grid.row(y) + x] = s * s;
        }
      });
      for_each_row<1>(problem, ring, padded.data(), [&](std::size_t y, const float* const* sums) {
        for (std::size_t x = 0; x < grid.width; ++x) {
          const float s = root[y * grid.width + x];
          energy[y * grid.width + x] += s * s * sums[0][x];
        }
      });
    }
  return energy;
}

// (1, 1 - fraction, fraction) products of a ring's hats into planes [channel][knot][pixel].
void spread(const PairProblem& problem, const Ring& ring, std::size_t channel, std::size_t y,
            const float* row, float left, float right, float* planes) {
  const std::size_t width = problem.grid.width, pixels = problem.shape.pixels;
  float* knot = planes + (channel * problem.shape.knots + ring.segment) * pixels + y * width;
  add_scaled(row, left, knot, width);
  if (right != 0) add_scaled(row, right, knot + pixels, width);
}

// D at the target: 2 (w_x + w_y) R^2 + (Q_x + Q_y) R for each pair, half of it at either end, where
// Q = 2 albedo_weight rho (Jensen's inequality for the square of a sum).
LocalMetric make_metric(const PairProblem& problem) {
  const PaddedGrid& grid = problem.grid;
  const std::size_t pixels = problem.shape.pixels;
  const std::size_t values = problem.shape.channels * problem.shape.knots * pixels;
  std::vector<float> diagonal(values, 0.0f), coupling(values, 0.0f), root(pixels);
  std::vector<float> planes(4 * grid.plane(), 0.0f);
  const auto q = [&](std::size_t c, std::size_t i) {
    return 2 * problem.albedo_weight[i] * problem.albedo[c * pixels + i];
  };
  for (std::size_t c = 0; c < problem.shape.channels; ++c)
    for (const Ring& ring : problem.rings) {
      eval_ring(problem, ring, problem.target.data(), c, root.data());
      for_rows(grid, [&](std::size_t y) {
        for (std::size_t x = 0; x < grid.width; ++x) {
          const std::size_t i = y * grid.width + x, to = grid.row(y) + x;
          const float s = root[i];
          planes[to] = s;
          planes[grid.plane() + to] = q(c, i) * s;
          planes[2 * grid.plane() + to] = s * s;
          planes[3 * grid.plane() + to] = problem.weight[i] * (s * s);
        }
      });
      for_each_row<4>(problem, ring, planes.data(), [&](std::size_t y, const float* const* sums) {
        std::vector<float> half(grid.width);
        for (std::size_t x = 0; x < grid.width; ++x) {
          const std::size_t i = y * grid.width + x;
          const float s = root[i];
          half[x] = s * s * (problem.weight[i] * sums[2][x] + sums[3][x]) +
                    0.5f * s * (q(c, i) * sums[0][x] + sums[1][x]);
        }
        const float b = ring.fraction, a = 1 - b;
        spread(problem, ring, c, y, half.data(), a * a, b * b, diagonal.data());
        spread(problem, ring, c, y, half.data(), a * b, 0, coupling.data());
      });
    }
  return {problem.shape, make_rows(problem.shape, diagonal.data()),
          make_rows(problem.shape, coupling.data())};
}

// One ring of one channel: its part of the gradient, and of the pixels' squared errors.
void add_ring(const PairProblem& problem, const Ring& ring, std::size_t channel, const float* field,
              const float* albedo_factor, std::vector<float>& work, float* gradient,
              float* errors) {
  const PaddedGrid& grid = problem.grid;
  const std::size_t width = grid.width, pixels = problem.shape.pixels;
  float* g = work.data() + pair_planes * grid.plane();
  float* s = g + pixels;
  eval_ring(problem, ring, field, channel, g);
  eval_ring(problem, ring, problem.target.data(), channel, s);
  for_rows(grid, [&](std::size_t y) {
    std::array<float*, pair_planes> to;
    for (std::size_t i = 0; i < pair_planes; ++i) to[i] = &work[i * grid.plane() + grid.row(y)];
    fill_pair_planes(g + y * width, s + y * width, &problem.weight[y * width],
                     albedo_factor + y * width, width,
                     {to[0], to[1], to[2], to[3], to[4], to[5], to[6], to[7]});
  });
  for_each_row<pair_planes>(
      problem, ring, work.data(), [&](std::size_t y, const float* const* sums) {
        std::vector<float> row(width);
        const std::size_t at = y * width;
        combine_ring(g + at, s + at, &problem.weight[at], albedo_factor + at, sums, width,
                     row.data(), errors + at);
        if (gradient != nullptr)
          spread(problem, ring, channel, y, row.data(), 1 - ring.fraction, ring.fraction, gradient);
      });
}

// What the table adds: linear in ln P - ln P*, and constant.
double add_linear(const PairProblem& problem, const float* field, float* gradient) {
  if (problem.linear.empty()) return 0;
  return problem.constant +
         parallel_sum(problem.linear.size(), 1u << 14u, [&](std::size_t begin, std::size_t end) {
           double sum = 0;
           for (std::size_t i = begin; i < end; ++i) {
             sum += static_cast<double>(problem.linear[i] * (field[i] - problem.target[i]));
             if (gradient != nullptr) gradient[i] += problem.linear[i];
           }
           return sum;
         });
}

double eval_pairs(const PairProblem& problem, const float* field, float* gradient,
                  PixelErrors* errors) {
  const std::size_t pixels = problem.shape.pixels, channels = problem.shape.channels;
  std::vector<float> difference = sum_albedo(problem, field);
  std::vector<float> albedo_error(pixels, 0.0f), error(pixels, 0.0f);
  for (std::size_t c = 0; c < channels; ++c)  // becomes dF/d rho
    for (std::size_t i = 0; i < pixels; ++i) {
      float& value = difference[c * pixels + i];
      value -= problem.albedo[c * pixels + i];
      albedo_error[i] += value * value;
      value *= 2 * problem.albedo_weight[i];
    }
  if (gradient != nullptr) std::fill_n(gradient, channels * problem.shape.knots * pixels, 0.0f);
  std::vector<float> work(pair_planes * problem.grid.plane() + 2 * pixels, 0.0f);
  for (std::size_t c = 0; c < channels; ++c)
    for (const Ring& ring : problem.rings)
      add_ring(problem, ring, c, field, &difference[c * pixels], work, gradient, error.data());
  double value = add_linear(problem, field, gradient);
  for (std::size_t i = 0; i < pixels; ++i)
    value += static_cast<double>(problem.weight[i]) * static_cast<double>(error[i]) +
             static_cast<double>(problem.albedo_weight[i]) * static_cast<double>(albedo_error[i]);
  if (errors != nullptr) *errors = {std::move(error), std::move(albedo_error)};
  return value;
}

constexpr float tiny = std::numeric_limits<float>::min();

// Takes in the table; returns sum_y (R* - R)^2 of each pixel.
std::vector<float> add_table(const SliceSource& table, const ProfileMap& target,
                             PairProblem& problem, const Progress& progress) {
  TableResidual residual = measure_residual(table, target, problem.weight, progress);
  for (std::size_t i = 0; i < problem.albedo.size(); ++i) problem.albedo[i] += residual.albedo[i];
  problem.linear = std::move(residual.linear);
  for (std::size_t i = 0; i < problem.weight.size(); ++i)
    problem.constant +=
        static_cast<double>(problem.weight[i]) * static_cast<double>(residual.squared[i]);
  return std::move(residual.squared);
}

// |rho|^2 of each pixel.
std::vector<float> sum_squares(const std::vector<float>& albedo, std::size_t pixels) {
  std::vector<float> squares(pixels, 0.0f);
  for (std::size_t i = 0; i < albedo.size(); ++i) squares[i % pixels] += albedo[i] * albedo[i];
  return squares;
}

float reciprocal(float weight, double norm) {
  return norm > 0 ? static_cast<float>(static_cast<double>(weight) / norm) : 0.0f;
}

}  // namespace

BlendObjective make_pair_objective(const ProfileMap& target, const std::vector<Offset>& offsets,
                                   const PixelWeights& weights, const SliceSource* table,
                                   const Progress& progress) {
  PARIAN_CHECK_EQ(target.gain.size() + target.dilation.size(), std::size_t{0});
  std::vector<Ring> rings = make_rings(target, offsets);
  const PaddedGrid grid(target, rings);
  const std::size_t pixels = target.pixels();
  auto problem = std::make_shared<PairProblem>(PairProblem{
      .shape = {pixels, static_cast<std::size_t>(target.channels), target.knots_mm.size()},
      .rings = std::move(rings),
      .grid = grid,
      .target = {target.log_profile.begin(), target.log_profile.end()}});
  problem->albedo = sum_albedo(*problem, problem->target.data());
  const std::vector<float> energy = sum_energy(*problem);
  for (std::size_t i = 0; i < pixels; ++i)
    problem->weight.push_back(reciprocal(weights.relative[i], static_cast<double>(energy[i])));
  std::vector<float> missed(pixels, 0.0f);
  if (table != nullptr) missed = add_table(*table, target, *problem, progress);
  const std::vector<float> norm = sum_squares(problem->albedo, pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    problem->albedo_weight.push_back(reciprocal(weights.albedo[i], static_cast<double>(norm[i])));
  BlendObjective objective;
  objective.shape = problem->shape;
  objective.metric = make_metric(*problem);
  objective.eval = [problem, energy, norm, missed](const float* field, float* gradient,
                                                   PixelErrors* errors) {
    const double value = eval_pairs(*problem, field, gradient, errors);
    if (errors != nullptr)
      for (std::size_t i = 0; i < energy.size(); ++i) {
        errors->relative[i] = (errors->relative[i] + missed[i]) / std::max(energy[i], tiny);
        errors->albedo[i] /= std::max(norm[i], tiny);
      }
    return value;
  };
  return objective;
}

}  // namespace parian

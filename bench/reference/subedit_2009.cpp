#include "bench/reference/subedit_2009.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/aligned.h"
#include "base/check.h"
#include "base/hot.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "fit/hessian.h"
#include "math/fast_math.h"

namespace parian {
namespace {

constexpr std::size_t block = std::size_t{1} << 15u;
constexpr int tile_height = 32;  // image rows whose unknowns stay in the second-level cache

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  return parallel_sum(a.size(), block, [&](std::size_t begin, std::size_t end) {
    double lanes[8] = {};
    std::size_t i = begin;
    for (; i + 8 <= end; i += 8)
      for (std::size_t j = 0; j < 8; ++j)
        lanes[j] += static_cast<double>(a[i + j]) * static_cast<double>(b[i + j]);
    for (; i < end; ++i) lanes[0] += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    double sum = 0;
    for (double lane : lanes) sum += lane;
    return sum;
  });
}

// y += factor x
void add(std::vector<float>& y, double factor, const std::vector<float>& x) {
  const auto f = static_cast<float>(factor);
  parallel_for_blocks(y.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) y[i] += f * x[i];
  });
}

// x = r + factor x
void add_to(std::vector<float>& x, double factor, const std::vector<float>& r) {
  const auto f = static_cast<float>(factor);
  parallel_for_blocks(x.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) x[i] = r[i] + f * x[i];
  });
}

// Plain conjugate gradients from zero on A^T A p = b; product(d, out) sets out = A^T A d.
template <typename Product>
void solve(const std::vector<float>& b, const ReferenceParams& params, const Product& product,
           ReferenceResult& result) {
  result.log_profile.assign(b.size(), 0.0f);
  std::vector<float> r = b, d = b, hd(b.size());
  double rr = dot(r, r);
  const double target = params.tolerance * std::sqrt(rr);
  for (; result.iterations < params.max_iterations && std::sqrt(rr) > target; ++result.iterations) {
    product(d, hd);
    const double alpha = rr / dot(d, hd);
    add(result.log_profile, alpha, d);
    add(r, -alpha, hd);
    const double rr_new = dot(r, r);
    add_to(d, rr_new / rr, r);
    rr = rr_new;
  }
}

ReducedParams reduced_params(const SliceSource& table, const ReferenceParams& params) {
  FitParams fit;
  fit.segments = params.segments;
  ReducedParams reduced;
  reduced.knots_mm = make_knots(table.header(), fit);
  reduced.lambda = params.lambda;
  reduced.weight = PairWeight::uniform;
  return reduced;
}

// One row of A: zeros in unused entries.
struct Row {
  std::int32_t column[4];
  float value[4];
};
// Rows whose offsets lie in one segment, or the curvature rows; in parts below what allocators
// hand back to the system.
using RowBlock = AlignedVector<Row>;

// out += A^T A d for some rows.
PARIAN_HOT void multiply_rows(const Row* rows, std::size_t count, const float* PARIAN_RESTRICT d,
                              float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < count; ++i) {
    const Row& row = rows[i];
    const std::int32_t a = row.column[0], b = row.column[1], c = row.column[2], e = row.column[3];
    const float s =
        (row.value[0] * d[a] + row.value[1] * d[b]) + (row.value[2] * d[c] + row.value[3] * d[e]);
    out[a] += row.value[0] * s;
    out[b] += row.value[1] * s;
    out[c] += row.value[2] * s;
    out[e] += row.value[3] * s;
  }
}

// A listed offset that falls into a segment, and where its pairs are.
struct Listed {
  Offset offset;
  int table_index = 0;
  int times = 1;  // 2: the rows of (x, x + d) and of (x + d, x)
  float low = 0, high = 0;
  PixelRange range;
};

std::vector<Listed> members_of(const TableHeader& header, const std::vector<double>& knots,
                               std::size_t segment) {
  std::vector<Listed> members;
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const double r = length_px(header.offsets[i]) * header.pixel_pitch_mm;
    const double position =
        std::min(r / (knots[1] - knots[0]) * (1 + 1e-12), static_cast<double>(knots.size()) - 1);
    const auto own = std::min(static_cast<std::size_t>(position), knots.size() - 2);
    if (own != segment) continue;
    const double fraction = position - static_cast<double>(own);
    members.push_back({header.offsets[i], static_cast<int>(i),
                       pair_count(header, header.offsets[i]), static_cast<float>(1 - fraction),
                       static_cast<float>(fraction), pairs_in_grid(header, header.offsets[i])});
  }
  return members;
}

std::size_t rows_of(const std::vector<Listed>& members) {
  std::size_t rows = 0;
  for (const Listed& m : members)
    rows += static_cast<std::size_t>(m.times) *
            static_cast<std::size_t>(std::max(0, m.range.x1 - m.range.x0)) *
            static_cast<std::size_t>(std::max(0, m.range.y1 - m.range.y0));
  return rows;
}

struct Assembly {
  const SliceSource& table;
  int channel = 0;
  std::vector<double> knots;
  std::vector<RowBlock> rows;                // by segment, then the curvature
  std::vector<std::vector<float>> rhs_low;   // A^T y by segment: for its lower knot
  std::vector<std::vector<float>> rhs_high;  // and its upper knot

  std::size_t pixels() const { return table.header().pixels(); }
};

// Eq. 8 for the pairs of one offset in rows [y0, y1): ln P is linear between knots k and k + 1.
void append_rows(const Assembly& a, const Listed& m, std::size_t segment, int y0, int y1,
                 Row*& row) {
  const int width = a.table.header().width;
  const auto pixels = static_cast<std::int32_t>(a.pixels());
  const auto first = static_cast<std::int32_t>(segment) * pixels;
  for (int y = std::max(y0, m.range.y0); y < std::min(y1, m.range.y1); ++y) {
    for (int x = m.range.x0; x < m.range.x1; ++x) {
      const std::int32_t from = first + y * width + x,
                         to = from + m.offset.dy * width + m.offset.dx;
      *row++ = {{from, from + pixels, to, to + pixels}, {m.low, m.high, m.low, m.high}};
      if (m.times == 2)
        *row++ = {{to, to + pixels, from, from + pixels}, {m.low, m.high, m.low, m.high}};
    }
  }
}

// A^T y for the pairs of one offset, y = 2 ln R.
void add_right_hand_side(Assembly& a, const Listed& m, std::size_t segment,
                         std::vector<float>& slice) {
  const auto width = static_cast<std::size_t>(a.table.header().width);
  a.table.read_slice(a.channel, m.table_index, slice.data());
  log_array(slice.data(), slice.data(), slice.size());
  float *low = a.rhs_low[segment].data(), *high = a.rhs_high[segment].data();
  const auto step =
      static_cast<std::ptrdiff_t>(m.offset.dy) * static_cast<std::ptrdiff_t>(width) + m.offset.dx;
  const float scale = 2 * static_cast<float>(m.times);
  for (int y = m.range.y0; y < m.range.y1; ++y) {
    const std::size_t at = static_cast<std::size_t>(y) * width;
    for (int x = m.range.x0; x < m.range.x1; ++x) {
      const std::size_t from = at + static_cast<std::size_t>(x);
      const std::size_t to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from) + step);
      const float value = scale * slice[from];
      low[from] += m.low * value;
      high[from] += m.high * value;
      low[to] += m.low * value;
      high[to] += m.high * value;
    }
  }
}

void assemble_segment(Assembly& a, std::size_t segment) {
  const std::vector<Listed> members = members_of(a.table.header(), a.knots, segment);
  a.rows[segment] = RowBlock(rows_of(members));
  a.rhs_low[segment].assign(a.pixels(), 0.0f);
  a.rhs_high[segment].assign(a.pixels(), 0.0f);
  Row* row = a.rows[segment].data();
  for (int y = 0; y < a.table.header().height; y += tile_height)
    for (const Listed& m : members) append_rows(a, m, segment, y, y + tile_height, row);
  std::vector<float> slice(a.pixels());
  for (const Listed& m : members) add_right_hand_side(a, m, segment, slice);
}

// Eq. 9: lambda times the second difference at the knots k, k + 1, k + 2 of each pixel.
void assemble_curvature(Assembly& a, double lambda) {
  const auto pixels = static_cast<std::int32_t>(a.pixels());
  RowBlock& rows = a.rows.back() = RowBlock((a.knots.size() - 2) * a.pixels());
  const auto value = static_cast<float>(lambda);
  parallel_for(a.knots.size() - 2, [&](std::size_t k) {
    for (std::int32_t x = 0; x < pixels; ++x) {
      const std::int32_t at = static_cast<std::int32_t>(k) * pixels + x;
      rows[static_cast<std::size_t>(at)] = {{at, at + pixels, at + 2 * pixels, at},
                                            {value, -2 * value, value, 0}};
    }
  });
}

// A^T A d: threads take equal shares of the rows, each with sums of its own.
void multiply(const std::vector<RowBlock>& blocks, const std::vector<float>& d,
              std::vector<std::vector<float>>& sums, std::vector<float>& out) {
  std::size_t total = 0;
  for (const RowBlock& rows : blocks) total += rows.size();
  const std::size_t shares = sums.size();
  parallel_for(shares, [&](std::size_t share) {
    std::fill(sums[share].begin(), sums[share].end(), 0.0f);
    const std::size_t from = total * share / shares, to = total * (share + 1) / shares;
    std::size_t first = 0;
    for (const RowBlock& rows : blocks) {
      const std::size_t begin = std::clamp(from, first, first + rows.size()),
                        end = std::clamp(to, first, first + rows.size());
      multiply_rows(rows.data() + (begin - first), end - begin, d.data(), sums[share].data());
      first += rows.size();
    }
  });
  parallel_for_blocks(out.size(), block, [&](std::size_t begin, std::size_t end) {
    std::copy(sums[0].begin() + static_cast<std::ptrdiff_t>(begin),
              sums[0].begin() + static_cast<std::ptrdiff_t>(end),
              out.begin() + static_cast<std::ptrdiff_t>(begin));
    for (std::size_t s = 1; s < shares; ++s)
      for (std::size_t i = begin; i < end; ++i) out[i] += sums[s][i];
  });
}

// Eq. 8 has a row for each ordered pair: (x, x + d) and (x + d, x) are two.
void list_ordered_pairs(ReducedSystem& system) {
  PARIAN_CHECK_EQ(system.not_measured,
                  std::size_t{0});  // rows of missing pairs are not left out here
  const std::size_t listed = system.offsets.size();
  for (std::size_t i = 0; i < listed; ++i) {
    if (system.pair_count[i] < 2) continue;
    system.pair_count[i] = 1;
    system.offsets.push_back({-system.offsets[i].dx, -system.offsets[i].dy});
    system.pair_count.push_back(1);
    system.segment.push_back(system.segment[i]);
    system.fraction.push_back(system.fraction[i]);
    system.weights[0].phi.push_back(system.weights[0].phi[i]);
    system.missing.emplace_back();
  }
}

}  // namespace

ReferenceResult fit_subedit_2009_assembled(const SliceSource& table, int channel,
                                           const ReferenceParams& params) {
  const Stopwatch watch;
  Assembly a{table, channel, reduced_params(table, params).knots_mm, {}, {}, {}};
  const std::size_t segments = a.knots.size() - 1, pixels = a.pixels();
  a.rows.resize(segments + 1);
  a.rhs_low.resize(segments);
  a.rhs_high.resize(segments);
  parallel_for(segments, [&](std::size_t i) { assemble_segment(a, segments - 1 - i); });
  assemble_curvature(a, params.lambda);
  std::vector<float> b(a.knots.size() * pixels);
  parallel_for(a.knots.size(), [&](std::size_t k) {
    for (std::size_t x = 0; x < pixels; ++x)
      b[k * pixels + x] = (k < segments ? a.rhs_low[k][x] : 0) + (k > 0 ? a.rhs_high[k - 1][x] : 0);
  });
  ReferenceResult result;
  for (const RowBlock& rows : a.rows) result.matrix_bytes += rows.size() * sizeof(Row);
  result.seconds_assembly = watch.seconds();
  std::vector<std::vector<float>> sums(static_cast<std::size_t>(thread_count()),
                                       std::vector<float>(b.size()));
  solve(
      b, params, [&](const auto& d, auto& out) { multiply(a.rows, d, sums, out); }, result);
  return result;
}

ReferenceResult fit_subedit_2009_on_the_fly(const SliceSource& table, int channel,
                                            const ReferenceParams& params) {
  const Stopwatch watch;
  // A^T y and the row geometry; the products below go over the pairs, row by row.
  ReducedSystem system = make_reduced_system(table, channel, reduced_params(table, params));
  list_ordered_pairs(system);
  Hessian rows;
  rows.method = ProductMethod::explicit_;
  rows.knots = system.knots();
  HessianWorkspace workspace;
  const std::vector<float> b(system.right_hand_side.begin(), system.right_hand_side.end());
  ReferenceResult result;
  result.seconds_assembly = watch.seconds();
  solve(
      b, params,
      [&](const auto& d, auto& out) {
        apply_hessian(system, rows, d.data(), out.data(), workspace);
      },
      result);
  return result;
}

double relative_residual(const SliceSource& table, int channel, const ReferenceParams& params,
                         const ReferenceResult& result) {
  const ReducedSystem system = make_reduced_system(table, channel, reduced_params(table, params));
  const Hessian hessian = make_hessian(system);
  HessianWorkspace workspace;
  const std::vector<double> p(result.log_profile.begin(), result.log_profile.end());
  std::vector<double> product(p.size());
  apply_hessian(system, hessian, p.data(), product.data(), workspace);
  double square = 0, norm = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    square += std::pow(system.right_hand_side[i] - product[i], 2);
    norm += std::pow(system.right_hand_side[i], 2);
  }
  return std::sqrt(square / norm);
}

}  // namespace parian

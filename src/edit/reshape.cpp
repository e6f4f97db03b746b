#include "edit/reshape.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/check.h"
#include "base/hot.h"
#include "base/parallel.h"

namespace parian {
namespace {

struct Buffers {
  explicit Buffers(std::size_t knots)
      : rows(knots * shape_lanes), changed(knots * shape_lanes), scratch(2 * knots * shape_lanes) {}
  AlignedVector<float> rows, changed, scratch;
  alignas(64) float amount[shape_lanes];
  alignas(64) double albedo[shape_lanes];
  alignas(64) double range_mm[shape_lanes];
};

template <typename T>
void load_lanes(const T* from, std::size_t count, T* to) {
  std::copy_n(from, count, to);
  std::fill(to + count, to + shape_lanes, from[count - 1]);
}

PARIAN_HOT void select_rows(const float* PARIAN_RESTRICT amount,
                            const float* PARIAN_RESTRICT changed,
                            const float* PARIAN_RESTRICT before, float* PARIAN_RESTRICT out,
                            std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] = amount[i] > 0 ? changed[i] : before[i];
}

// Where amount > 0: value = now, factor *= before / now.
PARIAN_HOT void move_value(const float* PARIAN_RESTRICT amount,
                           const double* PARIAN_RESTRICT before, const double* PARIAN_RESTRICT now,
                           double* PARIAN_RESTRICT value, double* PARIAN_RESTRICT factor,
                           std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double ratio = before[i] / now[i];
    value[i] = amount[i] > 0 ? now[i] : value[i];
    factor[i] *= amount[i] > 0 ? ratio : 1;
  }
}

PARIAN_HOT void lower_row(const float* PARIAN_RESTRICT above, float* PARIAN_RESTRICT row) {
  for (std::size_t i = 0; i < shape_lanes; ++i) row[i] = row[i] < above[i] ? row[i] : above[i];
}

struct Reshape {
  const EditState& before;
  const std::vector<float>& amount;
  const ShapeFunction& make_rows;
  const KnotTable knots;
  ShapePlanes& shapes;
  Plane& gain;
  Plane& dilation;

  void copy_block(const ShapeBlock& block) const {
    const std::size_t pixels = before.pixels();
    const auto channel = static_cast<std::size_t>(block.channel);
    for (std::size_t k = 0; k < knots.radius.size(); ++k) {
      const std::size_t at = (channel * knots.radius.size() + k) * pixels + block.first;
      std::copy_n(&before.shapes->log_profile[at], block.count, &shapes.log_profile[at]);
    }
  }

  void load(ShapeBlock& block, Buffers& buffers) const {
    const std::size_t pixels = before.pixels(), n = knots.radius.size();
    const auto channel = static_cast<std::size_t>(block.channel);
    const std::size_t at = channel * pixels + block.first;
    for (std::size_t k = 0; k < n; ++k) {
      const float* row = &before.shapes->log_profile[(channel * n + k) * pixels + block.first];
      float* target = &shapes.log_profile[(channel * n + k) * pixels + block.first];
      load_lanes(row, block.count, &buffers.rows[k * shape_lanes]);
      // Rows lie far apart, so the processor does not see what comes next.
      for (std::size_t ahead = 0; ahead < shape_lanes; ahead += 16) {
        __builtin_prefetch(row + shape_lanes + ahead);
        __builtin_prefetch(target + ahead, 1);
      }
    }
    load_lanes(&amount[block.first], block.count, buffers.amount);
    load_lanes(&before.shapes->albedo[at], block.count, buffers.albedo);
    load_lanes(&before.shapes->range_mm[at], block.count, buffers.range_mm);
    block.rows = buffers.rows.data();
    block.amount = buffers.amount;
    block.albedo = buffers.albedo;
    block.range_mm = buffers.range_mm;
    block.scratch = buffers.scratch.data();
  }

  void store(const ShapeBlock& block, Buffers& buffers) const {
    const std::size_t pixels = before.pixels(), n = knots.radius.size();
    const auto channel = static_cast<std::size_t>(block.channel);
    const std::size_t at = channel * pixels + block.first;
    for (std::size_t k = 0; k < n; ++k)
      select_rows(block.amount, &buffers.changed[k * shape_lanes], block.rows + k * shape_lanes,
                  &shapes.log_profile[(channel * n + k) * pixels + block.first], block.count);
    measure_shapes(knots, buffers.changed.data(), shape_lanes, block.count, buffers.albedo,
                   buffers.range_mm);
    move_value(block.amount, &before.shapes->albedo[at], buffers.albedo, &shapes.albedo[at],
               &gain[at], block.count);
    move_value(block.amount, &before.shapes->range_mm[at], buffers.range_mm, &shapes.range_mm[at],
               &dilation[at], block.count);
  }

  void run(ShapeBlock block, Buffers& buffers) const {
    const auto* from = &amount[block.first];
    if (!std::any_of(from, from + block.count, [](float a) { return a > 0; }))
      return copy_block(block);
    load(block, buffers);
    make_rows(block, buffers.changed.data());
    store(block, buffers);
  }
};

}  // namespace

void reshape(EditState& state, const std::vector<float>& amount, const ShapeFunction& make_rows) {
  PARIAN_CHECK_EQ(amount.size(), state.pixels());
  auto shapes = std::make_shared<ShapePlanes>();
  shapes->log_profile = AlignedVector<float>(state.shapes->log_profile.size());
  auto gain = std::make_shared<Plane>();
  auto dilation = std::make_shared<Plane>();
  const std::array<std::pair<const Plane*, Plane*>, 4> copies{
      {{&state.shapes->albedo, &shapes->albedo},
       {&state.shapes->range_mm, &shapes->range_mm},
       {state.gain.get(), gain.get()},
       {state.dilation.get(), dilation.get()}}};
  parallel_for(copies.size(), [&](std::size_t i) { *copies[i].second = *copies[i].first; });
  const Reshape work{state,   amount, make_rows, make_knot_table(state.knots_mm),
                     *shapes, *gain,  *dilation};
  const std::size_t blocks = (state.pixels() + shape_lanes - 1) / shape_lanes;
  const auto run = [&](std::size_t begin, std::size_t end) {
    Buffers buffers(state.knots_mm.size());
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t first = b % blocks * shape_lanes;
      work.run({.channel = static_cast<int>(b / blocks),
                .first = first,
                .count = std::min(shape_lanes, state.pixels() - first)},
               buffers);
    }
  };
  parallel_for_blocks(blocks * static_cast<std::size_t>(state.channels), 16, run);
  state.shapes = std::move(shapes);
  state.gain = std::move(gain);
  state.dilation = std::move(dilation);
}

void make_rows_non_increasing(float* rows, std::size_t knots) {
  for (std::size_t k = 1; k < knots; ++k)
    lower_row(rows + (k - 1) * shape_lanes, rows + k * shape_lanes);
}

}  // namespace parian

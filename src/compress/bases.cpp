#include "compress/bases.h"

#include <algorithm>

#include "base/parallel.h"
#include "compress/mixture_kernels.h"

namespace parian {
namespace {

struct Use {
  std::uint32_t pixel;
  float weight;
};

// Pixels that use each base, in scan order: uses of base j are [first[j], first[j + 1]).
struct UseLists {
  std::vector<Use> uses;
  std::vector<std::size_t> first;
};

UseLists list_uses(const Mixture& mixture) {
  UseLists lists;
  lists.first.assign(mixture.base_count() + 1, 0);
  const auto each = [&](auto&& body) {
    for (std::size_t i = 0; i < mixture.index.size(); ++i)
      if (mixture.weight[i] > 0) body(i);
  };
  each([&](std::size_t i) { ++lists.first[mixture.index[i] + std::size_t{1}]; });
  for (std::size_t j = 0; j < mixture.base_count(); ++j) lists.first[j + 1] += lists.first[j];
  lists.uses.resize(lists.first.back());
  std::vector<std::size_t> next(lists.first.begin(), lists.first.end() - 1);
  each([&](std::size_t i) {
    lists.uses[next[mixture.index[i]]++] = {static_cast<std::uint32_t>(i / mixture.per_pixel),
                                            mixture.weight[i]};
  });
  return lists;
}

constexpr std::size_t block = 128;  // uses

// Sums over the uses of one base: t^2 D and t D (target - p), rows of doubles.
struct Normal {
  std::vector<double> diagonal, coupling, residual;
  explicit Normal(std::size_t stride)
      : diagonal(stride, 0.0), coupling(stride, 0.0), residual(stride, 0.0) {}
};

Normal sum_normal(const LocalMetric& metric, const AlignedVector<float>& remainder, const Use* uses,
                  std::size_t count) {
  const std::size_t stride = metric.shape.stride();
  const std::size_t blocks = (count + block - 1) / block;
  AlignedVector<float> partial(blocks * 3 * stride);
  parallel_for(blocks, [&](std::size_t part) {
    float* sums = &partial[part * 3 * stride];
    std::fill_n(sums, 3 * stride, 0.0f);
    for (std::size_t i = part * block; i < std::min(count, (part + 1) * block); ++i) {
      const std::size_t row = metric.shape.row(uses[i].pixel);
      const float t = uses[i].weight;
      add_row(&metric.diagonal[row], t * t, sums, stride);
      add_row(&metric.coupling[row], t * t, sums + stride, stride);
      add_metric_product(&metric.diagonal[row], &metric.coupling[row], &remainder[row], t,
                         sums + 2 * stride, stride);
    }
  });
  Normal normal(stride);
  for (std::size_t part = 0; part < blocks; ++part)
    for (std::size_t i = 0; i < stride; ++i) {
      normal.diagonal[i] += static_cast<double>(partial[(3 * part) * stride + i]);
      normal.coupling[i] += static_cast<double>(partial[(3 * part + 1) * stride + i]);
      normal.residual[i] += static_cast<double>(partial[(3 * part + 2) * stride + i]);
    }
  return normal;
}

// The best value of one base; what changed is taken from its pixels' remainders.
void update_base(const LocalMetric& metric, double curvature_weight, const Use* uses,
                 std::size_t count, AlignedVector<float>& remainder, float* base) {
  const RowShape& shape = metric.shape;
  const std::size_t stride = shape.stride();
  const Normal normal = sum_normal(metric, remainder, uses, count);
  std::vector<double> value(base, base + stride), b = normal.residual;
  for (std::size_t i = 0; i < stride; ++i) {
    b[i] += normal.diagonal[i] * value[i];
    if (i + 1 == stride) continue;
    b[i] += normal.coupling[i] * value[i + 1];
    b[i + 1] += normal.coupling[i] * value[i];
  }
  for (std::size_t c = 0; c < shape.channels; ++c) {
    const std::size_t at = c * shape.knots;
    solve_non_increasing(&normal.diagonal[at], &normal.coupling[at], curvature_weight, &b[at],
                         shape.knots, &value[at]);
  }
  std::vector<float> change(stride, 0.0f);
  for (std::size_t i = 0; i < stride; ++i) {
    const auto moved = static_cast<float>(value[i]);
    change[i] = moved - base[i];
    base[i] = moved;
  }
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      add_row(change.data(), -uses[i].weight, &remainder[shape.row(uses[i].pixel)], stride);
  });
}

// A base as the sum of two uses in one pixel would be added twice to one remainder at once.
void merge_repeats(Mixture& mixture) {
  for (std::size_t x = 0; x < mixture.shape.pixels; ++x)
    for (std::size_t k = 1; k < mixture.per_pixel; ++k)
      for (std::size_t l = 0; l < k; ++l) {
        const std::size_t at = x * mixture.per_pixel;
        if (mixture.index[at + k] != mixture.index[at + l]) continue;
        mixture.weight[at + l] += mixture.weight[at + k];
        mixture.weight[at + k] = 0;
      }
}

}  // namespace

void update_bases(const LocalMetric& metric, const AlignedVector<float>& target,
                  double curvature_weight, int sweeps, Mixture& mixture) {
  merge_repeats(mixture);
  const std::size_t stride = metric.shape.stride();
  const UseLists lists = list_uses(mixture);
  AlignedVector<float> remainder = mix_rows(mixture);
  parallel_for_blocks(remainder.size(), 1u << 14u, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) remainder[i] = target[i] - remainder[i];
  });
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t j = 0; j < mixture.base_count(); ++j) {
      const std::size_t first = lists.first[j];
      update_base(metric, curvature_weight, lists.uses.data() + first, lists.first[j + 1] - first,
                  remainder, &mixture.bases[j * stride]);
    }
}

}  // namespace parian

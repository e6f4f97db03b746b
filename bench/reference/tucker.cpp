#include "bench/reference/tucker.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "bench/reference/truncated_svd.h"

namespace parian {
namespace {

using Sizes = std::array<std::size_t, 3>;
constexpr std::size_t offset_space = 96;  // holds all but 1e-4 of the energy of any of our samples
constexpr std::size_t shares = 24;        // into which the bytes are cut

// [a][b][c] -> [c][a][b]
Tensor rotate(const Tensor& tensor) {
  const auto [na, nb, nc] = tensor.size;
  Tensor out{{nc, na, nb}, AlignedVector<float>(tensor.values.size())};
  const std::size_t pairs = na * nb, depth = nc;
  parallel_for_blocks(pairs, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = 0; c < depth; ++c)
      for (std::size_t i = begin; i < end; ++i)
        out.values[c * pairs + i] = tensor.values[i * depth + c];
  });
  return out;
}

// The last axis [c] becomes [rank] by basis^T.
Tensor project_last(const Tensor& tensor, const AlignedVector<float>& basis) {
  const auto [na, nb, nc] = tensor.size;
  const std::size_t rank = basis.size() / nc;
  Tensor out{{na, nb, rank}, AlignedVector<float>(na * nb * rank)};
  multiply(tensor.values.data(), na * nb, nc, basis.data(), rank, out.values.data());
  return out;
}

// The leading eigenvectors of the last axis' Gram matrix: its best basis.
AlignedVector<float> lead_last(const Tensor& tensor, std::size_t rank) {
  const std::size_t n = tensor.size[2];
  const std::vector<double> gram =
      make_gram(tensor.values.data(), tensor.size[0] * tensor.size[1], n);
  const auto size = static_cast<Eigen::Index>(n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::Map<const Eigen::MatrixXd>(gram.data(), size, size));
  AlignedVector<float> basis(n * rank);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < rank; ++k)
      basis[i * rank + k] = static_cast<float>(solver.eigenvectors()(
          static_cast<Eigen::Index>(i), size - 1 - static_cast<Eigen::Index>(k)));
  return basis;
}

double norm2(const Tensor& tensor) {
  return parallel_sum(tensor.values.size(), 4096, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      sum += static_cast<double>(tensor.values[i]) * static_cast<double>(tensor.values[i]);
    return sum;
  });
}

// Axes 2, 1, 0 are last in turn; each is projected but for `skip`, which ends up last.
Tensor project_others(const Tensor& tensor, const TuckerModel& model, int skip) {
  Tensor out = tensor;
  for (int axis = 2; axis >= 0; --axis) {
    if (axis != skip) out = project_last(out, model.basis[static_cast<std::size_t>(axis)]);
    out = rotate(out);
  }
  for (int axis = 2; skip >= 0 && axis > skip; --axis) out = rotate(out);
  return out;
}

Tensor project_all(const Tensor& tensor, const TuckerModel& model) {
  return project_others(tensor, model, -1);
}

// Sums of squares over [0, i) x [0, j) x [0, k), sizes one larger than the core's.
std::vector<double> accumulate_squares(const Tensor& core) {
  const auto [na, nb, nc] = core.size;
  std::vector<double> sum((na + 1) * (nb + 1) * (nc + 1), 0.0);
  const auto at = [&, b = nb, c = nc](std::size_t i, std::size_t j, std::size_t k) -> double& {
    return sum[(i * (b + 1) + j) * (c + 1) + k];
  };
  for (std::size_t i = 0; i < na; ++i)
    for (std::size_t j = 0; j < nb; ++j) {
      double row = 0;
      for (std::size_t k = 0; k < nc; ++k) {
        const auto value = static_cast<double>(core.values[(i * nb + j) * nc + k]);
        row += value * value;
        at(i + 1, j + 1, k + 1) = row + at(i, j + 1, k + 1) + at(i + 1, j, k + 1) - at(i, j, k + 1);
      }
    }
  return sum;
}

// A channel with its offsets in a smaller space, and the energy it keeps with each share.
struct ChannelTensor {
  Tensor tensor;               // [y][x][k]
  AlignedVector<float> space;  // [offset][k], orthonormal columns
  std::vector<Sizes> ranks;    // by shares, 0 to `shares`
  std::vector<double> energy;
};

ChannelTensor prepare_channel(const BssrdfTable& table, int channel, std::size_t floats,
                              std::uint64_t seed) {
  OffsetMatrix matrix = make_offset_matrix(table, channel, Directions::listed);
  SvdParams params;
  params.rounds = 5;
  params.seed = seed;
  Factors svd = factor_svd(matrix, offset_space, params);
  ChannelTensor out;
  out.tensor = {{static_cast<std::size_t>(table.header.height),
                 static_cast<std::size_t>(table.header.width), svd.rank},
                std::move(svd.left)};
  out.space = std::move(svd.right);
  const TuckerModel full = factor_tucker(out.tensor, out.tensor.size, 0);
  for (std::size_t share = 0; share <= shares; ++share) {
    double energy = 0;
    out.ranks.push_back(
        choose_tucker_ranks(full.core, matrix.columns(), floats * share / shares, &energy));
    out.energy.push_back(energy);
  }
  return out;
}

// Shares per channel that keep most energy: best[c][s] over the first c channels.
std::vector<std::size_t> share_out(const std::vector<ChannelTensor>& channels) {
  std::vector<std::vector<double>> best(1, std::vector<double>(shares + 1, 0.0));
  std::vector<std::vector<std::size_t>> choice;
  for (const ChannelTensor& channel : channels) {
    std::vector<double> next(shares + 1, -1.0);
    std::vector<std::size_t> chosen(shares + 1, 0);
    for (std::size_t all = 0; all <= shares; ++all)
      for (std::size_t own = 0; own <= all; ++own) {
        const double energy = best.back()[all - own] + channel.energy[own];
        if (energy <= next[all]) continue;
        next[all] = energy;
        chosen[all] = own;
      }
    best.push_back(std::move(next));
    choice.push_back(std::move(chosen));
  }
  std::vector<std::size_t> out(channels.size());
  std::size_t left = shares;
  for (std::size_t c = channels.size(); c-- > 0;) {
    out[c] = choice[c][left];
    left -= out[c];
  }
  return out;
}

// The model as a matrix over offsets: left [y][x][r_d] = core x_y U_y x_x U_x, right = space U_d.
Factors expand(const TuckerModel& model, const ChannelTensor& channel) {
  const auto [height, width, depth] = channel.tensor.size;
  const Sizes rank = model.core.size;
  TuckerModel transposed;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::size_t n = channel.tensor.size[axis], r = rank[axis];
    transposed.basis[axis].resize(n * r);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < r; ++k)
        transposed.basis[axis][k * n + i] = model.basis[axis][i * r + k];
  }
  Factors out;
  out.rank = rank[2];
  out.left = project_others(model.core, transposed, 2).values;
  out.right.resize(channel.space.size() / depth * out.rank);
  multiply(channel.space.data(), channel.space.size() / depth, depth, model.basis[2].data(),
           out.rank, out.right.data());
  return out;
}

}  // namespace

std::size_t tucker_floats(const Sizes& size, const Sizes& rank) {
  return size[0] * rank[0] + size[1] * rank[1] + size[2] * rank[2] + rank[0] * rank[1] * rank[2];
}

Sizes choose_tucker_ranks(const Tensor& full_core, std::size_t last_size, std::size_t floats,
                          double* energy) {
  const auto [na, nb, nc] = full_core.size;
  const std::vector<double> sum = accumulate_squares(full_core);
  Sizes best{};
  double most = 0;
  for (std::size_t i = 1; i <= na; ++i)
    for (std::size_t j = 1; j <= nb && na * i + nb * j < floats; ++j) {
      const std::size_t k = std::min(nc, (floats - na * i - nb * j) / (last_size + i * j));
      const double kept = sum[(i * (nb + 1) + j) * (nc + 1) + k];
      if (k == 0 || kept <= most) continue;
      most = kept;
      best = {i, j, k};
    }
  if (energy) *energy = most;
  return best;
}

TuckerModel factor_tucker(const Tensor& tensor, const Sizes& rank, int sweeps) {
  TuckerModel model;
  Tensor turned = tensor;
  for (std::size_t axis = 3; axis-- > 0;) {
    model.basis[axis] = lead_last(turned, rank[axis]);
    turned = rotate(turned);
  }
  model.core = project_all(tensor, model);
  model.history.push_back(norm2(model.core));
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int axis = 0; axis < 3; ++axis)
      model.basis[static_cast<std::size_t>(axis)] =
          lead_last(project_others(tensor, model, axis), rank[static_cast<std::size_t>(axis)]);
    model.core = project_all(tensor, model);
    model.history.push_back(norm2(model.core));
  }
  model.captured = model.history.back();
  return model;
}

Rival compress_tucker(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed) {
  const Stopwatch watch;
  Rival rival{.name = "Tucker"};
  std::vector<ChannelTensor> channels;
  channels.reserve(static_cast<std::size_t>(table.header.channels));
  for (int c = 0; c < table.header.channels; ++c)
    channels.push_back(prepare_channel(table, c, bytes / sizeof(float), seed));
  const std::vector<std::size_t> share = share_out(channels);
  std::vector<Factors> factors;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    ChannelTensor& channel = channels[c];
    const Sizes rank = channel.ranks[share[c]];
    if (rank[0] == 0) return {.name = rival.name};
    const Sizes stored{channel.tensor.size[0], channel.tensor.size[1],
                       channel.space.size() / channel.tensor.size[2]};
    rival.bytes += sizeof(float) * tucker_floats(stored, rank);
    factors.push_back(expand(factor_tucker(channel.tensor, rank, 3), channel));
    channel = {};
  }
  rival.slices = make_factor_slices(table.header, std::move(factors), false, rival.name);
  rival.seconds = watch.seconds();
  return rival;
}

}  // namespace parian

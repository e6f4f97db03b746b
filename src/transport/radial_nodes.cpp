#include "transport/radial_nodes.h"

#include <cmath>

namespace parian {
namespace {

using Point = std::array<double, 3>;

// Sums of weights w: red, green, blue flux, and all of them.
struct Moments {
  std::array<double, 4> weight{};
  std::array<Point, 4> mean{};
  std::array<double, 6> covariance{};  // xx yy zz xy yz zx, by the last weight
};

constexpr int axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

// Of two sets together, about their common mean.
Moments merge(const Moments& a, const Moments& b) {
  Moments sum;
  for (std::size_t c = 0; c < 4; ++c) {
    sum.weight[c] = a.weight[c] + b.weight[c];
    const double part = sum.weight[c] > 0 ? b.weight[c] / sum.weight[c] : 0.5;
    for (std::size_t k = 0; k < 3; ++k)
      sum.mean[c][k] = a.mean[c][k] + part * (b.mean[c][k] - a.mean[c][k]);
  }
  const double part = sum.weight[3] > 0 ? b.weight[3] / sum.weight[3] : 0.5;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto u = static_cast<std::size_t>(axes[i][0]), v = static_cast<std::size_t>(axes[i][1]);
    sum.covariance[i] =
        (1 - part) * a.covariance[i] + part * b.covariance[i] +
        part * (1 - part) * (b.mean[3][u] - a.mean[3][u]) * (b.mean[3][v] - a.mean[3][v]);
  }
  return sum;
}

Moments moments_of(const GatherSources& sources, std::size_t i) {
  const Vec3 x = sources.points[i].position;
  const Point at{static_cast<double>(x.x), static_cast<double>(x.y), static_cast<double>(x.z)};
  const Rgb flux = sources.flux[i];
  Moments moments;
  moments.weight = {static_cast<double>(flux.x), static_cast<double>(flux.y),
                    static_cast<double>(flux.z), 0};
  moments.weight[3] = moments.weight[0] + moments.weight[1] + moments.weight[2];
  moments.mean.fill(at);
  return moments;
}

void store(const Moments& moments, std::size_t node, RadialNodes& nodes) {
  const auto set = [&](std::size_t field, double value) {
    nodes.field[field][node] = static_cast<float>(value);
  };
  for (std::size_t k = 0; k < 3; ++k) set(k, moments.mean[3][k]);
  for (std::size_t i = 0; i < 6; ++i) set(3 + i, moments.covariance[i]);
  Flux flux{};
  ChannelOffsets offset;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto shift = [&](std::size_t k) {
      return static_cast<float>(moments.mean[c][k] - moments.mean[3][k]);
    };
    flux[c] = static_cast<float>(moments.weight[c]);
    offset.x[c] = shift(0);
    offset.y[c] = shift(1);
    offset.z[c] = shift(2);
  }
  nodes.flux[node] = flux;
  nodes.offset[node] = offset;
}

}  // namespace

RadialNodes make_radial_nodes(const GatherSources& sources) {
  RadialNodes nodes;
  nodes.tree = make_source_tree(sources);
  const std::vector<SourceNode>& tree = nodes.tree.nodes;
  for (auto& field : nodes.field) field.resize(tree.size());
  nodes.flux.resize(tree.size());
  nodes.offset.resize(tree.size());
  nodes.diameter_mm.resize(tree.size());
  std::vector<Moments> moments(tree.size());
  for (std::size_t n = tree.size(); n-- > 0;) {  // children come after their parents
    const SourceNode& node = tree[n];
    if (node.left != 0) {
      moments[n] = merge(moments[node.left], moments[node.right]);
    } else if (node.begin < node.end) {
      moments[n] = moments_of(sources, nodes.tree.order[node.begin]);
      for (std::uint32_t i = node.begin + 1; i < node.end; ++i)
        moments[n] = merge(moments[n], moments_of(sources, nodes.tree.order[i]));
    }
    store(moments[n], n, nodes);
    const Vec3 size = node.box.upper - node.box.lower;
    nodes.diameter_mm[n] = std::sqrt(dot(size, size));
  }
  return nodes;
}

}  // namespace parian

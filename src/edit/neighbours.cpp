// A balanced k-d tree whose leaves are 16 points stored by component, searched for each point.
#include "edit/neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/hot.h"
#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr std::size_t leaf_size = 16;
constexpr float jitter = 1e-5F;
// The coarse level has at most this many groups, of at least one leaf each.
constexpr std::size_t largest_groups = 256;
constexpr float infinity = std::numeric_limits<float>::infinity();

struct TreeNode {
  std::size_t begin = 0, end = 0;   // of `order`; leaves: at most leaf_size
  std::size_t left = 0, right = 0;  // 0: a leaf
  std::size_t box = 0;              // in `boxes`: dims minima, dims maxima
};

struct Tree {
  std::size_t dims = 0;
  std::vector<float> points;         // [pixel][dim], jittered
  std::vector<std::uint32_t> order;  // pixels, leaf by leaf
  std::vector<TreeNode> nodes;       // level by level
  std::vector<float> boxes;
  std::vector<float> leaves;  // [leaf][dim][16], missing points far away
};

std::vector<float> jittered(const Features& features) {
  std::vector<float> points(features.values.size());
  parallel_for_blocks(points.size(), 1u << 14u, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      points[i] =
          features.values[i] + jitter * static_cast<float>(2 * hash_to_uniform(hash_u64(i)) - 1);
  });
  return points;
}

void fit_box(Tree& tree, const TreeNode& node) {
  float* low = tree.boxes.data() + node.box;
  float* high = low + tree.dims;
  std::fill_n(low, tree.dims, infinity);
  std::fill_n(high, tree.dims, -infinity);
  for (std::size_t i = node.begin; i < node.end; ++i) {
    const float* p = &tree.points[tree.order[i] * tree.dims];
    for (std::size_t d = 0; d < tree.dims; ++d) {
      low[d] = std::min(low[d], p[d]);
      high[d] = std::max(high[d], p[d]);
    }
  }
}

// Splits at the median of the widest dimension, to whole leaves.
void split(Tree& tree, const TreeNode& node, std::size_t middle) {
  const float* low = tree.boxes.data() + node.box;
  std::size_t widest = 0;
  for (std::size_t d = 1; d < tree.dims; ++d)
    if (low[tree.dims + d] - low[d] > low[tree.dims + widest] - low[widest]) widest = d;
  const auto at = [&](std::size_t i) {
    return tree.order.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(node.begin), at(middle), at(node.end), [&](std::uint32_t a, std::uint32_t b) {
    const float va = tree.points[a * tree.dims + widest];
    const float vb = tree.points[b * tree.dims + widest];
    return va < vb || (!(vb < va) && a < b);
  });
}

void fill_leaves(Tree& tree) {
  const std::size_t leaves = (tree.order.size() + leaf_size - 1) / leaf_size;
  tree.leaves.assign(leaves * leaf_size * tree.dims, 1e18F);
  for (std::size_t i = 0; i < tree.order.size(); ++i)
    for (std::size_t d = 0; d < tree.dims; ++d)
      tree.leaves[(i / leaf_size * tree.dims + d) * leaf_size + i % leaf_size] =
          tree.points[tree.order[i] * tree.dims + d];
}

Tree make_tree(const Features& features) {
  Tree tree{.dims = static_cast<std::size_t>(features.dims), .points = jittered(features)};
  tree.order.resize(features.pixels());
  for (std::size_t i = 0; i < tree.order.size(); ++i) tree.order[i] = static_cast<std::uint32_t>(i);
  tree.nodes = {{.begin = 0, .end = tree.order.size()}};
  for (std::size_t level = 0; level < tree.nodes.size();) {
    const std::size_t level_end = tree.nodes.size();
    tree.boxes.resize(2 * tree.dims * level_end);
    for (std::size_t i = level; i < level_end; ++i) {
      tree.nodes[i].box = 2 * tree.dims * i;
      const TreeNode node = tree.nodes[i];
      const std::size_t leaves = (node.end - node.begin + leaf_size - 1) / leaf_size;
      if (leaves < 2) continue;
      const std::size_t middle = node.begin + (leaves + 1) / 2 * leaf_size;
      tree.nodes[i].left = tree.nodes.size();
      tree.nodes[i].right = tree.nodes.size() + 1;
      tree.nodes.push_back({.begin = node.begin, .end = middle});
      tree.nodes.push_back({.begin = middle, .end = node.end});
    }
    parallel_for(level_end - level, [&](std::size_t i) {
      const TreeNode& node = tree.nodes[level + i];
      fit_box(tree, node);
      if (node.left != 0) split(tree, node, tree.nodes[node.left].end);
    });
    level = level_end;
  }
  fill_leaves(tree);
  return tree;
}

PARIAN_HOT void leaf_distances(const float* PARIAN_RESTRICT leaf, const float* PARIAN_RESTRICT q,
                               std::size_t dims, float* PARIAN_RESTRICT out) {
  float sum[leaf_size] = {};
  for (std::size_t d = 0; d < dims; ++d) {
    const float v = q[d];
    for (std::size_t i = 0; i < leaf_size; ++i) {
      const float step = leaf[d * leaf_size + i] - v;
      sum[i] += step * step;
    }
  }
  for (std::size_t i = 0; i < leaf_size; ++i) out[i] = sum[i];
}

float box_distance(const float* low, const float* q, std::size_t dims) {
  const float* high = low + dims;
  float sum = 0;
  for (std::size_t d = 0; d < dims; ++d) {
    const float step = std::max(std::max(low[d] - q[d], q[d] - high[d]), 0.0F);
    sum += step * step;
  }
  return sum;
}

// The k nearest so far, in order; `place` is the position in the tree's order.
struct Nearest {
  std::size_t k = 0;
  std::vector<float> distance2;
  std::vector<std::uint32_t> place;
};

void insert(Nearest& nearest, float distance2, std::uint32_t place) {
  std::size_t i = nearest.k - 1;
  for (; i > 0 && nearest.distance2[i - 1] > distance2; --i) {
    nearest.distance2[i] = nearest.distance2[i - 1];
    nearest.place[i] = nearest.place[i - 1];
  }
  nearest.distance2[i] = distance2;
  nearest.place[i] = place;
}

void visit_leaf(const Tree& tree, std::size_t begin, const float* q, std::size_t self,
                Nearest& nearest) {
  std::array<float, leaf_size> distance2{};
  leaf_distances(&tree.leaves[begin * tree.dims], q, tree.dims, distance2.data());
  for (std::size_t i = 0; i < leaf_size; ++i)
    if (distance2[i] < nearest.distance2.back() && begin + i != self &&
        begin + i < tree.order.size())
      insert(nearest, distance2[i], static_cast<std::uint32_t>(begin + i));
}

struct Pending {
  std::size_t node = 0;
  float distance2 = 0;
};

// Neighbours of the point at place `self`, nearest first.
void search(const Tree& tree, std::size_t self, Nearest& nearest) {
  std::fill(nearest.distance2.begin(), nearest.distance2.end(), infinity);
  const float* q = &tree.points[tree.order[self] * tree.dims];
  std::array<Pending, 64> stack;  // one per level
  std::size_t height = 0;
  stack[height++] = {0, 0};
  while (height > 0) {
    Pending next = stack[--height];
    if (!(next.distance2 < nearest.distance2.back())) continue;
    while (tree.nodes[next.node].left != 0) {
      const TreeNode& node = tree.nodes[next.node];
      Pending near{node.left, box_distance(&tree.boxes[tree.nodes[node.left].box], q, tree.dims)};
      Pending far{node.right, box_distance(&tree.boxes[tree.nodes[node.right].box], q, tree.dims)};
      if (far.distance2 < near.distance2) std::swap(near, far);
      if (far.distance2 < nearest.distance2.back()) stack[height++] = far;
      next = near;
    }
    if (next.distance2 < nearest.distance2.back())
      visit_leaf(tree, tree.nodes[next.node].begin, q, self, nearest);
  }
}

// [node][k]: nodes are places in the tree's order.
std::vector<std::uint32_t> find_neighbours(const Tree& tree, std::size_t k) {
  std::vector<std::uint32_t> found(tree.order.size() * k);
  parallel_for_blocks(tree.order.size(), 256, [&](std::size_t begin, std::size_t end) {
    Nearest nearest{k, std::vector<float>(k), std::vector<std::uint32_t>(k)};
    for (std::size_t i = begin; i < end; ++i) {
      search(tree, i, nearest);
      std::copy(nearest.place.begin(), nearest.place.end(), &found[i * k]);
    }
  });
  return found;
}

struct Row {
  std::array<std::size_t, 4> beside{};
  std::size_t count = 0;
};

// Nodes beside node i in the image.
Row nodes_beside(const NeighbourGraph& graph, std::size_t i) {
  const auto width = static_cast<std::size_t>(graph.width);
  const std::size_t pixel = graph.pixel[i], x = pixel % width;
  Row row;
  if (pixel >= width) row.beside[row.count++] = graph.node[pixel - width];
  if (x > 0) row.beside[row.count++] = graph.node[pixel - 1];
  if (x + 1 < width) row.beside[row.count++] = graph.node[pixel + 1];
  if (pixel + width < graph.pixels()) row.beside[row.count++] = graph.node[pixel + width];
  return row;
}

// For each node the nodes that have it as a neighbour, as rows.
void transpose(const std::vector<std::uint32_t>& found, std::size_t k, std::size_t nodes,
               std::vector<std::size_t>& first, std::vector<std::uint32_t>& from) {
  first.assign(nodes + 1, 0);
  for (const std::uint32_t j : found) ++first[j + 1];
  for (std::size_t i = 0; i < nodes; ++i) first[i + 1] += first[i];
  from.resize(found.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t e = 0; e < found.size(); ++e)
    from[next[found[e]]++] = static_cast<std::uint32_t>(e / k);
}

// Calls body(i, row) for all nodes, with row the entries 2 to + spatial in order.
template <typename Body>
void for_each_row(const NeighbourGraph& graph, const std::vector<std::uint32_t>& found,
                  const std::vector<std::size_t>& first, const std::vector<std::uint32_t>& from,
                  const Body& body) {
  parallel_for_blocks(graph.pixels(), 512, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint64_t> row;
    const std::size_t k = found.size() / graph.pixels();
    for (std::size_t i = begin; i < end; ++i) {
      row.clear();
      row.reserve(k + first[i + 1] - first[i] + 4);
      for (std::size_t e = i * k; e < (i + 1) * k; ++e) row.push_back(2 * std::uint64_t{found[e]});
      for (std::size_t e = first[i]; e < first[i + 1]; ++e)
        row.push_back(2 * std::uint64_t{from[e]});
      const Row beside = nodes_beside(graph, i);
      for (std::size_t e = 0; e < beside.count; ++e) row.push_back(2 * beside.beside[e] + 1);
      std::sort(row.begin(), row.end());
      // An edge that is both sorts with appearance first.
      row.erase(std::unique(row.begin(), row.end(),
                            [](std::uint64_t a, std::uint64_t b) { return a / 2 == b / 2; }),
                row.end());
      body(i, row);
    }
  });
}

void fill_rows(const Features& features, const std::vector<std::uint32_t>& found,
               NeighbourGraph& graph) {
  const std::size_t nodes = graph.pixels();
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> from;
  transpose(found, std::max<std::size_t>(1, found.size() / nodes), nodes, first, from);
  graph.first.assign(nodes + 1, 0);
  using Entries = std::vector<std::uint64_t>;
  for_each_row(graph, found, first, from,
               [&](std::size_t i, const Entries& row) { graph.first[i + 1] = row.size(); });
  for (std::size_t i = 0; i < nodes; ++i) graph.first[i + 1] += graph.first[i];
  graph.to.resize(graph.first.back());
  graph.distance2.resize(graph.to.size());
  graph.spatial.resize(graph.to.size());
  for_each_row(graph, found, first, from, [&](std::size_t i, const Entries& row) {
    for (std::size_t e = 0; e < row.size(); ++e) {
      const std::size_t at = graph.first[i] + e, j = row[e] / 2;
      graph.to[at] = static_cast<std::uint32_t>(j);
      graph.spatial[at] = static_cast<std::uint8_t>(row[e] % 2);
      graph.distance2[at] =
          static_cast<float>(feature_distance_squared(features, graph.pixel[i], graph.pixel[j]));
    }
  });
}

// The tree's order, and as groups the deepest whole level of at most largest_groups nodes.
void number_nodes(const Tree& tree, NeighbourGraph& graph) {
  std::size_t begin = 0, end = 1;
  const auto is_split = [](const TreeNode& node) { return node.left != 0; };
  while (2 * (end - begin) <= largest_groups &&
         std::all_of(tree.nodes.begin() + static_cast<std::ptrdiff_t>(begin),
                     tree.nodes.begin() + static_cast<std::ptrdiff_t>(end), is_split)) {
    begin = end;
    end = tree.nodes[begin - 1].right + 1;
  }
  graph.group_first.assign(1, 0);
  graph.group_first.reserve(end - begin + 1);
  for (std::size_t i = begin; i < end; ++i) graph.group_first.push_back(tree.nodes[i].end);
  graph.pixel = tree.order;
  graph.node.resize(tree.order.size());
  for (std::size_t i = 0; i < tree.order.size(); ++i)
    graph.node[tree.order[i]] = static_cast<std::uint32_t>(i);
}

}  // namespace

ParamList describe(GraphParams& params) {
  return {{.name = "neighbours",
           .help = "pixels most alike that each pixel is joined to",
           .target = &params.neighbours,
           .min = 1,
           .max = 64,
           .symbol = "k"}};
}

NeighbourGraph make_neighbour_graph(const Features& features, const GraphParams& params) {
  GraphParams checked = params;
  check(describe(checked));
  const std::size_t pixels = features.pixels();
  PARIAN_CHECK(pixels >= 1 && features.dims >= 1);
  PARIAN_CHECK_EQ(features.values.size(), pixels * static_cast<std::size_t>(features.dims));
  PARIAN_CHECK_LE(pixels, std::size_t{0x7fffffff});
  NeighbourGraph graph{
      .width = features.width, .height = features.height, .neighbours = params.neighbours};
  const std::size_t k = std::min(static_cast<std::size_t>(params.neighbours), pixels - 1);
  const Tree tree = make_tree(features);
  number_nodes(tree, graph);
  std::vector<std::uint32_t> found;
  if (k > 0) found = find_neighbours(tree, k);
  fill_rows(features, found, graph);
  return graph;
}

}  // namespace parian

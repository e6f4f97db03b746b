#include "transport/moments.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace parian {
namespace {

// Of what rows hold without any end to the samples.
constexpr double least_part = 1e-3;

// Sums over a node's samples. Rows are linear and in double precision: profiles fall by many orders
// of magnitude.
struct NodeSums {
  std::vector<double> moment;  // B[knot][channel] = sum flux a(r_k)
  std::vector<double> left;    // the same without what lies beyond supports
  std::vector<double> slope;   // sum flux a(r_k) d ln a / dr
  double weight = 0, x = 0, y = 0, z = 0, square = 0;
  double flux[3] = {0, 0, 0};
};

// What a sample that ends at `support` counts for at knot k: the hats' coefficients of a step that
// keep its integral over each segment, so that rows of many samples fall as these end.
double part_left(const std::vector<float>& knots, std::size_t k, float support) {
  if (support >= 0.999f * knots.back()) return 1;  // the edge of the node cuts it
  if (k + 1 < knots.size() && support >= knots[k + 1]) return 1;
  if (support >= knots[k]) {
    const double f = static_cast<double>((support - knots[k]) / (knots[k + 1] - knots[k]));
    return 0.5 * (1 + 2 * f - f * f);
  }
  if (k == 0 || support <= knots[k - 1]) return 0;
  const double f = static_cast<double>((support - knots[k - 1]) / (knots[k] - knots[k - 1]));
  return 0.5 * f * f;
}

void add_sample(NodeSums& sums, const MomentSources& sources, const std::vector<float>& knots,
                std::uint32_t i, bool rows) {
  const Emitters& emitters = sources.emitters;
  const Rgb& flux = sources.samples.flux[i];
  const double power[3] = {flux.x, flux.y, flux.z};
  const double x = emitters.position[0][i], y = emitters.position[1][i],
               z = emitters.position[2][i];
  const float* h = &emitters.rows[emitters.row[i] * emitters.row_size];
  // Nodes are seen from afar: samples weigh there as they do at a third of the knots.
  const std::size_t far = 3 * (knots.size() / 3);
  double w = 1e-30;
  for (std::size_t c = 0; c < 3; ++c) w += power[c] * std::exp(static_cast<double>(h[far + c]));
  sums.weight += w;
  sums.x += w * x;
  sums.y += w * y;
  sums.z += w * z;
  sums.square += w * (x * x + y * y + z * z);
  for (std::size_t c = 0; c < 3; ++c) sums.flux[c] += power[c];
  if (!rows) return;
  for (std::size_t k = 0; k < knots.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = 3 * k + c;
      const double a = power[c] * std::exp(static_cast<double>(h[at]));
      sums.moment[at] += a;
      sums.left[at] += a * part_left(knots, k, emitters.support[c][i]);
      if (k + 1 < knots.size())
        sums.slope[at] += a * static_cast<double>(h[at + 3] - h[at]) /
                          static_cast<double>(knots[k + 1] - knots[k]);
    }
}

void add_sums(NodeSums& sums, const NodeSums& child) {
  for (std::size_t j = 0; j < sums.moment.size(); ++j) {
    sums.moment[j] += child.moment[j];
    sums.left[j] += child.left[j];
    sums.slope[j] += child.slope[j];
  }
  sums.weight += child.weight;
  sums.x += child.x;
  sums.y += child.y;
  sums.z += child.z;
  sums.square += child.square;
  for (std::size_t c = 0; c < 3; ++c) {
    sums.flux[c] += child.flux[c];
  }
}

float log_or_nothing(double value) {
  return value > 0 ? std::max(log_of_nothing, static_cast<float>(std::log(value))) : log_of_nothing;
}

class NodeBuilder {
 public:
  NodeBuilder(const ProfileField& field, MomentSources& sources)
      : sources_(sources),
        knots_(field.knots_mm),
        samples_(sources.tree.order.size()),
        has_rows_(field.width > 1 || field.height > 1) {}

  // Sums of the node and all below it; writes their emitters. Big nodes work on both halves at
  // once.
  NodeSums build(std::uint32_t index) {
    const SourceNode& node = sources_.tree.nodes[index];
    NodeSums sums;
    NodeShape shape;
    std::fill_n(shape.min_support, 3, std::numeric_limits<float>::infinity());
    if (node.left == 0) {
      if (has_rows_) {
        sums.moment.assign(sources_.emitters.row_size, 0);
        sums.left.assign(sources_.emitters.row_size, 0);
        sums.slope.assign(sources_.emitters.row_size, 0);
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        add_sample(sums, sources_, knots_, i, has_rows_);
        for (std::size_t c = 0; c < 3; ++c) {
          const float support = sources_.emitters.support[c][i];
          shape.min_support[c] = std::min(shape.min_support[c], support);
          shape.max_support[c] = std::max(shape.max_support[c], support);
        }
      }
    } else {
      NodeSums halves[2];
      const std::uint32_t children[2] = {node.left, node.right};
      const auto build_half = [&](std::size_t i) { halves[i] = build(children[i]); };
      if (node.end - node.begin > 4096) {
        parallel_for(2, build_half);
      } else {
        build_half(0);
        build_half(1);
      }
      sums = std::move(halves[0]);
      add_sums(sums, halves[1]);
      for (std::uint32_t child : children)
        for (std::size_t c = 0; c < 3; ++c) {
          const NodeShape& part = sources_.shapes[child];
          shape.min_support[c] = std::min(shape.min_support[c], part.min_support[c]);
          shape.max_support[c] = std::max(shape.max_support[c], part.max_support[c]);
        }
    }
    write(index, sums, shape);
    return sums;
  }

 private:
  void write(std::uint32_t index, const NodeSums& sums, NodeShape shape) {
    Emitters& emitters = sources_.emitters;
    const std::size_t id = samples_ + index;
    const double x = sums.x / sums.weight, y = sums.y / sums.weight, z = sums.z / sums.weight;
    const double square = sums.square / sums.weight - (x * x + y * y + z * z);
    shape.spread_mm = static_cast<float>(std::sqrt(std::max(square, 0.0)));
    sources_.shapes[index] = shape;
    emitters.position[0][id] = static_cast<float>(x);
    emitters.position[1][id] = static_cast<float>(y);
    emitters.position[2][id] = static_cast<float>(z);
    // The extent along the line of sight as a uniform distribution.
    emitters.edge_width[id] = shape.spread_mm * std::sqrt(6.0f);
    emitters.spread[id] = 0.25f * shape.spread_mm * shape.spread_mm;
    for (std::size_t c = 0; c < 3; ++c) {
      emitters.support[c][id] = shape.max_support[c];
      emitters.log_flux[c][id] = has_rows_ ? 0 : log_or_nothing(sums.flux[c]);
    }
    emitters.row[id] = has_rows_ ? static_cast<std::uint32_t>(samples_ + 2 * index) : 0;
    sources_.whole_row[id] = has_rows_ ? emitters.row[id] + 1 : 0;
    if (!has_rows_) return;
    const std::size_t size = emitters.row_size;
    float* row = &emitters.rows[emitters.row[id] * size];
    float* slope = &sources_.slopes[index * size];
    for (std::size_t j = 0; j < size; ++j) {
      // Where all have ended, the edge cuts; until then the row must not plunge.
      row[j] = log_or_nothing(std::max(sums.left[j], least_part * sums.moment[j]));
      row[size + j] = log_or_nothing(sums.moment[j]);
      slope[j] = sums.moment[j] > 0 ? static_cast<float>(sums.slope[j] / sums.moment[j]) : 0;
    }
  }

  MomentSources& sources_;
  const std::vector<float>& knots_;
  std::size_t samples_;
  bool has_rows_;  // false: homogeneous, all share one
};

// Slopes of the one row that all share.
void fill_slopes(MomentSources& sources, const std::vector<float>& knots) {
  const AlignedVector<float>& h = sources.emitters.rows;
  for (std::size_t at = 0; at < sources.slopes.size(); ++at)
    sources.slopes[at] = at + 3 < sources.slopes.size()
                             ? (h[at + 3] - h[at]) / (knots[at / 3 + 1] - knots[at / 3])
                             : 0;
}

}  // namespace

MomentSources make_moment_sources(const ProfileField& field, const GatherSources& sources,
                                  bool with_nodes) {
  MomentSources result;
  result.tree = make_source_tree(sources);
  const std::size_t samples = result.tree.order.size(), nodes = result.tree.nodes.size();
  resize(result.emitters, samples + (with_nodes ? nodes : 0));
  set_samples(result.emitters, field, sources, result.tree.order);
  result.samples.area_mm2 = sources.area_mm2;
  for (std::uint32_t i : result.tree.order) {
    result.samples.normal.push_back(sources.points[i].normal);
    result.samples.flux.push_back(sources.flux[i]);
  }
  if (!with_nodes || samples == 0) return result;
  result.shapes.resize(nodes);
  const bool homogeneous = field.width == 1 && field.height == 1;
  result.whole_row = result.emitters.row;
  result.emitters.rows.resize((homogeneous ? 1 : samples + 2 * nodes) * field.row());
  result.slopes.resize((homogeneous ? 1 : nodes) * field.row());
  if (homogeneous) fill_slopes(result, field.knots_mm);
  NodeBuilder(field, result).build(0);
  return result;
}

}  // namespace parian

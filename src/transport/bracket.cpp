#include "transport/bracket.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "math/fast_math.h"

namespace parian {
namespace {

// Sums of many floats differ from exact arithmetic by less than this, relatively.
constexpr double rounding = 2e-5;

// A node's bounds at the distances of one chunk: nearest and farthest to its box.
struct Distances {
  alignas(64) std::array<float, gather_chunk * lanes> nearest, farthest, middle;
};

void eval_box_distances(const MomentSources& sources, const std::uint32_t* nodes, std::size_t count,
                        const TargetBlock& block, Distances& distances) {
  constexpr float slack = 1e-6f;  // the distances themselves are rounded
  for (std::size_t i = 0; i < count; ++i) {
    const Bounds3& box = sources.tree.nodes[nodes[i]].box;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const Vec3 target{block.x[lane], block.y[lane], block.z[lane]};
      distances.nearest[i * lanes + lane] = min_distance(box, target) * (1 - slack);
      distances.farthest[i * lanes + lane] = max_distance(box, target) * (1 + slack);
    }
  }
}

// ln of a lower bound of h_o + L + ln flux at distances r. L is the logarithm of a sum of
// exponentials in each segment, so convex there: above its tangent at the segment's first knot; and
// it falls, so above its value at the second. Nothing where a sample may be cut off.
void eval_lower_logs(const MomentSources& sources, const KnotView& lookup,
                     const std::uint32_t* nodes, std::size_t count, const TargetBlock& block,
                     const float* r, float* out) {
  const Emitters& emitters = sources.emitters;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t id = emitter_of(sources, nodes[i]);
    const float* whole = sources.shapes[nodes[i]].min_support;
    const std::size_t row = sources.whole_row[id] * emitters.row_size;
    const std::size_t slopes =
        sources.slopes.size() == emitters.row_size ? 0 : nodes[i] * emitters.row_size;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const float distance = r[i * lanes + lane];
      const std::int32_t k = find_segment(lookup, std::min(distance, lookup.last));
      const float beyond = std::min(distance, lookup.last) - lookup.knots[k];
      const float t = beyond * lookup.inverse_step[k];
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = 3 * static_cast<std::size_t>(k) + c, j = row + at;
        const float* target = &block.half_log[at * lanes + lane];
        const float tangent = emitters.rows[j] + sources.slopes[slopes + at] * beyond;
        const float value = std::max(tangent, emitters.rows[j + 3]) + target[0] +
                            t * (target[3 * lanes] - target[0]) + emitters.log_flux[c][id];
        const bool cut = distance > whole[c] || distance > block.support[c][lane];
        out[(i * 3 + c) * lanes + lane] = cut ? log_of_nothing : value;
      }
    }
  }
}

// Exact contributions of samples as a bracket without width.
Bracket bracket_samples(const MomentSources& sources, const KnotLookup& lookup,
                        const SourceNode& leaf, const TargetBlock& block) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) ids.push_back(i);
  Bracket bracket;
  add_far(view(sources.emitters), view(lookup), ids, block, bracket.estimate);
  bracket.lower = bracket.upper = bracket.estimate;
  return bracket;
}

// What is left to refine: widest first, ties by the node's index.
struct Entry {
  double width;
  std::uint32_t node;
  Bracket bracket;
  friend bool operator<(const Entry& a, const Entry& b) {
    return a.width < b.width || (a.width == b.width && a.node > b.node);
  }
};

// Largest width of the part, relative to the whole exitance.
double relative_width(const Bracket& part, const Bracket& sum, const BlockSums& fixed, int count) {
  double width = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
      const std::size_t j = c * lanes + lane;
      const double whole = fixed[j] + sum.estimate[j];
      if (whole > 0) width = std::max(width, (part.upper[j] - part.lower[j]) / whole);
    }
  return width;
}

}  // namespace

void add(Bracket& sum, const Bracket& part, double sign) {
  for (std::size_t j = 0; j < sum.estimate.size(); ++j) {
    sum.estimate[j] += sign * part.estimate[j];
    sum.lower[j] += sign * part.lower[j];
    sum.upper[j] += sign * part.upper[j];
  }
}

void bracket_nodes(const MomentSources& sources, const KnotLookup& lookup,
                   const std::vector<std::uint32_t>& nodes, const TargetBlock& block,
                   std::vector<Bracket>& out) {
  const BlockView targets = view(block);
  const EmitterView emitters = view(sources.emitters);
  EmitterView whole = emitters;
  whole.row = sources.whole_row.data();
  out.resize(nodes.size());
  Distances distances;
  alignas(64) std::array<float, gather_chunk * 3 * lanes> estimate, lower, upper;
  std::array<std::uint32_t, gather_chunk> ids{};
  for (std::size_t begin = 0; begin < nodes.size(); begin += gather_chunk) {
    const std::size_t count = std::min(gather_chunk, nodes.size() - begin);
    for (std::size_t i = 0; i < count; ++i) ids[i] = emitter_of(sources, nodes[begin + i]);
    eval_box_distances(sources, &nodes[begin], count, block, distances);
    eval_distances(emitters, ids.data(), count, targets, distances.middle.data());
    eval_logs(emitters, view(lookup), ids.data(), count, targets, distances.middle.data(),
              NodeExtent::second_order, estimate.data());
    eval_logs(whole, view(lookup), ids.data(), count, targets, distances.nearest.data(),
              NodeExtent::point, upper.data());
    eval_lower_logs(sources, view(lookup), &nodes[begin], count, block, distances.farthest.data(),
                    lower.data());
    for (auto* logs : {&estimate, &lower, &upper})
      exp_array(logs->data(), logs->data(), count * 3 * lanes);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < 3 * lanes; ++j) {
        Bracket& bracket = out[begin + i];
        const std::size_t from = i * 3 * lanes + j;
        bracket.lower[j] = static_cast<double>(lower[from]) * (1 - rounding);
        bracket.upper[j] = static_cast<double>(upper[from]) * (1 + rounding);
        bracket.estimate[j] =
            std::clamp(static_cast<double>(estimate[from]), bracket.lower[j], bracket.upper[j]);
      }
  }
}

double half_widths(const Bracket& sum, const BlockSums& fixed, int count, double* half_width) {
  double largest = 0;
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
    half_width[lane] = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t j = c * lanes + lane;
      const double width = std::max(sum.upper[j] - sum.estimate[j], sum.estimate[j] - sum.lower[j]);
      const double whole = fixed[j] + sum.estimate[j];
      if (whole > 0 && width > 0) half_width[lane] = std::max(half_width[lane], width / whole);
    }
    largest = std::max(largest, half_width[lane]);
  }
  return largest;
}

Bracket refine(const MomentSources& sources, const KnotLookup& lookup,
               const std::vector<std::uint32_t>& nodes, const TargetBlock& block,
               const BlockSums& fixed, double tolerance, std::size_t& evaluations) {
  std::priority_queue<Entry> queue;
  Bracket sum;
  std::vector<Bracket> brackets;
  bracket_nodes(sources, lookup, nodes, block, brackets);
  evaluations += nodes.size();
  for (const Bracket& bracket : brackets) add(sum, bracket, 1);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    queue.push({relative_width(brackets[i], sum, fixed, block.count), nodes[i], brackets[i]});
  double half_width[lanes];
  while (!queue.empty() && half_widths(sum, fixed, block.count, half_width) > tolerance) {
    // Several at once: the queue's order changes little from one to the next.
    const std::size_t batch = std::max<std::size_t>(4, queue.size() / 32);
    std::vector<std::uint32_t> children;
    for (std::size_t i = 0; i < batch && !queue.empty(); ++i) {
      const Entry entry = queue.top();
      queue.pop();
      add(sum, entry.bracket, -1);
      const SourceNode& node = sources.tree.nodes[entry.node];
      if (node.left == 0) {
        add(sum, bracket_samples(sources, lookup, node, block), 1);
        evaluations += node.end - node.begin;
      } else {
        children.push_back(node.left);
        children.push_back(node.right);
      }
    }
    bracket_nodes(sources, lookup, children, block, brackets);
    evaluations += children.size();
    for (const Bracket& bracket : brackets) add(sum, bracket, 1);
    for (std::size_t i = 0; i < children.size(); ++i)
      queue.push({relative_width(brackets[i], sum, fixed, block.count), children[i], brackets[i]});
  }
  return sum;
}

}  // namespace parian

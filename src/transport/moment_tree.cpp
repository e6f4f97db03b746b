#include "transport/moment_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "math/fast_log.h"
#include "transport/bracket.h"

namespace parian {
namespace {

// Spread in units of the knots' distance from which a row's end says nothing of the whole node.
constexpr float wide_node = 2.5f;

// Targets for which one decision is made: a block, or the blocks of a group.
struct Region {
  Bounds3 box;
  float max_support = 0;
  float min_support[3];         // per channel
  std::vector<float> envelope;  // [knot][channel], the largest h of the targets
};

Region make_region(const TargetBlock* blocks, std::size_t count, std::size_t knots) {
  Region region;
  std::fill_n(region.min_support, 3, std::numeric_limits<float>::infinity());
  region.envelope.assign(3 * knots, -std::numeric_limits<float>::infinity());
  for (std::size_t b = 0; b < count; ++b) {
    const TargetBlock& block = blocks[b];
    extend(region.box, block.box.lower);
    extend(region.box, block.box.upper);
    region.max_support = std::max(region.max_support, block.max_support);
    for (std::size_t c = 0; c < 3; ++c)
      for (float support : block.support[c])
        region.min_support[c] = std::min(region.min_support[c], support);
    for (std::size_t j = 0; j < region.envelope.size(); ++j)
      for (std::size_t lane = 0; lane < lanes; ++lane)
        region.envelope[j] = std::max(region.envelope[j], block.half_log[j * lanes + lane]);
  }
  return region;
}

// When a node may stand for its samples.
struct Opening {
  bool coarse = false;              // for a first estimate of the exitance
  float log_budget[3] = {0, 0, 0};  // ln of the error allowed to a node
  double near_mm = 0;
};

// What a walk finds.
struct Found {
  std::vector<std::uint32_t> nodes;      // may stand for their samples
  std::vector<std::uint32_t> undecided;  // small beside the region: to be decided block by block
  EmitterLists samples;
};

class Walk {
 public:
  Walk(const MomentSources& sources, const KnotLookup& lookup, const Region& region)
      : sources_(sources), lookup_(view(lookup)), region_(region) {}

  // From the given nodes down. Nodes whose spread is below `undecided_mm` are left undecided
  // instead of opened.
  void run(const Opening& opening, const std::vector<std::uint32_t>& start, float undecided_mm,
           Found& found) const {
    const float reach = std::max(static_cast<float>(opening.near_mm), region_.max_support);
    const auto near = static_cast<float>(opening.near_mm);
    std::vector<std::uint32_t> stack(start.rbegin(), start.rend());
    while (!stack.empty()) {
      const std::uint32_t index = stack.back();
      stack.pop_back();
      const SourceNode& node = sources_.tree.nodes[index];
      const float gap = box_distance(node.box, region_.box);
      if (gap > reach) continue;
      if (gap >= near && accepts(opening, index, gap)) {
        found.nodes.push_back(index);
      } else if (sources_.shapes[index].spread_mm < undecided_mm) {
        found.undecided.push_back(index);
      } else if (node.left == 0) {
        list_samples(node, gap < near, found.samples);
      } else {
        stack.push_back(node.right);
        stack.push_back(node.left);
      }
    }
  }

 private:
  // Second-order error of taking all samples at their centroid: 1/2 spread^2 (s^2 + s / r) with s
  // the steepness of ln R there; the first order cancels.
  bool accepts(const Opening& opening, std::uint32_t index, float gap) const {
    const Emitters& emitters = sources_.emitters;
    const NodeShape& shape = sources_.shapes[index];
    const std::uint32_t id = emitter_of(sources_, index);
    const Vec3 centroid{emitters.position[0][id], emitters.position[1][id],
                        emitters.position[2][id]};
    // A coarse walk does not go into what is smaller than the region.
    const float least = opening.coarse ? 0.5f * diagonal(region_.box) : gap;
    const float r = std::min(std::max(min_distance(region_.box, centroid), least), lookup_.last);
    if (opening.coarse && shape.spread_mm > 0.6f * r) return false;
    const float spread2 = shape.spread_mm * shape.spread_mm;
    const std::int32_t k = find_segment(lookup_, r);
    const float beyond = r - lookup_.knots[k], t = beyond * lookup_.inverse_step[k];
    const float* row = &emitters.rows[emitters.row[id] * emitters.row_size];
    const float* whole = &emitters.rows[sources_.whole_row[id] * emitters.row_size];
    const float nearest = std::max(r - 2 * shape.spread_mm, 0.0f);
    const std::int32_t near_k = find_segment(lookup_, nearest);
    const float near_t = (nearest - lookup_.knots[near_k]) * lookup_.inverse_step[near_k];
    for (std::size_t c = 0; c < 3; ++c) {
      if (r - 2 * shape.spread_mm > shape.max_support[c]) continue;
      const bool is_cut =
          r + 2 * shape.spread_mm > std::min(shape.min_support[c], region_.min_support[c]);
      const std::size_t at = 3 * static_cast<std::size_t>(k) + c;
      const float y0 = row[at] + region_.envelope[at];
      const float y1 = row[at + 3] + region_.envelope[at + 3];
      const float steepness = std::max((y0 - y1) * lookup_.inverse_step[k], 0.0f);
      const float second = 0.5f * spread2 * steepness * (steepness + 1 / (r + 1e-6f));
      float error = second + second * second + 1e-9f;  // the square: higher orders
      if (opening.coarse) {
        if (error > 0.5f && !is_cut) return false;
        continue;
      }
      float log_value = y0 + t * (y1 - y0) + emitters.log_flux[c][id];
      if (is_cut) {
        error = std::max(error, 0.5f);
        // Among knots far closer than the node is wide the row may have plunged here, while samples
        // nearer by have not ended: what all would give here, or what is left gives there.
        if (shape.spread_mm * lookup_.inverse_step[k] > wide_node)
          log_value = std::max(
              log_value, std::min(value_at(whole, c, k, t), value_at(row, c, near_k, near_t)) +
                             emitters.log_flux[c][id]);
      }
      if (log_value + fast_log(error) > opening.log_budget[c]) return false;
    }
    return true;
  }

  // Of a row and the envelope, at the part t of segment k.
  float value_at(const float* row, std::size_t c, std::int32_t k, float t) const {
    const std::size_t at = 3 * static_cast<std::size_t>(k) + c;
    const float y0 = row[at] + region_.envelope[at];
    const float y1 = row[at + 3] + region_.envelope[at + 3];
    return y0 + t * (y1 - y0);
  }

  const MomentSources& sources_;
  KnotView lookup_;
  const Region& region_;
};

std::vector<std::uint32_t> emitters_of(const MomentSources& sources,
                                       const std::vector<std::uint32_t>& nodes) {
  std::vector<std::uint32_t> ids;
  ids.reserve(nodes.size());
  for (std::uint32_t node : nodes) ids.push_back(emitter_of(sources, node));
  return ids;
}

// Where the results of blocks go.
struct Output {
  TreeGatherResult& result;
  std::vector<std::size_t>& evaluations;  // per block
};

// Brackets of all nodes together, around an estimate made before.
Bracket bracket_sum(const MomentSources& sources, const KnotLookup& lookup,
                    const std::vector<std::uint32_t>& nodes, const TargetBlock& block,
                    const BlockSums& estimate) {
  std::vector<Bracket> brackets;
  bracket_nodes(sources, lookup, nodes, block, brackets);
  Bracket sum;
  for (const Bracket& bracket : brackets) add(sum, bracket);
  sum.estimate = estimate;
  return sum;
}

}  // namespace

struct MomentTree::Impl {
  ProfileField field;
  KnotLookup lookup;
  MomentSources sources;

  BlockSums sum_of(const std::vector<std::uint32_t>& ids, const TargetBlock& block) const {
    BlockSums sums{};
    add_far(view(sources.emitters), view(lookup), ids, block, sums);
    return sums;
  }

  std::vector<std::array<double, 3>> estimate_exitance(const TargetBlock* blocks, std::size_t count,
                                                       const Region& region) const;
  void gather_group(const TargetBlock* blocks, std::size_t count, std::size_t first, double near_mm,
                    const TreeGatherParams& params, const Output& output) const;
  void gather_block(const TargetBlock& block, std::size_t index, double near_mm,
                    const TreeGatherParams& params, const Found& found, const Output& output) const;
};

// Per block the smallest exitance of its targets in each channel, by a coarse walk for all of them.
std::vector<std::array<double, 3>> MomentTree::Impl::estimate_exitance(const TargetBlock* blocks,
                                                                       std::size_t count,
                                                                       const Region& region) const {
  Opening opening;
  opening.coarse = true;
  Found found;
  Walk(sources, lookup, region).run(opening, {0}, 0, found);
  const std::vector<std::uint32_t> ids = emitters_of(sources, found.nodes);
  found.samples.far.insert(found.samples.far.end(), ids.begin(), ids.end());
  std::vector<std::array<double, 3>> least(count);
  for (std::size_t b = 0; b < count; ++b) {
    const BlockSums sums = sum_of(found.samples.far, blocks[b]);
    for (std::size_t c = 0; c < 3; ++c)
      least[b][c] = *std::min_element(&sums[c * lanes], &sums[c * lanes] + blocks[b].count);
  }
  return least;
}

void MomentTree::Impl::gather_group(const TargetBlock* blocks, std::size_t count, std::size_t first,
                                    double near_mm, const TreeGatherParams& params,
                                    const Output& output) const {
  const Region region = make_region(blocks, count, field.knots());
  const std::vector<std::array<double, 3>> least = estimate_exitance(blocks, count, region);
  Opening opening;
  opening.near_mm = near_mm;
  const auto set_budget = [&](std::size_t c, double exitance) {
    opening.log_budget[c] =
        static_cast<float>(std::log(std::max(params.quality * exitance, 1e-37)));
  };
  for (std::size_t c = 0; c < 3; ++c) {
    double smallest = least[0][c];
    for (const auto& of_block : least) smallest = std::min(smallest, of_block[c]);
    set_budget(c, smallest);
  }
  Found common;
  Walk(sources, lookup, region).run(opening, {0}, 1.0f * diagonal(region.box), common);
  for (std::size_t b = 0; b < count; ++b) {
    for (std::size_t c = 0; c < 3; ++c) set_budget(c, least[b][c]);
    Found found{common.nodes, {}, common.samples};
    const Region own = make_region(blocks + b, 1, field.knots());
    Walk(sources, lookup, own).run(opening, common.undecided, 0, found);
    gather_block(blocks[b], first + b, near_mm, params, found, output);
  }
}

void MomentTree::Impl::gather_block(const TargetBlock& block, std::size_t index, double near_mm,
                                    const TreeGatherParams& params, const Found& found,
                                    const Output& output) const {
  const EmitterLists& samples = found.samples;
  BlockSums exact = sum_of(samples.far, block);
  if (near_mm > 0)
    add_near(view(sources.emitters), view(lookup), sources.samples, samples.near, block,
             field.knots_mm, near_mm, exact.data());
  std::size_t& evaluations = output.evaluations[index];
  evaluations = samples.far.size() + samples.near.size();
  double half_width[lanes];
  std::fill_n(half_width, lanes, -1.0);
  BlockSums far{};
  if (params.tolerance > 0) {
    const Bracket bracket =
        refine(sources, lookup, found.nodes, block, exact, params.tolerance, evaluations);
    half_widths(bracket, exact, block.count, half_width);
    far = bracket.estimate;
  } else {
    far = sum_of(emitters_of(sources, found.nodes), block);
    evaluations += found.nodes.size();
    const bool certify = field.monotone && params.certify_every > 0 &&
                         index % static_cast<std::size_t>(params.certify_every) == 0;
    if (certify)
      half_widths(bracket_sum(sources, lookup, found.nodes, block, far), exact, block.count,
                  half_width);
  }
  for (std::size_t j = 0; j < exact.size(); ++j) exact[j] += far[j];
  store_sums(block, exact, output.result.exitance);
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(block.count); ++lane)
    output.result.half_width[block.index[lane]] = static_cast<float>(half_width[lane]);
}

MomentTree::MomentTree(const ProfileField& field, const GatherSources& sources)
    : impl_(std::make_unique<Impl>()) {
  PARIAN_CHECK_EQ(sources.points.size(), sources.flux.size());
  impl_->field = field;
  impl_->lookup = make_knot_lookup(field.knots_mm);
  impl_->sources = make_moment_sources(field, sources, /*with_nodes=*/true);
}
MomentTree::~MomentTree() = default;
MomentTree::MomentTree(MomentTree&&) noexcept = default;
MomentTree& MomentTree::operator=(MomentTree&&) noexcept = default;

TreeGatherResult MomentTree::gather(const std::vector<GatherPoint>& targets, double near_mm,
                                    const TreeGatherParams& params,
                                    const Progress& progress) const {
  if (params.tolerance > 0 && !impl_->field.monotone)
    throw Error({{},
                 "tolerance",
                 "profiles that fall everywhere, without which no bracket holds",
                 "a map that was fitted with --no-monotone"});
  TreeGatherResult result;
  result.exitance.resize(targets.size());
  result.half_width.assign(targets.size(), -1.0f);
  if (targets.empty() || impl_->sources.tree.order.empty()) return result;
  std::vector<std::size_t> evaluations((targets.size() + lanes - 1) / lanes);
  for_each_group(
      impl_->field, targets, progress, "gather",
      [&](const TargetBlock* blocks, std::size_t count, std::size_t first) {
        impl_->gather_group(blocks, count, first, near_mm, params, {result, evaluations});
      });
  double total = 0;
  for (std::size_t count : evaluations) total += static_cast<double>(count);
  result.nodes_per_target = total / static_cast<double>(evaluations.size());
  for (float width : result.half_width) {
    if (width < 0) continue;
    ++result.certified;
    result.max_half_width = std::max(result.max_half_width, static_cast<double>(width));
    result.mean_half_width += static_cast<double>(width);
  }
  if (result.certified > 0) result.mean_half_width /= static_cast<double>(result.certified);
  return result;
}

std::size_t MomentTree::bytes() const {
  const MomentSources& sources = impl_->sources;
  return sources.emitters.size() * (3 * 3 * sizeof(float) + sizeof(std::uint32_t)) +
         (sources.emitters.rows.size() + sources.slopes.size()) * sizeof(float) +
         sources.tree.nodes.size() * (sizeof(SourceNode) + sizeof(NodeShape)) +
         sources.samples.normal.size() * (sizeof(Vec3) + sizeof(Rgb));
}

}  // namespace parian

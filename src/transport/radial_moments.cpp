#include "transport/radial_moments.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "transport/interval_table.h"
#include "transport/radial_bound.h"
#include "transport/radial_near.h"
#include "transport/radial_nodes.h"
#include "transport/target_block.h"

namespace parian {
namespace {

// What a block of targets sees, in arrays that the kernels read.
struct Emission {
  std::array<std::vector<float>, node_fields> node;
  AlignedVector<Flux> node_flux;
  AlignedVector<ChannelOffsets> node_offset;
  std::vector<std::uint32_t> node_id;
  std::array<std::vector<float>, 3> sample;
  AlignedVector<Flux> sample_flux;  // and area
  std::vector<Vec3> sample_normal;

  void clear() {
    for (auto& field : node) field.clear();
    for (auto& field : sample) field.clear();
    node_flux.clear();
    node_offset.clear();
    node_id.clear();
    sample_flux.clear();
    sample_normal.clear();
  }
};

// Moments of t in each interval, and of what lies beyond; see add_moment.
struct IntervalSums {
  std::vector<std::array<Flux, 3>, CacheLineAllocator<std::array<Flux, 3>>> value;

  explicit IntervalSums(const IntervalTable& table) : value(table.end.size() + 1) {}
  void clear() { std::fill(value.begin(), value.end(), std::array<Flux, 3>{}); }
  Flux (*data())[3] { return reinterpret_cast<Flux(*)[3]>(value.data()); }
};

// sum_i c_i[p] moment[p] of the intervals where a function is not 0.
void add_functions(const IntervalTable& table, const IntervalSums& sums, Flux* function) {
  for (std::size_t k = 0; k < table.end.size(); ++k)
    for (std::size_t i = 0; i <= static_cast<std::size_t>(table.degree); ++i)
      for (std::size_t p = 0; p <= static_cast<std::size_t>(table.degree); ++p)
        function[k + i] += table.c[k][i][p] * sums.value[k][p];
}

struct Buffers {
  Emission emission;
  std::vector<std::uint32_t> stack;
  std::array<std::vector<float>, 8> values;  // NodeView, and t of both places
  std::array<std::vector<int>, 2> intervals;
  IntervalSums far, near, own;  // own: of the near term
  AlignedVector<Flux> functions;
  NearSums near_sums;

  explicit Buffers(const IntervalTable& table) : far(table), near(table), own(table) {}
  void resize(std::size_t count) {
    for (auto& value : values) value.resize(count);
    for (auto& value : intervals) value.resize(count);
  }
};

struct Work {
  const GatherSources& sources;
  const std::vector<GatherPoint>& targets;
  RadialNodes nodes;
  IntervalTable table;
  NearTerm near;
  float opening;
  const BasisPeaks* peaks;  // null: nothing is certified

  void add_node(std::size_t node, Emission& out) const {
    for (std::size_t f = 0; f < node_fields; ++f) out.node[f].push_back(nodes.field[f][node]);
    out.node_flux.push_back(nodes.flux[node]);
    out.node_offset.push_back(nodes.offset[node]);
    out.node_id.push_back(static_cast<std::uint32_t>(node));
  }

  void add_samples(const SourceNode& node, Emission& out) const {
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::uint32_t id = nodes.tree.order[i];
      const Vec3 x = sources.points[id].position;
      const Rgb flux = sources.flux[id];
      out.sample[0].push_back(x.x);
      out.sample[1].push_back(x.y);
      out.sample[2].push_back(x.z);
      out.sample_flux.push_back(Flux{flux.x, flux.y, flux.z, static_cast<float>(sources.area_mm2)});
      out.sample_normal.push_back(sources.points[id].normal);
    }
  }

  void collect(const Bounds3& box, Buffers& buffers) const {
    Emission& out = buffers.emission;
    out.clear();
    buffers.stack.assign(1, 0);
    while (!buffers.stack.empty()) {
      const std::uint32_t n = buffers.stack.back();
      buffers.stack.pop_back();
      const SourceNode& node = nodes.tree.nodes[n];
      const float distance = box_distance(box, node.box);
      if (distance > table.reach) continue;
      if (distance >= near.radius_mm && nodes.diameter_mm[n] <= opening * distance) {
        add_node(n, out);
      } else if (node.left == 0) {
        add_samples(node, out);
      } else {
        buffers.stack.push_back(node.right);
        buffers.stack.push_back(node.left);
      }
    }
    buffers.resize(std::max(out.node_flux.size(), out.sample_flux.size()));
  }

  void see_nodes(const float* at, Buffers& buffers) const {
    const Emission& seen = buffers.emission;
    const float* field[node_fields];
    for (std::size_t f = 0; f < node_fields; ++f) field[f] = seen.node[f].data();
    auto& v = buffers.values;
    const NodeView view{v[0].data(), v[1].data(), v[2].data(),
                        v[3].data(), v[4].data(), v[5].data()};
    const Places first{view.near_mm, buffers.intervals[0].data(), v[6].data()};
    const Places second{view.far_mm, buffers.intervals[1].data(), v[7].data()};
    const std::size_t count = seen.node_flux.size();
    find_node_distances(field, count, at, &view);
    find_places(&table, count, &first);
    find_places(&table, count, &second);
    add_nodes(&view, &first, &second, seen.node_offset.data(), seen.node_flux.data(), count,
              table.degree, buffers.near.data(), buffers.far.data());
  }

  // After see_nodes, of whose points the ranges are widened.
  void bound_nodes(Vec3 target, const Buffers& buffers, float* bound) const {
    const Emission& seen = buffers.emission;
    std::vector<double> ranges(table.functions);
    for (std::size_t i = 0; i < seen.node_id.size(); ++i) {
      const Bounds3& box = nodes.tree.nodes[seen.node_id[i]].box;
      const auto [nearest, farthest] = distance_range(target, box);
      find_ranges(*peaks, std::min(nearest, buffers.values[0][i]),
                  std::max(farthest, buffers.values[1][i]), ranges);
      for (std::size_t j = 0; j < table.functions; ++j)
        for (std::size_t c = 0; c < 3; ++c)
          bound[3 * j + c] +=
              static_cast<float>(ranges[j]) * seen.node_flux[i][static_cast<long>(c)];
    }
  }

  void see_samples(const float* at, Vec3 normal, Buffers& buffers) const {
    const Emission& seen = buffers.emission;
    const float* position[3] = {seen.sample[0].data(), seen.sample[1].data(),
                                seen.sample[2].data()};
    const Places places{buffers.values[0].data(), buffers.intervals[0].data(),
                        buffers.values[1].data()};
    const std::size_t count = seen.sample_flux.size();
    find_sample_distances(position, count, at, places.distance);
    find_places(&table, count, &places);
    for (std::size_t i = 0; i < count; ++i) {
      const float r = places.distance[i];
      Flux flux = seen.sample_flux[i];
      if (r < near.radius_mm && dot(seen.sample_normal[i], normal) > 0) {
        const Flux own = near_weight(r, near.radius_mm) * flux;
        buffers.near_sums.mean += near_weight(r, near.mean_mm) * flux;
        flux -= own;
        add_moment(places.interval[i], places.t[i], own, table.degree, buffers.own.data());
      }
      add_moment(places.interval[i], places.t[i], flux, table.degree, buffers.near.data());
    }
  }

  // `bound` may be null.
  void run(std::size_t index, Buffers& buffers, float* out, float* bound) const {
    const GatherPoint& target = targets[index];
    const float at[3] = {target.position.x, target.position.y, target.position.z};
    buffers.far.clear();
    buffers.near.clear();
    buffers.own.clear();
    buffers.near_sums.mean = Flux{};
    see_nodes(at, buffers);
    if (bound != nullptr) bound_nodes(target.position, buffers, bound);
    see_samples(at, target.normal, buffers);
    buffers.functions.assign(table.functions, Flux{});
    add_functions(table, buffers.near, buffers.functions.data());
    add_functions(table, buffers.far, buffers.functions.data());
    buffers.near_sums.scattered.assign(table.functions, Flux{});
    add_functions(table, buffers.own, buffers.near_sums.scattered.data());
    for (std::size_t j = 0; j < table.functions; ++j) {
      const Rgb value = near_value(near, j, buffers.near_sums);
      out[3 * j] = buffers.functions[j][0] + value.x;
      out[3 * j + 1] = buffers.functions[j][1] + value.y;
      out[3 * j + 2] = buffers.functions[j][2] + value.z;
    }
  }
};

}  // namespace

ParamList describe(RadialMomentParams& params) {
  return {{.name = "opening",
           .help = "size of a node over its distance up to which it is taken as a whole; 0: never",
           .target = &params.opening,
           .min = 0,
           .max = 1}};
}

RadialMoments compute_radial_moments(const SplineBasis& basis, const GatherSources& sources,
                                     const std::vector<GatherPoint>& targets, double near_mm,
                                     const RadialMomentParams& params_, const Progress& progress) {
  RadialMomentParams params = params_;
  check(describe(params));
  PARIAN_CHECK_EQ(sources.points.size(), sources.flux.size());
  RadialMoments moments;
  moments.value.assign(targets.size() * basis.size() * 3, 0.0f);
  if (targets.empty() || sources.points.empty()) return moments;
  const BasisPeaks peaks = params.certify ? find_peaks(basis) : BasisPeaks{};
  const Work work{sources,
                  targets,
                  make_radial_nodes(sources),
                  make_interval_table(basis),
                  make_near_term(basis, near_mm, sources.area_mm2),
                  static_cast<float>(params.opening),
                  params.certify ? &peaks : nullptr};
  if (params.certify) moments.bound.assign(moments.value.size(), 0.0f);
  const std::vector<std::uint32_t> order = order_targets(targets);
  constexpr std::size_t together = static_cast<std::size_t>(lanes), batch = 32 * together;
  std::vector<double> evaluated((order.size() + batch - 1) / batch, 0.0);
  constexpr std::size_t stage = 128 * batch;  // between reports
  for (std::size_t start = 0; start < order.size(); start += stage) {
    advance_progress(progress, "multiple scattering",
                     static_cast<double>(start) / static_cast<double>(order.size()));
    const std::size_t count = std::min(stage, order.size() - start);
    parallel_for_blocks(count, batch, [&](std::size_t begin, std::size_t end) {
      Buffers buffers(work.table);
      for (std::size_t i = start + begin; i < start + end; i += together) {
        const std::size_t last = std::min(i + together, start + end);
        Bounds3 box;
        for (std::size_t k = i; k < last; ++k) extend(box, targets[order[k]].position);
        work.collect(box, buffers);
        evaluated[(start + begin) / batch] +=
            static_cast<double>(last - i) *
            static_cast<double>(buffers.emission.node_flux.size() +
                                buffers.emission.sample_flux.size());
        for (std::size_t k = i; k < last; ++k)
          work.run(order[k], buffers, &moments.value[order[k] * basis.size() * 3],
                   params.certify ? &moments.bound[order[k] * basis.size() * 3] : nullptr);
      }
    });
  }
  double sum = 0;
  for (const double count : evaluated) sum += count;
  moments.nodes_per_target = sum / static_cast<double>(targets.size());
  advance_progress(progress, "multiple scattering", 1);
  return moments;
}

}  // namespace parian

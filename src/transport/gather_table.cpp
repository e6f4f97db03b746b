#include "transport/gather_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/check.h"
#include "base/parallel.h"
#include "transport/near_term.h"
#include "transport/table_window_internal.h"

namespace parian {
namespace {

constexpr std::size_t block_size = 512;  // targets that share their sources' windows

// Sources by the cells of a uniform grid.
struct SourceGrid {
  Vec3 lower;
  float cell = 1;
  int size[3] = {1, 1, 1};
  std::vector<std::size_t> begin;  // of each cell in order
  std::vector<std::uint32_t> order;

  int cell_of(float position, int axis) const {
    const float low = axis == 0 ? lower.x : axis == 1 ? lower.y : lower.z;
    const float place = std::floor((position - low) / cell);
    return static_cast<int>(std::clamp(place, 0.0f, static_cast<float>(size[axis] - 1)));
  }
  std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(
        (static_cast<long>(z) * size[1] + static_cast<long>(y)) * size[0] + x);
  }
};

SourceGrid make_grid(const std::vector<TableGatherPoint>& points, double range) {
  SourceGrid grid;
  Bounds3 box;
  for (const TableGatherPoint& point : points) extend(box, point.position);
  grid.lower = box.lower;
  const Vec3 size = extent(box);
  // Cells of a third of the range, but no more of them than there are points, roughly.
  const double longest = std::max({size.x, size.y, size.z, 1e-6f});
  grid.cell = static_cast<float>(std::max(range / 3, longest / 128));
  const float sides[3] = {size.x, size.y, size.z};
  for (int axis = 0; axis < 3; ++axis)
    grid.size[axis] = static_cast<int>(sides[axis] / grid.cell) + 1;
  const auto cell_of = [&](const TableGatherPoint& point) {
    return grid.index(grid.cell_of(point.position.x, 0), grid.cell_of(point.position.y, 1),
                      grid.cell_of(point.position.z, 2));
  };
  const std::size_t cells = grid.index(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1) + 1;
  grid.begin.assign(cells + 1, 0);
  for (const TableGatherPoint& point : points) ++grid.begin[cell_of(point) + 1];
  std::partial_sum(grid.begin.begin(), grid.begin.end(), grid.begin.begin());
  std::vector<std::size_t> next(grid.begin.begin(), grid.begin.end() - 1);
  grid.order.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    grid.order[next[cell_of(points[i])]++] = static_cast<std::uint32_t>(i);
  return grid;
}

float distance2_to_box(const Bounds3& box, Vec3 point) {
  const Vec3 d = max(max(box.lower - point, point - box.upper), Vec3{});
  return dot(d, d);
}

// Sources that reach into the box, in the grid's order.
std::vector<std::uint32_t> find_sources(const SourceGrid& grid,
                                        const std::vector<TableGatherPoint>& points,
                                        const Bounds3& box, float range) {
  std::vector<std::uint32_t> found;
  const int x0 = grid.cell_of(box.lower.x - range, 0), x1 = grid.cell_of(box.upper.x + range, 0);
  const int y0 = grid.cell_of(box.lower.y - range, 1), y1 = grid.cell_of(box.upper.y + range, 1);
  const int z0 = grid.cell_of(box.lower.z - range, 2), z1 = grid.cell_of(box.upper.z + range, 2);
  for (int z = z0; z <= z1; ++z)
    for (int y = y0; y <= y1; ++y)
      for (std::size_t i = grid.begin[grid.index(x0, y, z)];
           i < grid.begin[grid.index(x1, y, z) + 1]; ++i)
        if (distance2_to_box(box, points[grid.order[i]].position) < range * range)
          found.push_back(grid.order[i]);
  return found;
}

std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffu;
  v = (v | v << 16) & 0x1f0000ff0000ffu;
  v = (v | v << 8) & 0x100f00f00f00f00fu;
  v = (v | v << 4) & 0x10c30c30c30c30c3u;
  return (v | v << 2) & 0x1249249249249249u;
}

// Indices of the targets along a Z-curve, so that blocks of them are compact.
std::vector<std::uint32_t> order_targets(const std::vector<TableGatherPoint>& targets) {
  Bounds3 box;
  for (const TableGatherPoint& target : targets) extend(box, target.position);
  const Vec3 size = extent(box);
  const float scale = 2097151.0f / std::max({size.x, size.y, size.z, 1e-20f});
  std::vector<std::uint64_t> keys(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Vec3 p = (targets[i].position - box.lower) * scale;
    keys[i] = spread_bits(static_cast<std::uint64_t>(p.x)) |
              spread_bits(static_cast<std::uint64_t>(p.y)) << 1 |
              spread_bits(static_cast<std::uint64_t>(p.z)) << 2;
  }
  std::vector<std::uint32_t> order(targets.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  return order;
}

// weights[slot]: integral over a plane of the slot's bilinear hat times w(r), in mm^2, so that
// I = sum weights P_o. Midpoint rule in polar coordinates.
std::vector<double> near_weights(const ExpandedTable& table, double pitch, double near_mm) {
  std::vector<double> weights(window_size(table) / table.slot_floats);
  if (near_mm <= 0) return weights;
  const double end = std::min(near_mm, 1.5 * table.half * pitch);  // beyond: zero
  const int rings = 64 + static_cast<int>(8 * end / pitch);
  const int rays = 2 * rings;
  for (int i = 0; i < rings; ++i) {
    const double r = end * (i + 0.5) / rings, t = r / near_mm;
    const double w = (1 - t * t) * (1 - t * t) * r * (end / rings) * (6.283185307179586 / rays);
    for (int j = 0; j < rays; ++j) {
      const double angle = 6.283185307179586 * (j + 0.5) / rays;
      const double x = r / pitch * std::cos(angle) + table.half;
      const double y = r / pitch * std::sin(angle) + table.half;
      if (!(x > 0 && y > 0 && x < table.side - 1 && y < table.side - 1)) continue;
      const int ix = static_cast<int>(x), iy = static_cast<int>(y);
      const double fx = x - ix, fy = y - iy;
      const auto slot = static_cast<std::size_t>(iy * table.side + ix);
      const auto row = static_cast<std::size_t>(table.side);
      weights[slot] += w * (1 - fx) * (1 - fy);
      weights[slot + 1] += w * fx * (1 - fy);
      weights[slot + row] += w * (1 - fx) * fy;
      weights[slot + row + 1] += w * fx * fy;
    }
  }
  return weights;
}

// Sums of one target; see the header for S, W and I.
struct TargetSums {
  Rgb far;                // sum R (1 - w) flux, and R flux of the other side
  Rgb near_s, near_w;     // S, W
  Rgb near_i, near_q;     // I, and about int (P_o w)^2 dA
  Rgb mean_flux;          // sum w flux
  float mean_weight = 0;  // sum w
};

struct TableGather {
  const TableGatherSources& sources;
  const std::vector<TableGatherPoint>& targets;
  ExpandedTable leaving, entering;  // the second is empty for symmetric tables
  bool is_symmetric = true;
  float pixels_per_mm = 1;
  float range = 0;  // mm
  double near_mm = 0;
  std::vector<double> near_weight;
  SourceGrid grid;
};

WindowFrame make_frame(const TableGather& gather, const TableGatherPoint& point,
                       const ExpandedTable& table, float* window) {
  make_window(table, point.place, window);
  return {window,         table.side,          table.has_missing(), gather.pixels_per_mm,
          point.position, point.place.along_x, point.place.along_y};
}

// w(r) of the near term.
float near_window(float r2, double near_mm) {
  const float t = 1 - r2 / static_cast<float>(near_mm * near_mm);
  return near_mm > 0 && t > 0 ? t * t : 0.0f;
}

struct Positions {
  std::vector<float> x, y, z;
  void add(Vec3 p) {
    x.push_back(p.x);
    y.push_back(p.y);
    z.push_back(p.z);
  }
};

// Of one block: a window, and what it shows at the points of the other end.
struct Scratch {
  std::vector<float> window, values, squares;
};

void look_up(const WindowFrame& frame, const Positions& at, Scratch& scratch) {
  look_up_window(frame, at.x.size(), at.x.data(), at.y.data(), at.z.data(), scratch.values.data(),
                 scratch.squares.data());
}

// I of a target's window, and the integral of the values squared.
void integrate_near(const TableGather& gather, const float* window, TargetSums& sums) {
  double sum[3] = {0, 0, 0}, square[3] = {0, 0, 0};
  for (std::size_t s = 0; s < gather.near_weight.size(); ++s) {
    if (gather.near_weight[s] <= 0) continue;
    const float* slot = window + s * gather.leaving.slot_floats;
    for (std::size_t c = 0; c < 3; ++c) {
      const float weight = gather.leaving.has_missing() ? slot[4 + c] : 1.0f;
      if (!(weight > 0)) continue;
      const auto value = static_cast<double>(slot[c] / weight);
      sum[c] += gather.near_weight[s] * value;
      square[c] += gather.near_weight[s] * value * value;
    }
  }
  const auto to_rgb = [](const double* v) {
    return Rgb{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  };
  sums.near_i = to_rgb(sum);
  sums.near_q = to_rgb(square);
}

// The target's end: its window at all sources of the block.
void add_targets_end(const TableGather& gather, const TableGatherPoint& target,
                     const std::vector<std::uint32_t>& found, const Positions& at, Scratch& scratch,
                     TargetSums& sums) {
  const WindowFrame frame = make_frame(gather, target, gather.leaving, scratch.window.data());
  integrate_near(gather, scratch.window.data(), sums);
  look_up(frame, at, scratch);
  const auto area = static_cast<float>(gather.sources.area_mm2);
  for (std::size_t n = 0; n < found.size(); ++n) {
    const float* value = scratch.values.data() + 4 * n;
    const Rgb& flux = gather.sources.flux[found[n]];
    const Rgb product = Rgb{value[0], value[1], value[2]} * flux;
    const float w = near_window(scratch.squares[n], gather.near_mm);
    if (w > 0 && dot(gather.sources.points[found[n]].normal, target.normal) > 0) {
      sums.far += product * (1 - w);
      sums.near_s += product * w;
      sums.near_w += Rgb{value[0], value[1], value[2]} * (w * area);
      sums.mean_flux += flux * w;
      sums.mean_weight += w;
    } else {
      sums.far += product;
    }
  }
}

// A source's end: its window at all targets of the block.
void add_sources_end(const TableGather& gather, std::size_t source,
                     const std::vector<std::uint32_t>& block, const Positions& at, Scratch& scratch,
                     std::vector<TargetSums>& sums) {
  const TableGatherPoint& point = gather.sources.points[source];
  const ExpandedTable& table = gather.is_symmetric ? gather.leaving : gather.entering;
  const WindowFrame frame = make_frame(gather, point, table, scratch.window.data());
  look_up(frame, at, scratch);
  const Rgb& flux = gather.sources.flux[source];
  for (std::size_t n = 0; n < block.size(); ++n) {
    const float* value = scratch.values.data() + 4 * n;
    const Rgb product = Rgb{value[0], value[1], value[2]} * flux;
    const float w = near_window(scratch.squares[n], gather.near_mm);
    const bool is_near = w > 0 && dot(gather.targets[block[n]].normal, point.normal) > 0;
    sums[n].far += product * (is_near ? 1 - w : 1.0f);
    if (is_near) sums[n].near_s += product * w;
  }
}

// Both ends count half. The near term of one channel; see the header.
float combine(float far, float s, float w, float i, float q, float flux, float weight, float area) {
  float near = 0;
  if (w > 0.05f * i && w > 0) {
    near = 0.5f * s * static_cast<float>(near_scale(w, i, q, area));
  } else if (weight > 0) {
    near = i * flux / (weight * area);
  }
  return std::max(0.0f, 0.5f * far + near);
}

void gather_block(const TableGather& gather, const std::vector<std::uint32_t>& block,
                  std::vector<Rgb>& exitance) {
  Bounds3 box;
  Positions block_at, found_at;
  for (const std::uint32_t t : block) {
    extend(box, gather.targets[t].position);
    block_at.add(gather.targets[t].position);
  }
  const std::vector<std::uint32_t> found =
      find_sources(gather.grid, gather.sources.points, box, gather.range);
  for (const std::uint32_t s : found) found_at.add(gather.sources.points[s].position);
  const std::size_t most = std::max(found.size(), block.size());
  Scratch scratch{std::vector<float>(window_size(gather.leaving)), std::vector<float>(4 * most),
                  std::vector<float>(most)};
  std::vector<TargetSums> sums(block.size());
  for (std::size_t n = 0; n < block.size(); ++n)
    add_targets_end(gather, gather.targets[block[n]], found, found_at, scratch, sums[n]);
  for (const std::uint32_t s : found) add_sources_end(gather, s, block, block_at, scratch, sums);
  const auto area = static_cast<float>(gather.sources.area_mm2);
  for (std::size_t n = 0; n < block.size(); ++n) {
    const TargetSums& t = sums[n];
    const auto channel = [&](float Rgb::*c) {
      return combine(t.far.*c, t.near_s.*c, t.near_w.*c, t.near_i.*c, t.near_q.*c, t.mean_flux.*c,
                     t.mean_weight, area);
    };
    exitance[block[n]] = {channel(&Rgb::x), channel(&Rgb::y), channel(&Rgb::z)};
  }
}

TableGather make_gather(const BssrdfTable& table, const TableGatherSources& sources,
                        const std::vector<TableGatherPoint>& targets, double near_mm) {
  const TableHeader& header = table.header;
  TableGather gather{sources, targets, expand_table(table, TableEnd::leaving), {}};
  gather.is_symmetric = header.symmetric;
  if (!header.symmetric) gather.entering = expand_table(table, TableEnd::entering);
  gather.pixels_per_mm = static_cast<float>(1 / header.pixel_pitch_mm);
  // The last taps reach a pixel beyond the window in x and in y.
  const double table_range = (radius_px(header) + 1.4143) * header.pixel_pitch_mm;
  gather.range = static_cast<float>(std::max(table_range, near_mm));
  gather.near_mm = near_mm;
  gather.near_weight = near_weights(gather.leaving, header.pixel_pitch_mm, near_mm);
  gather.grid = make_grid(sources.points, static_cast<double>(gather.range));
  return gather;
}

}  // namespace

std::vector<Rgb> gather_table(const BssrdfTable& table, const TableGatherSources& sources,
                              const std::vector<TableGatherPoint>& targets, double near_mm,
                              const Progress& progress) {
  PARIAN_CHECK_EQ(sources.points.size(), sources.flux.size());
  std::vector<Rgb> exitance(targets.size());
  if (sources.points.empty() || targets.empty()) return exitance;
  const TableGather gather = make_gather(table, sources, targets, near_mm);
  const std::vector<std::uint32_t> order = order_targets(targets);
  const std::size_t blocks = (order.size() + block_size - 1) / block_size;
  constexpr std::size_t batch = 32;  // blocks between two looks at the progress
  for (std::size_t first = 0; first < blocks; first += batch) {
    advance_progress(progress, "gathering",
                     static_cast<double>(first) / static_cast<double>(blocks));
    parallel_for(std::min(batch, blocks - first), [&](std::size_t i) {
      const std::size_t begin = (first + i) * block_size;
      const std::size_t end = std::min(order.size(), begin + block_size);
      gather_block(gather,
                   {order.begin() + static_cast<std::ptrdiff_t>(begin),
                    order.begin() + static_cast<std::ptrdiff_t>(end)},
                   exitance);
    });
  }
  return exitance;
}

}  // namespace parian

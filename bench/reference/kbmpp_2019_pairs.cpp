#include "bench/reference/kbmpp_2019_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "bench/reference/kbmpp_2019_kernels.h"
#include "math/fast_math.h"

namespace parian::kbmpp {
namespace {

Ring make_ring(const TableHeader& header, const std::vector<double>& knots, Offset offset) {
  Ring ring;
  const double pixels = length_px(offset);
  const double r = pixels * header.pixel_pitch_mm;
  while (ring.segment + 2 < knots.size() && knots[ring.segment + 1] <= r) ++ring.segment;
  const double begin = knots[ring.segment], end = knots[ring.segment + 1];
  ring.high = std::min((r - begin) / (end - begin), 1.0);  // w(r) of Eq. 3
  ring.low = 1 - ring.high;
  ring.weight = pair_count(header, offset) / (1 + pixels * pixels);
  return ring;
}

// Offsets within the last knot by length; `table_index` gets those of the planes.
void make_rings(const TableHeader& header, const std::vector<double>& knots, Pairs& pairs,
                std::vector<int>& table_index) {
  std::map<int, std::vector<int>> by_length;
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const Offset d = header.offsets[i];
    if (length_px(d) * header.pixel_pitch_mm <= knots.back() * (1 + 1e-9))
      by_length[d.dx * d.dx + d.dy * d.dy].push_back(static_cast<int>(i));
  }
  for (const auto& [length, indices] : by_length) {
    Ring ring = make_ring(header, knots, header.offsets[static_cast<std::size_t>(indices[0])]);
    for (const int i : indices) {
      const Offset d = header.offsets[static_cast<std::size_t>(i)];
      ring.members.push_back({d, std::ptrdiff_t{d.dy} * header.width + d.dx, table_index.size()});
      table_index.push_back(i);
    }
    pairs.rings.push_back(std::move(ring));
  }
}

// A segment's rings in parts of at most an eighth of all offsets; the largest segments first.
void make_tasks(Pairs& pairs) {
  const std::size_t limit = std::max<std::size_t>(1, pairs.planes / 8);
  std::vector<Pairs::Task> tasks;
  std::size_t held = 0;
  for (std::size_t i = 0; i < pairs.rings.size(); ++i) {
    const Ring& ring = pairs.rings[i];
    if (tasks.empty() || tasks.back().segment != ring.segment ||
        held + ring.members.size() > limit) {
      tasks.push_back({0, ring.segment, i, i});
      held = 0;
    }
    held += ring.members.size();
    tasks.back().end = i + 1;
  }
  for (auto task = tasks.rbegin(); task != tasks.rend(); ++task)
    for (std::size_t c = 0; c < static_cast<std::size_t>(pairs.channels); ++c) {
      task->channel = c;
      pairs.tasks.push_back(*task);
    }
}

// 2 ln R, NaN outside the grid and where there is no logarithm.
void fill_logs(const BssrdfTable& table, const std::vector<int>& table_index, Pairs& pairs) {
  const std::size_t pixels = pairs.pixels();
  const auto channels = static_cast<std::size_t>(pairs.channels);
  pairs.log_reflectance.resize(channels * pairs.planes * pixels);
  std::vector<char> complete(channels * pairs.planes, 1);
  parallel_for(channels * pairs.planes, [&](std::size_t job) {
    const std::size_t channel = job / pairs.planes;
    const int index = table_index[job % pairs.planes];
    float* out = pairs.log_reflectance.data() + job * pixels;
    const float* slice = slice_of(table, static_cast<int>(channel), index);
    std::fill(out, out + pixels, std::numeric_limits<float>::quiet_NaN());
    const PixelRange grid =
        pairs_in_grid(table.header, table.header.offsets[static_cast<std::size_t>(index)]);
    for (int y = grid.y0; y < grid.y1; ++y) {
      const auto begin = static_cast<std::size_t>(y * pairs.width + grid.x0);
      const auto count = static_cast<std::size_t>(std::max(0, grid.x1 - grid.x0));
      log_array(slice + begin, out + begin, count);
      for (std::size_t i = begin; i < begin + count; ++i) {
        const bool good = std::isfinite(out[i]);
        out[i] = good ? 2 * out[i] : std::numeric_limits<float>::quiet_NaN();
        if (!good) complete[job] = 0;
      }
    }
  });
  pairs.complete = std::all_of(complete.begin(), complete.end(), [](char c) { return c != 0; });
}

// Counts of the pairs of each pixel and ring, weighted by products of hat functions.
void fill_curvature(Pairs& pairs) {
  const std::size_t pixels = pairs.pixels(), row = pairs.row;
  pairs.diagonal.assign(pixels * row, 0.0f);
  pairs.off_diagonal.assign(pixels * row, 0.0f);
  parallel_for(static_cast<std::size_t>(pairs.channels), [&](std::size_t c) {
    std::vector<float> at(pixels), partner(pixels);
    for (const Ring& ring : pairs.rings) {
      for (const Member& m : ring.members) {
        const PlaneRange range = range_of(m, pixels);
        add_counts(pairs.logs(c, m.plane), m.shift, range.begin, range.end, at.data(),
                   partner.data());
      }
      const bool self = ring.members[0].offset == Offset{};
      // (0,0) holds its pixel twice: e moves by 2, its square by 4.
      const double w = ring.weight * (self ? 2 : 1);
      const auto low = static_cast<float>(w * ring.low * ring.low);
      const auto high = static_cast<float>(w * ring.high * ring.high);
      const auto off = static_cast<float>(w * ring.low * ring.high);
      for (std::size_t x = 0; x < pixels; ++x) {
        const float count = at[x] + partner[x];
        const std::size_t j = x * row + 4 * ring.segment + c;
        pairs.diagonal[j] += low * count;
        pairs.diagonal[j + 4] += high * count;
        pairs.off_diagonal[j] += off * count;
        at[x] = 0;
        partner[x] = 0;
      }
    }
  });
}

}  // namespace

PlaneRange range_of(const Member& member, std::size_t pixels) {
  const auto count = static_cast<std::ptrdiff_t>(pixels);
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, -member.shift);
  const std::ptrdiff_t end = std::min(count, count - member.shift);
  if (begin >= end) return {};
  return {static_cast<std::size_t>(begin), static_cast<std::size_t>(end)};
}

Pairs make_pairs(const BssrdfTable& table, const std::vector<double>& knots_mm) {
  Pairs pairs;
  pairs.width = table.header.width;
  pairs.height = table.header.height;
  pairs.channels = table.header.channels;
  pairs.knots = knots_mm.size();
  pairs.row = 4 * pairs.knots;
  std::vector<int> table_index;
  make_rings(table.header, knots_mm, pairs, table_index);
  pairs.planes = table_index.size();
  make_tasks(pairs);
  fill_logs(table, table_index, pairs);
  fill_curvature(pairs);
  return pairs;
}

}  // namespace parian::kbmpp

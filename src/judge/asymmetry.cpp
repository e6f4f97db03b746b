#include "judge/asymmetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"

namespace parian {
namespace {

struct OffsetPair {
  int forth = 0, back = 0;  // indices of d and -d
};

// Every d != 0 of the half plane with its opposite; (0,0) with itself.
std::vector<OffsetPair> pair_offsets(const SliceSource& table) {
  std::map<std::pair<int, int>, int> known;
  const std::vector<Offset>& offsets = table.header().offsets;
  for (std::size_t i = 0; i < offsets.size(); ++i)
    known.emplace(std::pair(offsets[i].dx, offsets[i].dy), static_cast<int>(i));
  std::vector<OffsetPair> pairs;
  for (const auto& [d, index] : known) {
    const auto opposite = known.find({-d.first, -d.second});
    if (opposite == known.end())
      throw Error(
          {table.name(), "offsets",
           fmt::format("({}, {}), as ({}, {}) is listed", -d.first, -d.second, d.first, d.second),
           "none such"});
    if (opposite->second == index || d < opposite->first)
      pairs.push_back({index, opposite->second});
  }
  return pairs;
}

struct Norms {
  double difference2 = 0, data2 = 0;
};

Norms compare_directions(const SliceSource& table, int channel, OffsetPair pair) {
  const TableHeader& header = table.header();
  const Offset d = header.offsets[static_cast<std::size_t>(pair.forth)];
  const PixelRange range = pairs_in_grid(header, d);
  std::vector<float> forth(header.pixels()), back(header.pixels());
  table.read_slice(channel, pair.forth, forth.data());
  if (pair.back != pair.forth) table.read_slice(channel, pair.back, back.data());
  Norms norms;
  const std::size_t width = static_cast<std::size_t>(header.width);
  for (int y = range.y0; y < range.y1; ++y)
    for (int x = range.x0; x < range.x1; ++x) {
      const double a = forth[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
      const double b = pair.back == pair.forth ? a
                                               : back[static_cast<std::size_t>(y + d.dy) * width +
                                                      static_cast<std::size_t>(x + d.dx)];
      if (std::isnan(a) || std::isnan(b)) continue;
      norms.difference2 += 2 * (a - b) * (a - b);
      norms.data2 += pair.back == pair.forth ? a * a : a * a + b * b;
    }
  return norms;
}

}  // namespace

double measure_asymmetry(const SliceSource& table, const Progress& progress) {
  const TableHeader& header = table.header();
  if (header.symmetric) return 0;
  const std::vector<OffsetPair> pairs = pair_offsets(table);
  constexpr std::size_t block = 64;  // between reports of progress
  const std::size_t tasks = pairs.size() * static_cast<std::size_t>(header.channels);
  std::vector<Norms> norms(tasks);
  for (std::size_t begin = 0; begin < tasks; begin += block) {
    advance_progress(progress, "asymmetry",
                     static_cast<double>(begin) / static_cast<double>(tasks));
    parallel_for(std::min(block, tasks - begin), [&](std::size_t i) {
      const std::size_t task = begin + i;
      norms[task] = compare_directions(table, static_cast<int>(task / pairs.size()),
                                       pairs[task % pairs.size()]);
    });
  }
  Norms total;
  for (const Norms& part : norms) {
    total.difference2 += part.difference2;
    total.data2 += part.data2;
  }
  return total.data2 > 0 ? std::sqrt(total.difference2 / total.data2)
                         : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace parian

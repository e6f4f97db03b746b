#include "judge/slice_batches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"

namespace parian {
namespace {

std::string describe_grid(const TableHeader& header) {
  return fmt::format("{} x {} pixels, {} channel{}", header.width, header.height, header.channels,
                     header.channels == 1 ? "" : "s");
}

void check_same_grid(const SliceSource& table, const SliceSource& model) {
  const TableHeader &a = table.header(), &b = model.header();
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    throw Error({model.name(), "grid", describe_grid(a) + " as in the table", describe_grid(b)});
  if (!(std::abs(a.pixel_pitch_mm - b.pixel_pitch_mm) <= 1e-6 * a.pixel_pitch_mm))
    throw Error({model.name(), "pixel_pitch_mm",
                 fmt::format("{} as in the table", a.pixel_pitch_mm),
                 fmt::format("{}", b.pixel_pitch_mm)});
}

}  // namespace

void for_each_batch(const SliceSource& table, const SliceSource* model,
                    const std::vector<int>& model_offsets, int first_channel, int end_channel,
                    const Progress& progress, std::string_view stage,
                    const std::function<void(SliceBatch&)>& body) {
  const int offsets = static_cast<int>(table.header().offsets.size());
  const int sources = model ? 2 : 1;
  const int size = std::min(offsets, std::clamp(4 * thread_count(), 8, 64));
  SliceBatch batch;
  batch.pixels = table.header().pixels();
  batch.values.resize(static_cast<std::size_t>(sources));
  for (auto& values : batch.values) values.resize(static_cast<std::size_t>(size) * batch.pixels);
  for (int c = first_channel; c < end_channel; ++c)
    for (int first = 0; first < offsets; first += size) {
      const double done =
          static_cast<double>(c - first_channel) + static_cast<double>(first) / offsets;
      advance_progress(progress, stage, done / (end_channel - first_channel));
      batch.channel = c;
      batch.first = first;
      batch.count = std::min(size, offsets - first);
      parallel_for(static_cast<std::size_t>(batch.count * sources), [&](std::size_t task) {
        const int i = static_cast<int>(task) / sources, d = first + i;
        if (static_cast<int>(task) % sources == 0)
          table.read_slice(c, d, batch.slice(0, i));
        else
          model->read_slice(c, model_offsets[static_cast<std::size_t>(d)], batch.slice(1, i));
      });
      body(batch);
    }
  advance_progress(progress, stage, 1);
}

std::vector<int> match_offsets(const SliceSource& table, const SliceSource& model) {
  check_same_grid(table, model);
  const std::vector<Offset>& wanted = table.header().offsets;
  if (wanted == model.header().offsets) {
    std::vector<int> same(wanted.size());
    for (std::size_t i = 0; i < same.size(); ++i) same[i] = static_cast<int>(i);
    return same;
  }
  std::map<std::pair<int, int>, int> known;
  for (std::size_t i = 0; i < model.header().offsets.size(); ++i) {
    const Offset d = model.header().offsets[i];
    known.emplace(std::pair(d.dx, d.dy), static_cast<int>(i));
  }
  std::vector<int> indices;
  indices.reserve(wanted.size());
  for (const Offset d : wanted) {
    const auto found = known.find({d.dx, d.dy});
    if (found == known.end())
      throw Error({model.name(), "offsets",
                   fmt::format("all offsets of the table, ({}, {}) among them", d.dx, d.dy),
                   fmt::format("{} offsets without it", known.size())});
    indices.push_back(found->second);
  }
  return indices;
}

RowPairs find_row_pairs(const TableHeader& header, Offset offset, int y) {
  const PixelRange range = pairs_in_grid(header, offset);
  const auto index = [&](int px, int py) {
    return static_cast<std::size_t>(py) * static_cast<std::size_t>(header.width) +
           static_cast<std::size_t>(px);
  };
  RowPairs pairs;
  if (range.x1 <= range.x0) return pairs;
  if (y >= range.y0 && y < range.y1) {
    pairs.count = range.x1 - range.x0;
    pairs.at = index(range.x0, y);
    pairs.partner = index(range.x0 + offset.dx, y + offset.dy);
  }
  const int back = y - offset.dy;
  if (back >= range.y0 && back < range.y1 && offset != Offset{}) {
    pairs.back_count = range.x1 - range.x0;
    pairs.back_at = index(range.x0, back);
    pairs.back_partner = index(range.x0 + offset.dx, y);
  }
  return pairs;
}

}  // namespace parian

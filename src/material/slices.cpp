#include "material/slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>

#include "base/check.h"
#include "base/error.h"
#include "base/hot.h"
#include "base/parallel.h"

namespace parian {
namespace {

constexpr std::uint32_t largest_finite_bits = 0x7f7fffff;

// Largest of bits - 1. Positive finite floats have bits in [1, 0x7f7fffff]; zero, infinities, NaN
// and everything negative lie beyond.
PARIAN_HOT std::uint32_t largest_bits(const float* values, std::size_t count) {
  std::uint32_t largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[i]) - 1;
    largest = bits > largest ? bits : largest;
  }
  return largest;
}

// Number of values that are infinite, and of values <= 0. NaN counts as neither.
PARIAN_HOT void count_bad(const float* values, std::size_t count, int* infinite,
                          int* not_positive) {
  int inf = 0, low = 0;
  for (std::size_t i = 0; i < count; ++i) {
    inf += std::fabs(values[i]) > std::numeric_limits<float>::max() ? 1 : 0;
    low += values[i] <= 0 ? 1 : 0;
  }
  *infinite += inf;
  *not_positive += low;
}

[[noreturn]] void throw_bad_value(const TableHeader& header, const std::string& name, int channel,
                                  int offset_index, const float* slice) {
  const bool allow_low = header.has_noise_model();
  for (std::size_t i = 0; i < header.pixels(); ++i) {
    const float value = slice[i];
    const bool bad = std::isinf(value) || (!allow_low && value <= 0);
    if (!bad) continue;
    const auto width = static_cast<std::size_t>(header.width);
    throw Error({name,
                 fmt::format("reflectance[{}][{}][{}][{}] (channel, offset, y, x)", channel,
                             offset_index, i / width, i % width),
                 std::isinf(value) ? "a finite value or NaN (not measured)"
                                   : "a value > 0 or NaN, as the table has no noise model",
                 fmt::format("{}", value)});
  }
  throw Error({.file = name, .found = "a bad value"}, ErrorKind::contract);
}

void check_size(const std::string& name, const char* axis, int size, int max) {
  if (size < 1 || size > max)
    throw Error({name, axis, fmt::format("a size in [1, {}]", max), fmt::format("{}", size)});
}

void check_noise(const TableHeader& header, const std::string& name) {
  const auto channels = static_cast<std::size_t>(header.channels);
  for (const auto* noise : {&header.noise_floor, &header.noise_gain}) {
    const char* place =
        noise == &header.noise_floor ? "attribute 'noise_floor'" : "attribute 'noise_gain'";
    if (header.noise_floor.empty() && header.noise_gain.empty()) return;
    if (noise->size() != channels)
      throw Error({name, place,
                   fmt::format("{} values, one per channel, as for its twin", channels),
                   fmt::format("{}", noise->size())});
    for (double value : *noise)
      if (!(value >= 0) || std::isinf(value))
        throw Error({name, place, "finite values >= 0", fmt::format("{}", value)});
  }
}

void check_offsets(const TableHeader& header, const std::string& name) {
  std::set<std::pair<int, int>> seen;
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const auto [dx, dy] = header.offsets[i];
    const std::string place = fmt::format("offsets[{}]", i);
    if (std::abs(static_cast<long long>(dx)) >= header.width ||
        std::abs(static_cast<long long>(dy)) >= header.height)
      throw Error({name, place,
                   fmt::format("|dx| < {} and |dy| < {}, the size of the sample", header.width,
                               header.height),
                   fmt::format("({}, {})", dx, dy)});
    if (header.symmetric && !(dy > 0 || (dy == 0 && dx >= 0)))
      throw Error({name, place, "an offset of the half plane dy > 0, or dy = 0 and dx >= 0",
                   fmt::format("({}, {})", dx, dy)});
    if (!seen.emplace(dx, dy).second)
      throw Error({name, place, "each offset once", fmt::format("({}, {}) again", dx, dy)});
  }
  if (!seen.contains({0, 0}))
    throw Error({name, "offsets", "the offset (0, 0) among them", "none"});
  if (header.symmetric) return;
  for (const auto& [dx, dy] : seen)
    if (!seen.contains({-dx, -dy}))
      throw Error(
          {name, "offsets",
           fmt::format("both directions of each offset, as symmetric = 0: ({}, {})", -dx, -dy),
           fmt::format("only ({}, {})", dx, dy)});
}

}  // namespace

double length_px(Offset offset) {
  return std::hypot(offset.dx, offset.dy);
}

void check(const TableHeader& header, const std::string& name) {
  check_size(name, "width", header.width, 65535);
  check_size(name, "height", header.height, 65535);
  if (header.channels != 1 && header.channels != 3)
    throw Error({name, "channels", "1 or 3", fmt::format("{}", header.channels)});
  if (!(header.pixel_pitch_mm > 0) || std::isinf(header.pixel_pitch_mm))
    throw Error({name, "attribute 'pixel_pitch_mm'", "a finite length > 0",
                 fmt::format("{}", header.pixel_pitch_mm)});
  if (!(header.eta >= 1 && header.eta <= 4))
    throw Error(
        {name, "attribute 'eta'", "a refractive index in [1, 4]", fmt::format("{}", header.eta)});
  check_noise(header, name);
  check_offsets(header, name);
}

double radius_px(const TableHeader& header) {
  double radius = 0;
  for (Offset offset : header.offsets) radius = std::max(radius, length_px(offset));
  return radius;
}

int find_offset(const TableHeader& header, Offset offset) {
  const auto found = std::find(header.offsets.begin(), header.offsets.end(), offset);
  return found == header.offsets.end() ? -1 : static_cast<int>(found - header.offsets.begin());
}

PixelRange pairs_in_grid(const TableHeader& header, Offset offset) {
  return {std::max(0, -offset.dx), std::min(header.width, header.width - offset.dx),
          std::max(0, -offset.dy), std::min(header.height, header.height - offset.dy)};
}

std::size_t clean_slice(const TableHeader& header, const std::string& name, int channel,
                        int offset_index, float* slice) {
  const PixelRange range =
      pairs_in_grid(header, header.offsets[static_cast<std::size_t>(offset_index)]);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto width = static_cast<std::size_t>(header.width);
  int infinite = 0, not_positive = 0;
  for (int y = 0; y < header.height; ++y) {
    float* row = slice + static_cast<std::size_t>(y) * width;
    if (y < range.y0 || y >= range.y1 || range.x0 >= range.x1) {
      std::fill_n(row, width, nan);
      continue;
    }
    std::fill(row, row + range.x0, nan);
    std::fill(row + range.x1, row + width, nan);
    const auto count = static_cast<std::size_t>(range.x1 - range.x0);
    if (largest_bits(row + range.x0, count) >= largest_finite_bits)  // mostly not: NaN or bad
      count_bad(row + range.x0, count, &infinite, &not_positive);
  }
  if (infinite > 0 || (not_positive > 0 && !header.has_noise_model()))
    throw_bad_value(header, name, channel, offset_index, slice);
  return static_cast<std::size_t>(not_positive);
}

void for_each_slice(const SliceSource& source, const Progress& progress, std::string_view stage,
                    const std::function<void(int, int, const float*)>& body) {
  const TableHeader& header = source.header();
  const std::size_t slices = header.offsets.size() * static_cast<std::size_t>(header.channels);
  // Enough slices per batch to keep the threads busy, but never more than 64 MiB of them.
  constexpr std::size_t batch_bytes = std::size_t{64} << 20u;
  const std::size_t batch =
      std::clamp<std::size_t>(batch_bytes / (header.pixels() * sizeof(float)), 1, 64);
  std::vector<float> buffer(std::min(batch, slices) * header.pixels());
  for (std::size_t begin = 0; begin < slices; begin += batch) {
    advance_progress(progress, stage, static_cast<double>(begin) / static_cast<double>(slices));
    const std::size_t end = std::min(slices, begin + batch);
    const auto channel_of = [&](std::size_t i) {
      return static_cast<int>(i / header.offsets.size());
    };
    const auto offset_of = [&](std::size_t i) {
      return static_cast<int>(i % header.offsets.size());
    };
    parallel_for(end - begin, [&](std::size_t i) {
      source.read_slice(channel_of(begin + i), offset_of(begin + i), &buffer[i * header.pixels()]);
    });
    for (std::size_t i = begin; i < end; ++i)
      body(channel_of(i), offset_of(i), &buffer[(i - begin) * header.pixels()]);
  }
  advance_progress(progress, stage, 1);
}

void copy_slices(const SliceSource& source, SliceSink& sink, const Progress& progress) {
  for_each_slice(source, progress, "writing slices",
                 [&](int channel, int offset_index, const float* slice) {
                   sink.write_slice(channel, offset_index, slice);
                 });
  sink.finish();
}

}  // namespace parian

// The streaming pass: slices -> right-hand side, constant and missing pairs of a reduced system.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "base/aligned.h"
#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "fit/noise_step.h"
#include "fit/pair_weights.h"
#include "fit/reduced_internal.h"
#include "fit/reduced_system.h"
#include "fit/stream_kernels.h"

namespace parian {
namespace {

// Listed missing pairs per unknown beyond which products read the table again: 16 bytes.
constexpr std::size_t missing_per_unknown = 4;

// A slice of 2 ln R in a frame of zeros as wide as the reach of the offsets.
struct Frame {
  std::size_t margin_x = 0, margin_y = 0, stride = 0;
  std::vector<float> values;

  float* row(int y) {
    return values.data() + (static_cast<std::size_t>(y) + margin_y) * stride + margin_x;
  }
};

// What a thread reuses from segment to segment.
struct Scratch {
  std::vector<float> slice;
  std::array<Frame, batch_size> frames;
};

struct OffsetSums {
  std::size_t known = 0, not_measured = 0, not_positive = 0, held_out = 0;
  double squares = 0;  // sum of W (2 ln R)^2, without phi where the weights are phi alone
};

struct Build {
  const SliceSource& table;
  const ReducedParams& params;
  ReducedSystem& system;
  std::vector<OffsetSums> sums;         // per offset
  AlignedVector<double> high;           // contributions to the knot above, [segment][y][x]
  std::vector<std::atomic<bool>> seen;  // per pixel not measured at (0,0): has a pair after all
  std::vector<std::uint32_t> suspects;  // those pixels
  std::atomic<std::size_t> listed{0};
};

Frame make_frame(const ReducedSystem& system) {
  Frame frame;
  for (Offset offset : system.offsets) {
    frame.margin_x = std::max(frame.margin_x, static_cast<std::size_t>(std::abs(offset.dx)));
    frame.margin_y = std::max(frame.margin_y, static_cast<std::size_t>(std::abs(offset.dy)));
  }
  frame.stride = static_cast<std::size_t>(system.width) + 2 * frame.margin_x;
  frame.values.assign(
      frame.stride * (static_cast<std::size_t>(system.height) + 2 * frame.margin_y) + log_strip,
      0.0f);
  return frame;
}

// Of a measured value: logarithms need positive ones.
bool takes_part(const Build& build, float value) {
  return build.params.about != nullptr || value >= std::numeric_limits<float>::min();
}

// Pairs of this slice that take no part: lists them, and makes their values NaN.
void list_missing(Build& build, std::size_t i, float* slice, OffsetSums& sums) {
  ReducedSystem& system = build.system;
  const TableHeader& header = build.table.header();
  const Offset offset = system.offsets[i];
  const PixelRange range = pairs_in_grid(header, offset);
  const bool hold_out = system.hold_out.fraction > 0;
  const auto width = static_cast<std::size_t>(system.width);
  for (int y = range.y0; y < range.y1; ++y) {
    for (int x = range.x0; x < range.x1; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      float& value = slice[pixel];
      if (std::isnan(value)) {
        ++sums.not_measured;
      } else if (!takes_part(build, value)) {
        ++sums.not_positive;
      } else if (hold_out && is_held_out(system.hold_out, x, y, offset)) {
        ++sums.held_out;
      } else {
        continue;
      }
      value = std::numeric_limits<float>::quiet_NaN();
      if (is_masked(system, offset, pixel)) continue;  // its weight is 0 already
      if (build.listed < missing_per_unknown * system.unknowns()) {
        ++build.listed;
        system.missing[i].push_back(static_cast<std::uint32_t>(pixel));
      }
    }
  }
}

void mark_seen(Build& build, Offset offset, const float* slice) {
  if (offset == Offset{}) return;
  const ReducedSystem& system = build.system;
  for (std::size_t s = 0; s < build.suspects.size(); ++s) {
    const int x = static_cast<int>(build.suspects[s]) % system.width,
              y = static_cast<int>(build.suspects[s]) / system.width;
    const bool before_inside = x - offset.dx >= 0 && x - offset.dx < system.width &&
                               y - offset.dy >= 0 && y - offset.dy < system.height;
    const std::ptrdiff_t before =
        static_cast<std::ptrdiff_t>(y - offset.dy) * system.width + (x - offset.dx);
    if (!std::isnan(slice[build.suspects[s]]) || (before_inside && !std::isnan(slice[before])))
      build.seen[s] = true;
  }
}

// Reads one slice into the frame as weighted residuals about a field; returns the factor of its
// contributions.
double load_residuals(Build& build, std::size_t i, std::vector<float>& slice, Frame& frame) {
  ReducedSystem& system = build.system;
  const TableHeader& header = build.table.header();
  OffsetSums& sums = build.sums[i];
  build.table.read_slice(system.channel, system.table_index[i], slice.data());
  const PixelRange range = pairs_in_grid(header, system.offsets[i]);
  const auto in_grid =
      static_cast<std::size_t>(std::max(0, range.x1 - range.x0) * std::max(0, range.y1 - range.y0));
  const auto count_known = [&] {
    std::size_t known = 0;
    for (std::size_t x = 0; x < system.pixels(); ++x) known += std::isnan(slice[x]) ? 0u : 1u;
    return known;
  };
  sums.known = count_known();
  if (system.hold_out.fraction > 0 || sums.known != in_grid) {
    list_missing(build, i, slice.data(), sums);
    sums.known = count_known();
  }
  if (!build.suspects.empty()) mark_seen(build, system.offsets[i], slice.data());
  for (std::size_t x = 0; x < system.pixels(); ++x) sums.not_positive += slice[x] <= 0 ? 1u : 0u;
  const NoiseStep& step = *build.params.about;
  const NoiseSums noise =
      eval_noise_offset(system, step, i, header, slice.data(), frame.row(0), frame.stride);
  sums.squares = noise.squares;
  system.weights[0].phi[i] =
      sums.known > 0 ? step.phi[i] * noise.weight / static_cast<double>(sums.known) : 0;
  return system.pair_count[i];
}

// Reads one slice into the frame as (weighted) 2 ln R; returns the factor of its contributions.
double load_offset(Build& build, std::size_t i, std::vector<float>& slice, Frame& frame) {
  ReducedSystem& system = build.system;
  OffsetSums& sums = build.sums[i];
  build.table.read_slice(system.channel, system.table_index[i], slice.data());
  const PixelRange range = pairs_in_grid(build.table.header(), system.offsets[i]);
  const std::size_t in_grid = static_cast<std::size_t>(std::max(0, range.x1 - range.x0)) *
                              static_cast<std::size_t>(std::max(0, range.y1 - range.y0));
  double lanes[lane_count] = {};
  int known = 0;
  const auto fill_frame = [&] {
    std::fill_n(lanes, lane_count, 0.0);
    known = 0;
    for (int y = 0; y < system.height; ++y) {  // what spills into the next row is written there
      double_logs(&slice[static_cast<std::size_t>(y) * static_cast<std::size_t>(system.width)],
                  frame.row(y), static_cast<std::size_t>(system.width), lanes, &known);
    }
  };
  const bool hold_out = system.hold_out.fraction > 0;
  if (!hold_out) fill_frame();
  if (hold_out || static_cast<std::size_t>(known) != in_grid) {
    list_missing(build, i, slice.data(), sums);
    fill_frame();
  }
  if (!build.suspects.empty()) mark_seen(build, system.offsets[i], slice.data());
  sums.known = static_cast<std::size_t>(known);
  for (double lane : lanes) sums.squares += lane;

  if (system.pair_weight == PairWeight::energy && system.weights[0].u.empty() &&
      build.params.weights.empty())
    system.weights[0].phi[i] = known > 0 ? sum_known(slice.data(), system.pixels()) / known : 0;
  if (!has_pair_weights(system)) return system.pair_count[i] * system.weights[0].phi[i];
  // General weights: multiply them in, row by row.
  sums.squares = 0;
  std::vector<float> weight(static_cast<std::size_t>(system.width));
  for (int y = 0; y < system.height; ++y) {
    fill_pair_weights(system, build.table.header(), i, y, slice.data(), weight.data());
    float* row = frame.row(y);
    for (std::size_t x = 0; x < weight.size(); ++x) {
      sums.squares += static_cast<double>(weight[x]) * static_cast<double>(row[x]) *
                      static_cast<double>(row[x]);
      row[x] *= weight[x];
    }
  }
  return system.pair_count[i];
}

// All offsets of one segment: they touch the knots segment and segment + 1 only.
void build_segment(Build& build, int segment, Scratch& scratch, const Progress& progress,
                   std::thread::id caller) {
  ReducedSystem& system = build.system;
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < system.offsets.size(); ++i)
    if (system.segment[i] == segment) members.push_back(i);
  const std::size_t pixels = system.pixels();
  double* low = system.right_hand_side.data() + static_cast<std::size_t>(segment) * pixels;
  double* high = build.high.data() + static_cast<std::size_t>(segment) * pixels;
  std::fill_n(high, pixels, 0.0);
  std::array<Frame, batch_size>& frames = scratch.frames;

  for (std::size_t begin = 0; begin < members.size(); begin += batch_size) {
    if (progress.is_cancelled && std::this_thread::get_id() == caller && progress.is_cancelled())
      throw make_cancelled_error();
    std::array<double, batch_size> a{}, b{};
    std::array<Offset, batch_size> offsets{};
    for (std::size_t j = 0; j < batch_size && begin + j < members.size(); ++j) {
      const std::size_t i = members[begin + j];
      const double factor = build.params.about != nullptr
                                ? load_residuals(build, i, scratch.slice, frames[j])
                                : load_offset(build, i, scratch.slice, frames[j]);
      a[j] = factor * (1 - system.fraction[i]);
      b[j] = factor * system.fraction[i];
      offsets[j] = system.offsets[i];
    }
    const auto width = static_cast<std::size_t>(system.width);
    for (int y = 0; y < system.height; ++y) {
      std::array<const float*, 2 * batch_size> sources{};
      for (std::size_t j = 0; j < batch_size; ++j) {  // unused frames are read with a factor of 0
        sources[2 * j] = frames[j].row(y);
        sources[2 * j + 1] = frames[j].row(y - offsets[j].dy) - offsets[j].dx;
      }
      accumulate_row(low + static_cast<std::size_t>(y) * width,
                     high + static_cast<std::size_t>(y) * width, sources.data(), a.data(), b.data(),
                     width);
    }
  }
}

void find_suspects(Build& build) {
  ReducedSystem& system = build.system;
  const int centre = find_offset(build.table.header(), {});
  std::vector<float> slice(system.pixels());
  build.table.read_slice(system.channel, centre, slice.data());
  for (std::size_t i = 0; i < slice.size(); ++i)
    if (std::isnan(slice[i]) || !takes_part(build, slice[i]))
      build.suspects.push_back(static_cast<std::uint32_t>(i));
  build.seen = std::vector<std::atomic<bool>>(build.suspects.size());
}

// Scales all phi so that the largest is 1, with b and c.
void normalise_energy_weights(ReducedSystem& system) {
  auto& phi = system.weights[0].phi;
  const double largest = *std::max_element(phi.begin(), phi.end());
  if (!(largest > 0)) return;
  for (double& value : phi) value /= largest;
  for (double& value : system.right_hand_side) value /= largest;
  system.constant /= largest;
}

void add_up(Build& build) {
  ReducedSystem& system = build.system;
  const std::size_t pixels = system.pixels();
  parallel_for(system.knots() - 1, [&](std::size_t k) {
    const double* from = &build.high[k * pixels];
    double* to = &system.right_hand_side[(k + 1) * pixels];
    for (std::size_t x = 0; x < pixels; ++x) to[x] += from[x];
  });
  for (std::size_t i = 0; i < system.offsets.size(); ++i) {
    const OffsetSums& sums = build.sums[i];
    const bool weighted = build.params.about != nullptr || has_pair_weights(system);
    const double phi = weighted ? 1 : system.weights[0].phi[i];
    system.constant += 0.5 * system.pair_count[i] * phi * sums.squares;
    system.pairs += static_cast<std::size_t>(system.pair_count[i]) * sums.known;
    system.not_measured += sums.not_measured;
    system.not_positive += sums.not_positive;
    system.held_out += sums.held_out;
  }
}

std::vector<std::uint32_t> never_seen(const Build& build) {
  std::vector<std::uint32_t> pixels;
  for (std::size_t s = 0; s < build.suspects.size(); ++s)
    if (!build.seen[s]) pixels.push_back(build.suspects[s]);
  return pixels;
}

// The pass itself. Returns the pixels without any pair.
std::vector<std::uint32_t> stream(const SliceSource& table, const ReducedParams& params,
                                  ReducedSystem& system, const Progress& progress) {
  PARIAN_CHECK(system.pair_weight != PairWeight::noise);  // noise_fit.h has it
  system.right_hand_side.assign(system.unknowns(), 0.0);
  Build build{table, params, system, std::vector<OffsetSums>(system.offsets.size()), {}, {}, {}};
  build.high.resize((system.knots() - 1) * system.pixels());  // set segment by segment
  find_suspects(build);

  const std::size_t segments = system.knots() - 1;
  const auto caller = std::this_thread::get_id();
  std::atomic<std::size_t> done{0};
  std::atomic<std::size_t> next{0};
  const std::size_t workers = std::min(segments, static_cast<std::size_t>(thread_count()));
  parallel_for(workers, [&](std::size_t) {
    Scratch scratch{std::vector<float>(system.pixels() + log_strip), {}};
    for (Frame& frame : scratch.frames) frame = make_frame(system);
    try {
      for (std::size_t task = next++; task < segments; task = next++) {  // the longest first
        build_segment(build, static_cast<int>(segments - 1 - task), scratch, progress, caller);
        const double share = static_cast<double>(++done) / static_cast<double>(segments);
        if (std::this_thread::get_id() == caller)
          advance_progress(progress, "reading the table", share);
      }
    } catch (...) {
      next = segments;  // the other threads stop as well
      throw;
    }
  });
  add_up(build);
  if (system.pair_weight == PairWeight::energy && params.weights.empty())
    normalise_energy_weights(system);
  if (build.listed >= missing_per_unknown * system.unknowns()) {
    for (auto& list : system.missing) list = {};
    // Products see what is missing when they read the table; those of a step may do without.
    if (params.about == nullptr) system.restream = &table;
  }
  return never_seen(build);
}

}  // namespace

ReducedSystem make_reduced_system(const SliceSource& table, int channel,
                                  const ReducedParams& params, const Progress& progress) {
  ReducedSystem system = make_geometry(table, channel, params);
  const std::vector<std::uint32_t> unmeasured = stream(table, params, system, progress);
  if (unmeasured.empty()) return system;
  if (!params.allow_unmeasured) {
    const auto width = static_cast<std::uint32_t>(system.width);
    throw Error({table.name(),
                 fmt::format("channel {}, pixel ({}, {})", channel, unmeasured[0] % width,
                             unmeasured[0] / width),
                 "at least one measured pair within the radius (or --fill-unmeasured)",
                 unmeasured.size() == 1
                     ? "none"
                     : fmt::format("none, as at {} other pixels", unmeasured.size() - 1)});
  }
  // Once more with these pixels masked, so that their pairs need not be listed.
  ReducedParams masked = params;
  ReducedSystem again = make_geometry(table, channel, params);
  masked.weights = again.weights;
  for (WeightTerm& term : masked.weights) {
    if (term.u.empty()) term.u.assign(again.pixels(), 1.0f);
    for (std::uint32_t pixel : unmeasured) term.u[pixel] = 0;
    if (system.pair_weight == PairWeight::energy) term.phi = system.weights[0].phi;
  }
  again.weights = masked.weights;
  stream(table, masked, again, progress);
  return again;
}

}  // namespace parian

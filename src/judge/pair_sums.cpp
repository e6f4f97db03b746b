#include "judge/pair_sums.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "math/fast_math.h"

namespace parian {
namespace {

// Neighbouring pairs (x, x + d) of one slice, whose sums belong to the pixels from `to` on.
struct Run {
  const float* data = nullptr;
  const float* model = nullptr;
  std::size_t count = 0;
  std::size_t first = 0;     // index of the first x
  std::size_t to = 0;        // first or its x + d
  std::size_t lit_from = 0;  // the other of the two
};

struct RowBuffers {
  explicit RowBuffers(std::size_t width)
      : data(width), model(width), ratios(width), logs(width), held(width) {}
  std::vector<double> data, model;
  std::vector<float> ratios, logs, held;
};

// Leaves the widened values in the buffers.
PairCounts add_run(const Run& run, RowBuffers& buffers, ErrorSums& sums) {
  double *data = buffers.data.data(), *model = buffers.model.data();
  const PairCounts counts = widen_compared(run.data, run.model, run.count, data, model);
  add_errors(data, model, run.count, &sums.error2[run.to], &sums.data2[run.to],
             &sums.error1[run.to], &sums.data1[run.to]);
  return counts;
}

// Of the values that add_run left in the buffers.
void light_run(const Run& run, const RowBuffers& buffers, PairSums& sums) {
  for (std::size_t l = 0; l < flat_lights.size(); ++l) {
    double *data = &sums.lit.data[l][run.to], *model = &sums.lit.model[l][run.to];
    if (flat_lights[l] == FlatLight::uniform) {
      add_values(buffers.data.data(), run.count, data);
      add_values(buffers.model.data(), run.count, model);
    } else {
      add_lit(buffers.data.data(), sums.irradiance[l], run.lit_from, run.count, data);
      add_lit(buffers.model.data(), sums.irradiance[l], run.lit_from, run.count, model);
    }
  }
}

void log_run(const Run& run, double floor, double weight, RowBuffers& buffers, std::size_t row,
             ErrorSums& sums) {
  const std::size_t counted =
      make_ratios(run.data, run.model, run.count, floor, buffers.ratios.data());
  if (counted == 0) return;
  log_array(buffers.ratios.data(), buffers.logs.data(), run.count);
  add_squares(buffers.logs.data(), run.count, weight, &sums.log2[run.to]);
  sums.log_weight[row] += weight * static_cast<double>(counted);
}

// The run with NaN where a pair is not held out.
Run keep_held(const PairSums& sums, Run run, int slice, RowBuffers& buffers) {
  const unsigned char* mask =
      &sums.held_masks[static_cast<std::size_t>(slice) * sums.header.pixels() + run.first];
  for (std::size_t i = 0; i < run.count; ++i)
    buffers.held[i] = mask[i] ? run.data[i] : std::numeric_limits<float>::quiet_NaN();
  run.data = buffers.held.data();
  return run;
}

void mark_held(PairSums& sums, const SliceBatch& batch) {
  const TableHeader& header = sums.header;
  sums.held_masks.resize(static_cast<std::size_t>(batch.count) * header.pixels());
  parallel_for(static_cast<std::size_t>(batch.count), [&](std::size_t i) {
    const Offset offset = header.offsets[static_cast<std::size_t>(batch.first) + i];
    unsigned char* mask = &sums.held_masks[i * header.pixels()];
    for (int y = 0; y < header.height; ++y)
      for (int x = 0; x < header.width; ++x)
        *mask++ = is_held_out(sums.hold_out, x, y, offset) ? 1 : 0;
  });
}

// Pairs whose x is in this row.
void add_front(PairSums& sums, const Run& run, int slice, double weight, double floor,
               std::size_t row, RowBuffers& buffers) {
  const auto add = [&](const Run& part, ErrorSums& errors) {
    const PairCounts counts = add_run(part, buffers, errors);
    errors.counts[row].compared += counts.compared;
    errors.counts[row].missing += counts.missing;
    log_run(part, floor, weight, buffers, row, errors);
  };
  add(run, sums.all);
  light_run(run, buffers, sums);
  if (sums.hold_out.fraction > 0) add(keep_held(sums, run, slice, buffers), sums.held);
}

// Pairs whose x + d is in this row, d != 0.
void add_back(PairSums& sums, const Run& run, int slice, RowBuffers& buffers) {
  add_run(run, buffers, sums.all);
  if (sums.header.symmetric) light_run(run, buffers, sums);
  if (sums.hold_out.fraction > 0) add_run(keep_held(sums, run, slice, buffers), buffers, sums.held);
}

void add_row(PairSums& sums, const SliceBatch& batch, int y, RowBuffers& buffers) {
  const TableHeader& header = sums.header;
  const double floor =
      header.has_noise_model()
          ? std::max(0.0, header.noise_floor[static_cast<std::size_t>(batch.channel)])
          : 0.0;
  for (int i = 0; i < batch.count; ++i) {
    const Offset offset = header.offsets[static_cast<std::size_t>(batch.first + i)];
    const RowPairs pairs = find_row_pairs(header, offset, y);
    const float *data = batch.slice(0, i), *model = batch.slice(1, i);
    if (pairs.back_count > 0)
      add_back(
          sums,
          {data + pairs.back_at, model + pairs.back_at, static_cast<std::size_t>(pairs.back_count),
           pairs.back_at, pairs.back_partner, pairs.back_at},
          i, buffers);
    if (pairs.count > 0)
      add_front(sums,
                {data + pairs.at, model + pairs.at, static_cast<std::size_t>(pairs.count), pairs.at,
                 pairs.at, pairs.partner},
                i, offset == Offset{} ? 1 : 2, floor, static_cast<std::size_t>(y), buffers);
  }
}

}  // namespace

ErrorSums::ErrorSums(std::size_t pixels, std::size_t rows)
    : error2(pixels),
      data2(pixels),
      error1(pixels),
      data1(pixels),
      log2(pixels),
      log_weight(rows),
      counts(rows) {}

LitSums::LitSums(std::size_t pixels) {
  for (auto& sum : data) sum.resize(pixels);
  for (auto& sum : model) sum.resize(pixels);
}

void LitSums::clear() {
  for (auto& sum : data) std::fill(sum.begin(), sum.end(), 0.0);
  for (auto& sum : model) std::fill(sum.begin(), sum.end(), 0.0);
}

PairSums::PairSums(const TableHeader& table_header, const HoldOut& kept_out)
    : header(table_header),
      hold_out(kept_out),
      all(header.pixels(), static_cast<std::size_t>(header.height)),
      held(hold_out.fraction > 0 ? header.pixels() : 0, static_cast<std::size_t>(header.height)),
      lit(header.pixels()) {
  for (std::size_t l = 0; l < flat_lights.size(); ++l)
    irradiance[l] =
        make_light_plane(make_flat_light(flat_lights[l], header.width, header.height, 1).values,
                         static_cast<std::size_t>(header.width));
}

void add_batch(PairSums& sums, const SliceBatch& batch) {
  if (sums.hold_out.fraction > 0) mark_held(sums, batch);
  parallel_for(static_cast<std::size_t>(sums.header.height), [&](std::size_t y) {
    RowBuffers buffers(static_cast<std::size_t>(sums.header.width));
    add_row(sums, batch, static_cast<int>(y), buffers);
  });
}

}  // namespace parian

#include "judge/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "image/metrics.h"
#include "judge/asymmetry.h"
#include "judge/pair_sums.h"
#include "math/statistics.h"

namespace parian {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

MinMeanMax summarise(const Statistics& statistics) {
  if (statistics.count == 0) return {none, none, none};
  return {statistics.min, mean(statistics), statistics.max};
}

struct PixelErrors {
  Statistics l2, l1;
};

// |R' - R| / |R| of each pixel; pixels without data are left out. `image` may be null.
PixelErrors measure_pixels(const ErrorSums& sums, Image* image) {
  PixelErrors errors;
  for (std::size_t i = 0; i < sums.data2.size(); ++i) {
    const bool skipped = !(sums.data2[i] > 0);
    const double l2 = skipped ? none : std::sqrt(sums.error2[i] / sums.data2[i]);
    if (image) image->values[i] = static_cast<float>(l2);
    if (skipped) continue;
    add(errors.l2, l2);
    add(errors.l1, sums.error1[i] / sums.data1[i]);
  }
  return errors;
}

double log_rms(const ErrorSums& sums) {
  double squares = 0, weight = 0;
  for (const double value : sums.log2) squares += value;
  for (const double value : sums.log_weight) weight += value;
  return weight > 0 ? std::sqrt(squares / weight) : none;
}

PairCounts count_pairs(const ErrorSums& sums) {
  PairCounts total;
  for (const PairCounts& row : sums.counts) {
    total.compared += row.compared;
    total.missing += row.missing;
  }
  return total;
}

// The flat sample relit with the compared pairs of data and model, and per pixel the squared norm
// over channels of rho and of its error.
struct Flats {
  explicit Flats(const TableHeader& header) : rho2(header.pixels()), rho_error2(header.pixels()) {
    for (auto* images : {&data, &model})
      for (Image& image : *images) image = make_image(header.width, header.height, header.channels);
  }
  std::array<Image, flat_lights.size()> data, model;
  std::vector<double> rho2, rho_error2;
};

void store_channel(const TableHeader& header, int channel, LitSums& lit, Flats& flats) {
  const double area = header.pixel_pitch_mm * header.pixel_pitch_mm;
  const std::size_t stride = static_cast<std::size_t>(header.channels);
  for (std::size_t l = 0; l < flat_lights.size(); ++l)
    for (std::size_t i = 0; i < header.pixels(); ++i) {
      const std::size_t to = i * stride + static_cast<std::size_t>(channel);
      const double data = area * lit.data[l][i], model = area * lit.model[l][i];
      flats.data[l].values[to] = static_cast<float>(data);
      flats.model[l].values[to] = static_cast<float>(model);
      if (flat_lights[l] != FlatLight::uniform) continue;
      flats.rho2[i] += data * data;
      flats.rho_error2[i] += (model - data) * (model - data);
    }
  lit.clear();
}

void judge_flats(const Flats& flats, CompareReport& report) {
  Statistics albedo;
  for (std::size_t i = 0; i < flats.rho2.size(); ++i)
    if (flats.rho2[i] > 0) add(albedo, std::sqrt(flats.rho_error2[i] / flats.rho2[i]));
  report.albedo_error_mean = summarise(albedo).mean;
  report.albedo_error_max = summarise(albedo).max;
  double* const psnr[] = {&report.psnr_db.uniform, &report.psnr_db.disc, &report.psnr_db.line};
  double* const similarity[] = {&report.ssim.uniform, &report.ssim.disc, &report.ssim.line};
  for (std::size_t l = 0; l < flat_lights.size(); ++l) {
    *psnr[l] = psnr_db(flats.data[l], flats.model[l]);
    *similarity[l] = ssim(flats.data[l], flats.model[l]);
  }
}

Document number(double value) {
  return std::isfinite(value) ? Document(value) : Document(nullptr);
}

Document to_document(const MinMeanMax& values) {
  return Document::Object{
      {"min", number(values.min)}, {"mean", number(values.mean)}, {"max", number(values.max)}};
}

Document to_document(const PerLight& values) {
  return Document::Object{{"uniform", number(values.uniform)},
                          {"disc", number(values.disc)},
                          {"line", number(values.line)}};
}

}  // namespace

CompareReport compare(const SliceSource& table, const SliceSource& model, const HoldOut& hold_out,
                      const Progress& progress) {
  const TableHeader& header = table.header();
  const std::vector<int> model_offsets = match_offsets(table, model);
  PairSums sums(header, hold_out);
  Flats flats(header);
  const int last = static_cast<int>(header.offsets.size()) - 1;
  for_each_batch(table, &model, model_offsets, 0, header.channels, progress, "comparing",
                 [&](const SliceBatch& batch) {
                   add_batch(sums, batch);
                   if (batch.first + batch.count > last)
                     store_channel(header, batch.channel, sums.lit, flats);
                 });
  CompareReport report;
  report.error_image = make_image(header.width, header.height, 1);
  const PixelErrors errors = measure_pixels(sums.all, &report.error_image);
  report.relative_error = summarise(errors.l2);
  report.relative_error_l1 = summarise(errors.l1);
  report.pixels_skipped = header.pixels() - errors.l2.count;
  report.log_rms = log_rms(sums.all);
  report.missing_in_model = count_pairs(sums.all).missing;
  judge_flats(flats, report);
  if (hold_out.fraction > 0) {
    const PixelErrors held = measure_pixels(sums.held, nullptr);
    report.held_out = {summarise(held.l2), summarise(held.l1), log_rms(sums.held),
                       count_pairs(sums.held).compared};
  }
  if (!header.symmetric) report.asymmetry = measure_asymmetry(table, progress);
  report.bytes_table =
      4 * static_cast<std::size_t>(header.channels) * header.offsets.size() * header.pixels();
  return report;
}

Document to_document(const CompareReport& report) {
  Document held_out = nullptr;
  if (report.held_out)
    held_out =
        Document::Object{{"relative_error", to_document(report.held_out->relative_error)},
                         {"relative_error_l1", to_document(report.held_out->relative_error_l1)},
                         {"log_rms", number(report.held_out->log_rms)},
                         {"pairs", report.held_out->pairs}};
  return Document::Object{
      {"relative_error", to_document(report.relative_error)},
      {"relative_error_l1", to_document(report.relative_error_l1)},
      {"albedo_error", Document::Object{{"mean", number(report.albedo_error_mean)},
                                        {"max", number(report.albedo_error_max)}}},
      {"psnr_db", to_document(report.psnr_db)},
      {"ssim", to_document(report.ssim)},
      {"log_rms", number(report.log_rms)},
      {"held_out", std::move(held_out)},
      {"missing_in_model", report.missing_in_model},
      {"pixels_skipped", report.pixels_skipped},
      {"asymmetry", report.asymmetry ? number(*report.asymmetry) : Document(nullptr)},
      {"bytes_table", report.bytes_table},
      {"bytes_material", report.bytes_material}};
}

}  // namespace parian

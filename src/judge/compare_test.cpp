#include "judge/compare.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <string>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "image/metrics.h"
#include "judge/asymmetry.h"
#include "judge/relight.h"
#include "judge/test_tables.h"

namespace parian {
namespace {

using namespace testing_tables;

CompareReport compare_tables(const BssrdfTable& table, const BssrdfTable& model,
                             const HoldOut& hold_out = {}) {
  return compare(*make_slices(table, "table.h5"), *make_slices(model, "model.h5"), hold_out);
}

// Three pixels in a row, offsets (0,0) and (1,0), two pairs between neighbours.
BssrdfTable make_row(std::vector<float> diagonal, float left, float right) {
  BssrdfTable table = make_table(3, 1, 1, {{0, 0}, {1, 0}}, 2);
  std::copy(diagonal.begin(), diagonal.end(), slice_of(table, 0, 0));
  slice_of(table, 0, 1)[0] = left;
  slice_of(table, 0, 1)[1] = right;
  return table;
}

TEST(Compare, ErrorsOfThreePixelsByHand) {
  const BssrdfTable table = make_row({4, 8, 12}, 3, 6);
  const BssrdfTable model = make_row({4, 9, 12}, 5, 6);
  const CompareReport report = compare_tables(table, model);
  // Pixel 0: pairs 4, 3 with errors 0, 2. Pixel 1: 8, 3, 6 with 1, 2, 0. Pixel 2: 12, 6 without.
  const double e0 = 2 / 5.0, e1 = std::sqrt(5.0 / 109);
  EXPECT_DOUBLE_EQ(report.relative_error.min, 0);
  EXPECT_DOUBLE_EQ(report.relative_error.mean, (e0 + e1) / 3);
  EXPECT_DOUBLE_EQ(report.relative_error.max, e0);
  EXPECT_DOUBLE_EQ(report.relative_error_l1.mean, (2 / 7.0 + 3 / 17.0) / 3);
  EXPECT_DOUBLE_EQ(report.relative_error_l1.max, 2 / 7.0);
  EXPECT_DOUBLE_EQ(report.albedo_error_mean, (2 / 7.0 + 3 / 17.0) / 3);
  EXPECT_DOUBLE_EQ(report.albedo_error_max, 2 / 7.0);
  // (0,0) once, the others twice: 3 + 2 * 2 logarithms.
  const double l0 = std::log(9 / 8.0), l1 = std::log(5 / 3.0);
  EXPECT_NEAR(report.log_rms, std::sqrt((l0 * l0 + 2 * l1 * l1) / 7), 1e-6);
  EXPECT_EQ(report.missing_in_model, 0u);
  EXPECT_EQ(report.pixels_skipped, 0u);
  EXPECT_EQ(report.bytes_table, 4u * 2 * 3);
  EXPECT_FALSE(report.held_out);
  EXPECT_FALSE(report.asymmetry);
  EXPECT_FLOAT_EQ(at(report.error_image, 0, 0, 0), 0.4f);
  // rho = pixel area times row sums: 28, 68, 72 against 36, 80, 72.
  EXPECT_NEAR(report.psnr_db.uniform, 10 * std::log10(72.0 * 72 * 3 / (64 + 144)), 1e-6);
}

TEST(Compare, ChannelsCountTogether) {
  BssrdfTable table = make_table(1, 1, 3, {{0, 0}}), model = table;
  table.reflectance = {1, 2, 2};
  model.reflectance = {1, 2, 3.5f};
  const CompareReport report = compare_tables(table, model);
  EXPECT_DOUBLE_EQ(report.relative_error.mean, 0.5);
  EXPECT_DOUBLE_EQ(report.relative_error_l1.mean, 0.3);
  EXPECT_DOUBLE_EQ(report.albedo_error_mean, 0.5);
}

TEST(Compare, AlbedoErrorsCancelWithinAPixel) {
  const CompareReport report =
      compare_tables(make_row({4, 8, 12}, 2, 6), make_row({5, 9, 12}, 1, 6));
  EXPECT_DOUBLE_EQ(report.albedo_error_max, 0);
  EXPECT_DOUBLE_EQ(report.relative_error_l1.max, 2 / 6.0);
}

TEST(Compare, IdenticalModelHasNoError) {
  BssrdfTable table = make_table(13, 12, 3, half_disc_offsets(3));
  fill_random(table, 1, 0.1);
  const CompareReport report = compare_tables(table, table);
  EXPECT_EQ(report.relative_error.max, 0);
  EXPECT_EQ(report.albedo_error_max, 0);
  EXPECT_EQ(report.log_rms, 0);
  EXPECT_EQ(report.ssim.line, 1);
  const Document document = to_document(report);
  EXPECT_EQ(describe_value(get(get(document, "psnr_db"), "disc")), "null");
  EXPECT_EQ(as_number(get(get(document, "ssim"), "uniform")), 1);
}

TEST(Compare, FlatsAreThoseOfRelight) {
  BssrdfTable table = make_table(15, 12, 3, half_disc_offsets(3), 0.5), model = table;
  fill_random(table, 2);
  fill_random(model, 3);
  const CompareReport report = compare_tables(table, model);
  std::vector<Image> lights;
  for (const FlatLight light : {FlatLight::uniform, FlatLight::disc, FlatLight::line})
    lights.push_back(make_flat_light(light, 15, 12, 1));
  const auto a = relight(*make_slices(table), lights), b = relight(*make_slices(model), lights);
  EXPECT_DOUBLE_EQ(report.psnr_db.uniform, psnr_db(a[0], b[0]));
  EXPECT_DOUBLE_EQ(report.psnr_db.disc, psnr_db(a[1], b[1]));
  EXPECT_DOUBLE_EQ(report.psnr_db.line, psnr_db(a[2], b[2]));
  EXPECT_DOUBLE_EQ(report.ssim.disc, ssim(a[1], b[1]));
}

TEST(Compare, MissingPairsAreLeftOutOfBothSides) {
  // Not measured: the pair on the right. Not in the model: that on the left.
  const CompareReport report =
      compare_tables(make_row({4, 8, nan}, 3, nan), make_row({4, 10, 7}, nan, 6));
  EXPECT_EQ(report.missing_in_model, 1u);
  EXPECT_EQ(report.pixels_skipped, 1u);
  EXPECT_DOUBLE_EQ(report.relative_error.mean, 0.125);
  EXPECT_DOUBLE_EQ(report.albedo_error_max, 0.25);
  EXPECT_TRUE(std::isnan(at(report.error_image, 2, 0, 0)));
}

TEST(Compare, NothingToCompareIsNull) {
  const CompareReport report =
      compare_tables(make_row({nan, nan, nan}, nan, nan), make_row({4, 10, 7}, 1, 6));
  EXPECT_EQ(report.pixels_skipped, 3u);
  const Document document = to_document(report);
  EXPECT_EQ(describe_value(get(get(document, "relative_error"), "mean")), "null");
  EXPECT_EQ(describe_value(get(document, "log_rms")), "null");
}

TEST(Compare, LogarithmsCountAboveTheNoiseFloor) {
  BssrdfTable table = make_row({4, 1, -1}, 3, 0.5f);
  table.header.noise_floor = {1};
  table.header.noise_gain = {0};
  BssrdfTable model = make_row({8, 9, 9}, 3, 9);
  model.header.noise_floor = {1};
  model.header.noise_gain = {0};
  EXPECT_NEAR(compare_tables(table, model).log_rms, std::log(2.0) / std::sqrt(3.0), 1e-6);
}

TEST(Compare, UnderflowCountsAsTheSmallestNormalFloat) {
  BssrdfTable table = make_row({1, 1, 1}, 1, 1), model = make_row({1, 1, 0}, 1, 1);
  model.header.noise_floor = model.header.noise_gain = {0};  // lets a value of 0 pass
  EXPECT_NEAR(compare_tables(table, model).log_rms, -std::log(FLT_MIN) / std::sqrt(7.0), 1e-4);
}

TEST(Compare, HeldOutErrorsAreOfHeldOutPairsAlone) {
  const HoldOut hold_out{0.3, 7};
  BssrdfTable table = make_table(12, 11, 3, half_disc_offsets(3));
  fill_random(table, 4);
  BssrdfTable model = table;
  std::size_t held = 0;
  for (int c = 0; c < 3; ++c)
    for (std::size_t d = 0; d < table.header.offsets.size(); ++d) {
      const PixelRange range = pairs_in_grid(table.header, table.header.offsets[d]);
      for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x)
          if (is_held_out(hold_out, x, y, table.header.offsets[d])) {
            ++held;
            slice_of(model, c, static_cast<int>(d))[y * 12 + x] *= 1.25f;
          }
    }
  const CompareReport report = compare_tables(table, model, hold_out);
  ASSERT_TRUE(report.held_out);
  EXPECT_GT(held, 100u);
  EXPECT_EQ(report.held_out->pairs, held);
  EXPECT_NEAR(report.held_out->relative_error.min, 0.25, 1e-6);
  EXPECT_NEAR(report.held_out->relative_error.max, 0.25, 1e-6);
  EXPECT_NEAR(report.held_out->relative_error_l1.mean, 0.25, 1e-6);
  EXPECT_NEAR(report.held_out->log_rms, std::log(1.25), 1e-6);
  EXPECT_LT(report.relative_error.max, 0.25);
  EXPECT_EQ(as_number(get(get(to_document(report), "held_out"), "pairs")),
            static_cast<double>(held));
}

TEST(Compare, BothDirectionsCountAtBothEndsButLightLeavesAtX) {
  BssrdfTable table = make_table(1, 1, 1, {{0, 0}});
  table.header.width = 2;
  table.header.symmetric = false;
  table.header.offsets = {{0, 0}, {1, 0}, {-1, 0}};
  table.reflectance = {4, 8, 3, nan, nan, 1};  // R(0,1) = 3, R(1,0) = 1
  BssrdfTable model = table;
  model.reflectance = {4, 8, 2, nan, nan, 1};
  const CompareReport report = compare_tables(table, model);
  EXPECT_DOUBLE_EQ(report.relative_error.max, std::sqrt(1 / 26.0));
  EXPECT_DOUBLE_EQ(report.relative_error.min, std::sqrt(1 / 74.0));
  EXPECT_DOUBLE_EQ(report.albedo_error_max, 1 / 7.0);
  EXPECT_DOUBLE_EQ(report.albedo_error_mean, 0.5 / 7.0);
  ASSERT_TRUE(report.asymmetry);
  EXPECT_DOUBLE_EQ(*report.asymmetry, std::sqrt(8.0 / (16 + 64 + 9 + 1)));
  const Image flat = relight(*make_slices(table), {make_image(2, 1, 1, 1)})[0];
  EXPECT_EQ(at(flat, 0, 0, 0), 7);
  EXPECT_EQ(at(flat, 1, 0, 0), 9);
}

TEST(Compare, ReciprocalTableHasNoAsymmetry) {
  BssrdfTable half = make_table(9, 8, 3, half_disc_offsets(2));
  fill_random(half, 5);
  TableHeader header = half.header;
  header.symmetric = false;
  header.offsets = disc_offsets(2);
  BssrdfTable full = make_bssrdf_table(header);
  for (int c = 0; c < 3; ++c)
    for (int d = 0; d < static_cast<int>(header.offsets.size()); ++d) {
      const Offset o = header.offsets[static_cast<std::size_t>(d)];
      const int forth = find_offset(half.header, o),
                back = find_offset(half.header, {-o.dx, -o.dy});
      const PixelRange range = pairs_in_grid(header, o);
      for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x)
          slice_of(full, c, d)[y * 9 + x] = forth >= 0
                                                ? value_at(half, c, forth, x, y)
                                                : value_at(half, c, back, x + o.dx, y + o.dy);
    }
  EXPECT_EQ(measure_asymmetry(*make_slices(full)), 0);
  const Image light = make_flat_light(FlatLight::disc, 9, 8, 1);
  EXPECT_LT(mse(relight(*make_slices(half), {light})[0], relight(*make_slices(full), {light})[0]),
            1e-12);
}

TEST(Compare, SameBitsForAnyNumberOfThreads) {
  BssrdfTable table = make_table(17, 14, 3, half_disc_offsets(5)), model = table;
  fill_random(table, 6, 0.05);
  fill_random(model, 7);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return compare_tables(table, model, {0.1, 1});
  };
  const CompareReport a = run(1), b = run(4);
  EXPECT_EQ(a.relative_error.mean, b.relative_error.mean);
  EXPECT_EQ(a.albedo_error_mean, b.albedo_error_mean);
  EXPECT_EQ(a.log_rms, b.log_rms);
  EXPECT_EQ(a.held_out->relative_error_l1.mean, b.held_out->relative_error_l1.mean);
  EXPECT_EQ(a.psnr_db.line, b.psnr_db.line);
  EXPECT_EQ(a.error_image.values, b.error_image.values);
}

TEST(Compare, ModelOffsetsMayComeInAnotherOrder) {
  BssrdfTable table = make_row({4, 8, 12}, 3, 6);
  BssrdfTable model = make_table(3, 1, 1, {{2, 0}, {1, 0}, {0, 0}}, 2);
  model.reflectance = {1, nan, nan, 3, 6, nan, 4, 8, 12};
  EXPECT_EQ(compare_tables(table, model).relative_error.max, 0);
}

TEST(Compare, DocumentHasExactlyTheDocumentedKeys) {
  const Document document = to_document(CompareReport{});
  std::vector<std::string> keys;
  for (const auto& [key, value] : as_object(document)) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"relative_error", "relative_error_l1", "albedo_error",
                                            "psnr_db", "ssim", "log_rms", "held_out",
                                            "missing_in_model", "pixels_skipped", "asymmetry",
                                            "bytes_table", "bytes_material"}));
}

std::string error_of(const BssrdfTable& table, const BssrdfTable& model) {
  return parian::error_of([&] { compare_tables(table, model); });
}

TEST(Compare, NamesWhatDoesNotMatch) {
  const BssrdfTable table = make_row({4, 8, 12}, 3, 6);
  EXPECT_EQ(error_of(table, make_table(3, 2, 3, {{0, 0}}, 2)),
            "model.h5: grid: expected 3 x 1 pixels, 1 channel as in the table, found 3 x 2 pixels, "
            "3 channels");
  EXPECT_EQ(error_of(table, make_table(3, 1, 1, {{0, 0}}, 1)),
            "model.h5: pixel_pitch_mm: expected 2 as in the table, found 1");
  EXPECT_EQ(error_of(table, make_table(3, 1, 1, {{0, 0}, {2, 0}}, 2)),
            "model.h5: offsets: expected all offsets of the table, (1, 0) among them, found 2 "
            "offsets without it");
}

}  // namespace
}  // namespace parian

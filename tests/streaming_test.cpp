// Tables on disk and in memory are the same table: fits, comparisons and relit flats agree bit for
// bit.
#include <gtest/gtest.h>

#include <string>

#include "base/error.h"
#include "fit/fit.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/json/test_folder.h"
#include "judge/compare.h"
#include "judge/relight.h"
#include "material/bssrdf_table.h"
#include "material/material.h"

namespace parian {
namespace {

const std::string stone = std::string(PARIAN_SOURCE_DIR) + "/data/stone-72x64.h5";

TEST(Streaming, FitsOfTheFileAndOfMemoryHaveTheSameBits) {
  const auto file = open_table(stone);
  const BssrdfTable table = read_table(*file);
  EXPECT_EQ(fit_profiles(*file, {}).map.log_profile,
            fit_profiles(*make_slices(table), {}).map.log_profile);
}

TEST(Streaming, CompressedTablesGiveTheSameFit) {
  const TestFolder folder("streaming");
  const std::string path = folder.at("deflated.h5");
  const auto file = open_table(stone);
  const auto sink = create_table(path, file->header(), {.deflate = 4});
  copy_slices(*file, *sink);
  FitParams params;
  params.segments = 7;
  EXPECT_EQ(fit_profiles(*open_table(path), params).map.log_profile,
            fit_profiles(*file, params).map.log_profile);
}

// The stated targets on the table of an independent writer.
TEST(Targets, StoneIsFittedWithinTheStatedErrors) {
  const auto file = open_table(stone);
  const Material fitted = fit_profiles(*file, {}).map;
  const CompareReport report = compare(*file, *make_slices(fitted, file->header()));
  EXPECT_LE(report.relative_error.mean, 0.0255);
  EXPECT_LE(report.albedo_error_mean, 0.0032);
  EXPECT_EQ(report.pixels_skipped, 0u);
  EXPECT_EQ(report.missing_in_model, 0u);
}

TEST(Streaming, MapsSurviveTheFile) {
  const TestFolder folder("streaming");
  const std::string path = folder.at("map.h5");
  FitParams params;
  params.segments = 5;
  params.hold_out = 0.05;
  const ProfileMap map = fit_profiles(*open_table(stone), params).map;
  save_profile_map(path, map);
  const ProfileMap loaded = load_profile_map(path);
  EXPECT_EQ(loaded.log_profile, map.log_profile);
  EXPECT_EQ(loaded.knots_mm, map.knots_mm);
  EXPECT_EQ(loaded.hold_out.fraction, 0.05);
  EXPECT_EQ(loaded.hold_out.seed, map.hold_out.seed);
}

// Held-out pairs are judged, and judged a little worse than the fitted ones.
TEST(Targets, HeldOutErrorsAreReportedAndClose) {
  FitParams params;
  params.hold_out = 0.05;
  const auto file = open_table(stone);
  const ProfileMap map = fit_profiles(*file, params).map;
  const Material fitted = map;
  const CompareReport report = compare(*file, *make_slices(fitted, file->header()), map.hold_out);
  ASSERT_TRUE(report.held_out.has_value());
  EXPECT_GT(report.held_out->pairs, 10'000u);
  EXPECT_LT(report.held_out->relative_error.mean, 4 * report.relative_error.mean);
}

}  // namespace
}  // namespace parian

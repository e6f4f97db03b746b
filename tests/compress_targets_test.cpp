// What compression has to reach on the stone of an independent writer, at the paper's bytes.
#include <gtest/gtest.h>

#include "compress/compress.h"
#include "fit/fit.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/table_file.h"
#include "judge/compare.h"
#include "material/material.h"

namespace parian {
namespace {

TEST(CompressTargets, Stone) {
  const auto table = open_table(PARIAN_SOURCE_DIR "/data/stone-72x64.h5");
  const ProfileMap map = fit_profiles(*table, {}).map;
  const auto errors_of = [&](const ProfileBlend& blend) {
    const Material material = blend;
    return compare(*table, *make_slices(material, table->header()));
  };
  CompressParams params;  // K = 2, M = 128
  const ProfileBlend paper = compress_profiles(map, table.get(), params);
  const CompareReport errors = errors_of(paper);
  EXPECT_LE(errors.relative_error.mean, 0.046);
  EXPECT_LE(errors.albedo_error_mean, 0.0153);
  EXPECT_GE(errors.psnr_db.uniform, 41.5);

  params.weight_levels = default_weight_levels;
  params.profile_step = default_profile_step;
  const ProfileBlend lattice = compress_profiles(map, table.get(), params);
  const std::string packed = encode_blend(lattice, BlendEncoding::packed);
  EXPECT_LE(2 * packed.size(), encode_blend(paper, BlendEncoding::paper).size());
  const CompareReport kept = errors_of(decode_blend(packed, "packed"));
  EXPECT_LE(kept.relative_error.mean, 1.01 * errors.relative_error.mean);
  EXPECT_LE(kept.albedo_error_mean, 1.01 * errors.albedo_error_mean);
}

}  // namespace
}  // namespace parian

// The whole path from a table over photographs to a table.
#include "acquire/capture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "acquire/capture_synthesize.h"
#include "acquire/sample.h"
#include "acquire/test_documents_internal.h"
#include "judge/compare.h"

namespace parian {
namespace {

// A small board of two materials; offsets far enough for tails of neighbouring dots.
BssrdfTable make_truth(double radius_px, int channels = 1) {
  Document document = chessboard_description();
  if (channels == 1)
    set(document, "materials",
        array({object({{"name", "white"}, {"material", "Marble"}}),
               object({{"name", "dark"}, {"sigma_a", 0.2}, {"sigma_s_prime", 1.1}})}));
  set(document, "channels", channels);
  set(document, "radius_px", radius_px);
  return read_table(*make_analytic_source(read_sample(locate(document), {})));
}

CaptureMeta make_meta(const BssrdfTable& truth) {
  CaptureMeta meta;
  meta.width = truth.header.width;
  meta.height = truth.header.height;
  meta.channels = truth.header.channels;
  meta.pixel_pitch_mm = truth.header.pixel_pitch_mm;
  meta.lattice_px = 9;
  meta.radius_px = 4;
  return meta;
}

struct Folder {
  CaptureMeta meta;
  std::map<std::string, Image> frames;
};
Folder synthesize(const BssrdfTable& truth, CaptureMeta meta, const PhotographParams& params) {
  make_camera(params, meta);
  Folder folder{meta, {}};
  synthesize_capture(truth, meta, params, [&](const FrameName& name, const Image& image) {
    Image codes = image;
    if (meta.format != FrameFormat::exr) {
      const float top = meta.format == FrameFormat::png8 ? 255.0f : 65535.0f;
      for (float& value : codes.values) value = std::round(value * top) / top;
    }
    folder.frames[frame_file(meta, name)] = codes;
  });
  return folder;
}
CaptureResult process(const Folder& folder) {
  return process_capture(folder.meta, [&](const FrameName& name) {
    return folder.frames.at(frame_file(folder.meta, name));
  });
}
CompareReport judge(const BssrdfTable& truth, const BssrdfTable& found) {
  // At the offsets that were captured.
  BssrdfTable part = make_bssrdf_table([&] {
    TableHeader header = truth.header;
    header.offsets = found.header.offsets;
    return header;
  }());
  for (int c = 0; c < part.header.channels; ++c)
    for (std::size_t d = 0; d < part.header.offsets.size(); ++d) {
      const float* from = slice_of(truth, c, find_offset(truth.header, part.header.offsets[d]));
      std::copy(from, from + part.header.pixels(), slice_of(part, c, static_cast<int>(d)));
    }
  return compare(*make_slices(part), *make_slices(found), {});
}

TEST(Capture, RoundTripWithARealisticCamera) {
  const BssrdfTable truth = make_truth(14);
  const Folder folder = synthesize(truth, make_meta(truth), {});
  const CaptureResult result = process(folder);
  const CompareReport report = judge(truth, result.table);
  printf("rel %g max %g albedo %g max %g logrms %g | %s\n", report.relative_error.mean,
         report.relative_error.max, report.albedo_error_mean, report.albedo_error_max,
         report.log_rms, "");
  const CaptureReport& r = result.report;
  printf("psf %g reproj %g well %g read %g asym %g white %g tail %g noise %g %g %g sat %g\n",
         r.psf_px, r.reprojection_px, r.camera.full_well, r.camera.read * r.camera.full_well,
         r.asymmetry, r.white_error, r.tail_fraction, r.noise[0].floor, r.noise[0].gain,
         r.noise[0].relative, r.saturated_fraction);
  EXPECT_LT(report.relative_error.mean, 0.03);
  EXPECT_LT(report.albedo_error_mean, 0.01);
}

}  // namespace
}  // namespace parian

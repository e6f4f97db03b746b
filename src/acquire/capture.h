// Photographs of a projected dot grid to a table (docs/capture.md). All stages are functions of
// their own: capture_photometry.h, capture_geometry.h, capture_resample.h, capture_slices.h.
#pragma once

#include <string>

#include "acquire/capture_geometry.h"
#include "acquire/capture_meta.h"
#include "acquire/capture_photometry.h"
#include "acquire/capture_slices.h"
#include "base/document.h"
#include "base/progress.h"
#include "material/bssrdf_table.h"

namespace parian {

struct CaptureReport {
  CameraNoise camera;  // given, or found
  Homography mm_to_px;
  int dots_found = 0;          // 0 with given points
  double reprojection_px = 0;  // root mean square
  double psf_px = 0;
  double dot_power_spread = 0;    // standard deviation / mean of the dots on the standard
  double saturated_fraction = 0;  // of the dot frames' pixels, at every exposure
  double tail_fraction = 0;       // light of neighbouring dots that was taken away
  int centre_offsets = 0;         // replaced
  double asymmetry = 0;           // |R - R^T| / |R|, vignetting included
  double white_error = 0;         // |sum of dot frames - white| / |white|
  std::vector<NoiseModel> noise;  // per channel
};
Document to_document(const CaptureReport& report);

struct CaptureResult {
  BssrdfTable table;  // symmetric
  BssrdfTable raw;    // both directions, symmetric = false
  CaptureReport report;
};

// load_frame is called from several threads at once. Frames must have the size and channels of
// `meta` (contract: the loader checks). Throws Error without a file: the place is a stage or role.
CaptureResult process_capture(const CaptureMeta& meta, const FrameLoader& load_frame,
                              const Progress& progress = {});

}  // namespace parian

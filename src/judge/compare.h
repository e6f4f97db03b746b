// Error reports: a model against the measured table, with the keys of `compare --json`.
//
// A pair is compared where both sources have a value. In sums over the pairs of a pixel each listed
// value counts at x and at x + d, (0,0) once, also where both directions are listed. Light is
// another matter: of a table with both directions, x only sends light to where it leaves, so rho
// and the relit flats sum R_d(x, x + d) at x alone.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/document.h"
#include "base/progress.h"
#include "image/image.h"
#include "material/profile_map.h"
#include "material/slices.h"

namespace parian {

struct MinMeanMax {
  double min = 0, mean = 0, max = 0;
};

// One number per flat light; PSNR is +infinity when the images are identical.
struct PerLight {
  double uniform = 0, disc = 0, line = 0;
};

// The same errors over the pairs kept out of the fit alone; pixels without one are left out.
struct HeldOutErrors {
  MinMeanMax relative_error;
  MinMeanMax relative_error_l1;
  double log_rms = 0;
  std::size_t pairs = 0;  // values compared, each listed one once
};

// Errors of which there is none (no pixel or no value to compare) are NaN, null in the document.
struct CompareReport {
  MinMeanMax relative_error;     // per pixel, L2 over pairs and channels, over that of the data
  MinMeanMax relative_error_l1;  // likewise with absolute values
  double albedo_error_mean = 0;  // per pixel |rho - rho'| / |rho|, Euclidean over channels
  double albedo_error_max = 0;
  PerLight psnr_db;  // of the flats relit with the compared pairs of the data and of the model
  PerLight ssim;
  // Of ln R'/R over R > max(0, noise_floor); neither counts as less than the smallest normal float.
  double log_rms = 0;
  std::optional<HeldOutErrors> held_out;  // where the model's fit held pairs out
  std::size_t missing_in_model = 0;       // measured values where the model has NaN: not compared
  std::size_t pixels_skipped = 0;         // without a compared pair, or with data that are all zero
  std::optional<double> asymmetry;        // |R - R^T| / |R| of tables with both directions
  std::size_t bytes_table = 0;            // 4 C D H W
  std::size_t bytes_material = 0;         // file size, set by the caller
  Image error_image;                      // 1 channel: relative error per pixel, NaN where skipped
};

// Streams both sources once, channel after channel (and the table once more where it lists both
// directions), with memory for a few slices per thread and a few numbers per pixel. The same bits
// for any number of threads. Throws Error, naming the model, when grid, channels or pitch differ or
// it lacks an offset of the table.
CompareReport compare(const SliceSource& table, const SliceSource& model,
                      const HoldOut& hold_out = {}, const Progress& progress = {});

// What is not finite becomes null.
Document to_document(const CompareReport& report);

}  // namespace parian

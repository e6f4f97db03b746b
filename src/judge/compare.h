// Error reports: a model against the measured table (design: the keys of `compare --json`).
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

struct HeldOutErrors {
  MinMeanMax relative_error;
  MinMeanMax relative_error_l1;
  double log_rms = 0;
  std::size_t pairs = 0;
};

struct CompareReport {
  MinMeanMax
      relative_error;  // per pixel, L2 over measured pairs and channels, over that of the data
  MinMeanMax relative_error_l1;  // likewise with absolute values
  double albedo_error_mean = 0;  // per pixel |rho - rho'| / |rho|, Euclidean over channels
  double albedo_error_max = 0;
  PerLight psnr_db;
  PerLight ssim;
  double log_rms = 0;                     // of ln R'/R over R > max(0, noise_floor)
  std::optional<HeldOutErrors> held_out;  // where the model's fit held pairs out
  std::size_t missing_in_model = 0;       // measured pairs where the model has NaN
  std::size_t pixels_skipped = 0;         // without a measured pair
  std::optional<double> asymmetry;        // |R - R^T| / |R| of tables with both directions
  std::size_t bytes_table = 0;            // 4 C D H W
  std::size_t bytes_material = 0;         // file size, set by the caller
  Image error_image;                      // 1 channel: relative error per pixel, NaN where skipped
};

// Both sources have the same grid and channels; the model's offsets include the table's. Each
// measured value counts at x and at x + d, (0,0) once. Streams both once.
CompareReport compare(const SliceSource& table, const SliceSource& model,
                      const HoldOut& hold_out = {}, const Progress& progress = {});

Document to_document(const CompareReport& report);

}  // namespace parian

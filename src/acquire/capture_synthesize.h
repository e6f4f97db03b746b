// The photographs that a camera would take of a sample whose table is known: the input of a capture
// with a known answer. Projector, camera and their faults are modelled apart from how capture.h
// undoes them.
#pragma once

#include <cstdint>
#include <functional>

#include "acquire/capture_geometry.h"
#include "acquire/capture_meta.h"
#include "base/progress.h"
#include "material/bssrdf_table.h"

namespace parian {

struct PhotographParams {
  double scale = 3;              // camera pixels per pixel of the table
  double rotation_deg = 2;       // of the camera
  double perspective = 0.03;     // change of scale across the picture
  double blur_px = 0.8;          // standard deviation, camera pixels
  double vignetting = 0.2;       // loss in the picture's corners
  double nonuniformity = 0.1;    // of the projector: falls across the sample by this
  double black_level = 0.002;    // of the projector, relative to white
  double specular = 0;           // part of a dot's light that is reflected where it falls
  double dark_level = 0.01;      // offset of the camera's codes
  double full_well = 30000;      // electrons at code 1; 0: no noise
  double read_noise = 4;         // electrons
  double reference_level = 0.7;  // code of the standard under white light, shortest exposure
  std::uint64_t seed = 1;
};
ParamList describe(PhotographParams& params);

// What the camera sees: sets meta's camera size, and the homography of the params.
Homography make_camera(const PhotographParams& params, CaptureMeta& meta);

// Calls save once for every frame of list_frames(meta), with codes in [0, 1] that are not rounded
// yet; from one thread. `truth` has meta's grid and channels, is symmetric, and counts as means
// over pixels; pairs that are farther than meta.radius_px show as neighbours' tails. The same bits
// for the same seed and any number of threads.
void synthesize_capture(const BssrdfTable& truth, const CaptureMeta& meta,
                        const PhotographParams& params,
                        const std::function<void(const FrameName&, const Image&)>& save,
                        const Progress& progress = {});

}  // namespace parian

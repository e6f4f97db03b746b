// What a folder of photographs says about itself: a dot grid is projected on a planar sample and
// shifted over all places of a lattice, a camera looks at it (Peers et al. 2006; Song et al. 2009,
// section 4). docs/capture.md explains the folder, data/schema/capture.schema.json its meta.json.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/document.h"
#include "base/params.h"
#include "image/image.h"

namespace parian {

enum class FrameRole {
  dark,             // projector and room dark
  black,            // projector on, showing black, on the sample
  white,            // projector white, on the sample
  reference_black,  // the same two on the diffuse standard
  reference,
  reference_dots,  // dot frame (0, 0) on the standard
  dots,            // on the sample: one frame for each shift (i, j)
};
enum class FrameFormat { png8, png16, exr };
enum class ResponseKind { linear, srgb, recover };

struct FrameName {
  FrameRole role = FrameRole::dots;
  int i = 0, j = 0;  // shift of the lattice in table pixels, of dots
  int exposure = 0;  // index into exposures_s
  int repeat = 0;    // of calibration frames, all but dots
};

// A point of the sample and where the camera sees it, in pixels from the corner of pixel (0, 0).
struct PointPair {
  double x_mm = 0, y_mm = 0;
  double x_px = 0, y_px = 0;
};

struct CaptureMeta {
  int width = 32, height = 32;  // of the table
  double pixel_pitch_mm = 0.5;  // of the table; a dot covers one of its pixels
  int lattice_px = 12;          // distance of the dots of one frame, in table pixels
  double radius_px = 5;         // of the table's offsets, at most half the lattice
  int camera_width = 128, camera_height = 128;
  int channels = 3;
  std::vector<double> exposures_s{0.01, 0.08, 0.64};  // increasing
  int calibration_frames = 4;                         // of each exposure, all roles but dots
  FrameFormat format = FrameFormat::png16;
  ResponseKind response = ResponseKind::linear;
  double saturation = 0.95;        // codes from here on are not used
  double reference_albedo = 0.99;  // of the diffuse standard
  double full_well = 0;            // electrons at code 1; 0: found from the calibration frames
  double read_noise = 0;           // electrons, with full_well
  double psf_px = 0;               // standard deviation of the blur; 0: found from reference_dots
  double centre_px = 0;            // R nearer than this is extrapolated: specular light
  double eta = 1.3;
  bool synthetic = false;         // made by --synthesize, and so is every table made from it
  std::vector<PointPair> points;  // instead of the dots of reference_dots
};
ParamList describe(CaptureMeta& meta);

// Reads and checks meta.json; errors name file and JSON pointer.
CaptureMeta read_capture_meta(const Document& document);
Document write_capture_meta(const CaptureMeta& meta);

// "dots_003_011_2.png", "dark_2_0.png": role, shift, exposure, repeat.
std::string frame_file(const CaptureMeta& meta, const FrameName& frame);
// All frames of a folder, in a fixed order.
std::vector<FrameName> list_frames(const CaptureMeta& meta);
// Dots of one frame along the axes: table pixels x = i + k lattice_px below width.
int dots_along(int size, int shift, int lattice_px);

// Codes in [0, 1] as the camera stored them, or linear values of an EXR.
using FrameLoader = std::function<Image(const FrameName& frame)>;

}  // namespace parian

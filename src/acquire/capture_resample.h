// A photograph resampled to the table's grid: the exitance of the grid's pixels, constant in each,
// whose image through homography, Gaussian blur and camera pixels explains the photograph best.
// That takes the blur out too.
#pragma once

#include <cstdint>
#include <vector>

#include "acquire/capture_geometry.h"
#include "acquire/capture_photometry.h"

namespace parian {

// The grid has a margin of pixels around the table: light leaves there too.
inline constexpr int resample_margin_px = 2;

// I = B e: camera pixels that see a pixel of the grid, [begin[k], begin[k + 1]).
struct CameraOperator {
  int width = 0, height = 0;  // of the grid, margins included
  int camera_width = 0, camera_height = 0;
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> camera_pixel;
  std::vector<float> weight;
};
// `mm_to_px`: homography; psf_px: standard deviation of the blur in camera pixels.
CameraOperator make_camera_operator(const CaptureMeta& meta, const Homography& mm_to_px,
                                    double psf_px);

// What a camera without noise sees of the exitance [y][x].
std::vector<float> photograph(const CameraOperator& b, const std::vector<float>& exitance);

// Minimises sum of (I - B e)^2 / variance over one channel, by conjugate gradients with a diagonal
// preconditioner. Variances are smoothed over 3 x 3 pixels first, as a value and its own variance
// err together; pixels with infinite variance do not count. [y][x] without margins; NaN where more
// than half of what the camera sees of a pixel does not count.
std::vector<float> resample(const CameraOperator& b, const HdrImage& image, int channel);

// The dots of frame (0, 0) on the standard, as bright as `white` (the standard under white light)
// is at their centres. All images here have one channel.
Image predict_dots(const CaptureMeta& meta, const Homography& mm_to_px, double psf_px,
                   const Image& white);

// The blur with which such dots look as they do.
double estimate_psf(const CaptureMeta& meta, const Homography& mm_to_px, const Image& dots,
                    const Image& white);

}  // namespace parian

// Where the camera sees the sample: dots are found in a photograph, given their places on the
// lattice, and a homography is fitted to them.
#pragma once

#include <array>
#include <vector>

#include "acquire/capture_meta.h"
#include "image/image.h"

namespace parian {

// (x, y, w) = m (x, y, 1), row by row: millimetres of the sample to pixels of the camera, both from
// the corner of pixel (0, 0).
struct Homography {
  std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};
};
struct Point {
  double x = 0, y = 0;
};
Point apply(const Homography& h, double x, double y);
Homography invert(const Homography& h);
// |det| of the derivative: area in the image per area of the sample.
double area_scale(const Homography& h, double x, double y);

// Least squares over the algebraic error with normalised coordinates (Hartley 1997). Throws Error
// for fewer than four points or points on one line.
Homography fit_homography(const std::vector<PointPair>& points);
// Root mean square distance in camera pixels.
double reprojection_error(const Homography& h, const std::vector<PointPair>& points);

struct Dot {
  double x = 0, y = 0;  // centroid in camera pixels
  double power = 0;     // sum of the values in its region
};
// Connected regions of at least 2 pixels that are brighter than 0.3 of the brightest pixel, and
// whose centroid includes what surrounds them. Throws Error "dots" when the image has no contrast.
std::vector<Dot> find_dots(const Image& image);

// Each dot's place of dot frame (0, 0) in mm. The x axis of the lattice lies within 40 degrees of
// the image's. Throws Error "lattice" when the dots do not make the lattice that `meta` describes.
std::vector<PointPair> match_lattice(const std::vector<Dot>& dots, const CaptureMeta& meta);

}  // namespace parian

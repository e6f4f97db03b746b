// From points of a surface to places in the sample's plane.
#pragma once

#include "mesh/mesh.h"
#include "scene/scene.h"

namespace parian {

// A sample's grid as the mapping needs it.
struct SampleGrid {
  int width = 1;
  int height = 1;
  double pixel_pitch_mm = 1;
};

// Where a surface point lies in the sample: pixel coordinates after mirrored tiling, so inside
// [-0.5, width - 0.5) x [-0.5, height - 0.5), and the tangent directions (unit, orthogonal to the
// point's normal and to each other) along which x and y grow there. In mirrored tiles the
// directions are mirrored too, so the frame may be left-handed.
struct SamplePoint {
  double x = 0;
  double y = 0;
  Vec3 along_x{1, 0, 0};
  Vec3 along_y{0, 1, 0};
};
SamplePoint map_to_sample(const Mapping& mapping, const SampleGrid& grid,
                          const SurfacePoint& point);

// x reflected at the borders -0.5 and size - 0.5 of the grid, as often as needed; `mirrored` says
// whether the tile is a mirrored one.
double mirror_tile(double x, int size, bool& mirrored);

}  // namespace parian

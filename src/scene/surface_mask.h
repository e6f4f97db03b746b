// Where on a surface something applies: weights in [0, 1] from images, vertices or formulas, in mm
// of the mesh at its place. All edges fall smoothly (3 t^2 - 2 t^3) over their feather, beyond the
// region that they bound.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/params.h"
#include "image/image.h"
#include "mesh/mesh.h"

namespace parian {

// Painted: one weight per vertex of the file that the mesh is from (TriangleMesh::source).
struct VertexMask {
  std::vector<float> weights;
  std::string file = {};  // that they are from, as descriptions say it
};
// An image of one channel at the texture coordinates, bilinear; repeats beyond [0, 1].
struct TextureMask {
  Image image;
  std::string file = {};
};
// A rectangle, or an image of that size, cast through the object along a direction.
struct ProjectedMask {
  Image image;  // one channel; width 0: 1 everywhere
  Vec3 center;
  Vec3 direction{0, 0, -1};  // unit, in which it is cast
  Vec3 up{0, 1, 0};          // the image's, projected; not along the direction
  double width_mm = 10;
  double height_mm = 10;
  double feather_mm = 0;
  bool facing = true;  // only on faces that look against the direction, smoothly over the last 15
                       // degrees
  std::string file = {};
};
// 0 at and before the one point, 1 at and beyond the other.
struct GradientMask {
  Vec3 from{0, 0, 0};
  Vec3 to{0, 10, 0};
};
struct SphereMask {
  Vec3 center;
  double radius_mm = 10;
  double feather_mm = 0;
};
// From a point on along a direction; thickness 0: without end.
struct SlabMask {
  Vec3 point;
  Vec3 direction{0, 1, 0};  // unit
  double thickness_mm = 0;
  double feather_mm = 0;
};
// Where noise of values at random (seeded) exceeds a threshold. Octaves halve in size and weight.
struct NoiseMask {
  double scale_mm = 10;  // of the largest lattice
  double threshold = 0.5;
  double softness = 0.1;  // of the noise, whose values lie in [0, 1]
  int octaves = 3;
  std::uint64_t seed = 1;
};
struct StripesMask {
  Vec3 direction{0, 1, 0};  // unit, across the stripes
  double period_mm = 10;
  double fraction = 0.5;  // of the period that a stripe covers
  double offset_mm = 0;   // of a stripe's edge from the origin
  double feather_mm = 0;
};

using MaskShape = std::variant<VertexMask, TextureMask, ProjectedMask, GradientMask, SphereMask,
                               SlabMask, NoiseMask, StripesMask>;
struct MaskTerm {
  MaskShape shape;
  bool invert = false;  // 1 - weight
};
// The product of its terms; without any, 1 everywhere.
using SurfaceMask = std::vector<MaskTerm>;

// The plain numbers of each; ranges and JSON keys come from here.
ParamList describe(VertexMask& mask);
ParamList describe(TextureMask& mask);
ParamList describe(ProjectedMask& mask);
ParamList describe(GradientMask& mask);
ParamList describe(SphereMask& mask);
ParamList describe(SlabMask& mask);
ParamList describe(NoiseMask& mask);
ParamList describe(StripesMask& mask);

// An image from outside as masks want it: one channel, the luminance of three, clamped to [0, 1].
// Throws Error with `name` as its file for values that are not finite.
Image make_mask_image(const Image& image, const std::string& name);

// Throws Error (its place starts with `place`) for parameters out of range and for masks that this
// mesh cannot carry: weights for another number of vertices, no texture coordinates.
void check(const SurfaceMask& mask, const TriangleMesh& mesh, const std::string& file,
           const std::string& place);

// In [0, 1]. The mesh is the one that the point lies on, and has been checked.
double eval_mask(const SurfaceMask& mask, const TriangleMesh& mesh, const SurfacePoint& point);

}  // namespace parian

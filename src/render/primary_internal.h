// What the camera sees: every sub-pixel ray's hit, and the few points per pixel for which light is
// gathered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "mesh/ray_tracer.h"
#include "scene/camera.h"

namespace parian {

struct PrimaryHit {
  std::uint32_t triangle = 0;
  Vec2 barycentric;
  std::uint32_t target = 0;   // index of its gather target
  std::uint16_t sub_ray = 0;  // of antialias^2
  bool from_inside = false;
};

// A point of the mesh.
struct MeshPlace {
  std::uint32_t triangle = 0;
  Vec2 barycentric;
};

struct PrimaryView {
  CameraFrame frame;
  int antialias = 1;
  std::vector<std::size_t> begin;  // [height * width + 1], of each pixel's hits
  std::vector<PrimaryHit> hits;
  std::vector<MeshPlace> targets;
  std::size_t from_inside = 0;  // hits of back faces
};

// Most targets of one pixel; further hits share the nearest.
inline constexpr std::size_t max_targets_per_pixel = 4;

// Hits of one pixel that lie within a few of its footprints and whose normals agree share a target:
// the hit nearest to their mean.
PrimaryView trace_primary(const TriangleMesh& mesh, const RayTracer& tracer, const Camera& camera,
                          int antialias, const Progress& progress);

// Through the middle of the sub-pixel: a fixed pattern, stratified in x, in y and in both.
CameraRay make_sub_ray(const CameraFrame& frame, int antialias, int x, int y, int sub_ray);

}  // namespace parian

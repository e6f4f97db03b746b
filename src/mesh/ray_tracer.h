// Rays against one mesh (Embree behind it).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "mesh/mesh.h"

namespace parian {

struct Ray {
  Vec3 origin;
  Vec3 direction;  // unit length
  float t_min = 0;
  float t_max = std::numeric_limits<float>::infinity();
};

struct Hit {
  float t = 0;
  std::uint32_t triangle = 0;
  Vec2 barycentric;          // as get_surface_point wants it
  bool from_inside = false;  // the ray met the triangle's back
};

// Holds a copy of the geometry; calls are thread-safe. Both sides of triangles are hit.
// Deterministic. Robust at edges: closed meshes are tight but for a few in a thousand of the rays
// that go through a vertex to the last bit.
class RayTracer {
 public:
  explicit RayTracer(const TriangleMesh& mesh);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;

  std::optional<Hit> intersect(const Ray& ray) const;
  bool is_occluded(const Ray& ray) const;
  // A distance that separates a ray's origin from the surface it starts on: a small part of the
  // mesh's size, above Embree's error.
  float epsilon_mm() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

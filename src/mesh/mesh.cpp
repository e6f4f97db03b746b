// Sizes of meshes, points on them and vertex normals.
#include "mesh/mesh.h"

#include "base/check.h"
#include "base/parallel.h"
#include "mesh/topology_internal.h"

namespace parian {
namespace {

constexpr std::size_t block = 4096;

// The vector in the triangle's plane along which a linear function with differences a and b along
// the edges e1 and e2 grows fastest, of the length over which it grows by one: g / |g|^2 with the
// gradient g = (a e2 x N + b N x e1) / |N|^2, N = e1 x e2.
Vec3 growth_vector(Vec3d e1, Vec3d e2, Vec3d normal, double a, double b) {
  const double squared = dot(normal, normal);
  if (squared <= 0) return {};
  const Vec3d g = (cross(e2, normal) * a + cross(normal, e1) * b) * (1 / squared);
  const double slope = dot(g, g);
  return slope > 0 ? to_float(g * (1 / slope)) : Vec3{};
}

void set_texture_frame(const TriangleMesh& mesh, const Triangle& t, Vec2 barycentric,
                       SurfacePoint& point) {
  const Vec2 uv = mesh.texcoords[t[0]];
  const Vec2 d1 = mesh.texcoords[t[1]] - uv;
  const Vec2 d2 = mesh.texcoords[t[2]] - uv;
  point.texcoord = uv + d1 * barycentric.x + d2 * barycentric.y;
  const Vec3d p = to_double(mesh.positions[t[0]]);
  const Vec3d e1 = to_double(mesh.positions[t[1]]) - p;
  const Vec3d e2 = to_double(mesh.positions[t[2]]) - p;
  const Vec3d normal = cross(e1, e2);
  point.dp_du = growth_vector(e1, e2, normal, d1.x, d2.x);
  point.dp_dv = growth_vector(e1, e2, normal, d1.y, d2.y);
}

}  // namespace

Bounds3 bounds(const TriangleMesh& mesh) {
  Bounds3 box;
  for (const Vec3& p : mesh.positions) extend(box, p);
  return box;
}

double surface_area(const TriangleMesh& mesh) {
  return parallel_sum(mesh.triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t t = begin; t < end; ++t)
      sum += 0.5 * length(double_area_normal(mesh, mesh.triangles[t]));
    return sum;
  });
}

double enclosed_volume(const TriangleMesh& mesh) {
  if (mesh.positions.empty()) return 0;
  // Tetrahedra to a point amid the mesh: a box far from the origin cancels no digits.
  const Vec3d apex = to_double(center(bounds(mesh)));
  return parallel_sum(mesh.triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[i];
      sum += dot(to_double(mesh.positions[t[0]]) - apex, double_area_normal(mesh, t)) / 6;
    }
    return sum;
  });
}

SurfacePoint get_surface_point(const TriangleMesh& mesh, std::uint32_t triangle, Vec2 barycentric) {
  const Triangle& t = mesh.triangles[triangle];
  const float w = 1 - barycentric.x - barycentric.y;
  const auto mix = [&](const std::vector<Vec3>& values) {
    return values[t[0]] * w + values[t[1]] * barycentric.x + values[t[2]] * barycentric.y;
  };
  SurfacePoint point;
  point.triangle = triangle;
  point.position = mix(mesh.positions);
  point.geometric_normal = to_unit(double_area_normal(mesh, t));
  point.normal = mesh.normals.empty() ? point.geometric_normal : normalize(mix(mesh.normals));
  if (point.normal == Vec3{}) point.normal = point.geometric_normal;  // opposite vertex normals
  if (!mesh.texcoords.empty()) set_texture_frame(mesh, t, barycentric, point);
  return point;
}

void compute_normals(TriangleMesh& mesh) {
  // By position, so that a texture seam is no crease.
  const std::vector<std::uint32_t> weld = weld_positions(mesh.positions);
  std::vector<Vec3d> sums(mesh.positions.size());
  std::vector<Vec3> any(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3d normal = double_area_normal(mesh, t);
    for (const std::uint32_t v : t) {
      sums[weld[v]] = sums[weld[v]] + normal;
      if (any[weld[v]] == Vec3{}) any[weld[v]] = to_unit(normal);
    }
  }
  mesh.normals.resize(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    mesh.normals[v] = to_unit(sums[weld[v]]);
    // Where the faces' normals cancel (both sides of a sheet without thickness), one of them.
    if (mesh.normals[v] == Vec3{}) mesh.normals[v] = any[weld[v]];
  }
}

void fit_to_size(TriangleMesh& mesh, double size_mm) {
  const Bounds3 box = bounds(mesh);
  const Vec3 size = extent(box);
  const double longest = std::max({size.x, size.y, size.z});
  PARIAN_CHECK_LT(0.0, longest);
  PARIAN_CHECK_LT(0.0, size_mm);
  const double scale = size_mm / longest;
  const Vec3d middle = (to_double(box.lower) + to_double(box.upper)) * 0.5;
  const Vec3d anchor{middle.x, box.lower.y, middle.z};
  for (Vec3& p : mesh.positions) p = to_float((to_double(p) - anchor) * scale);
}

}  // namespace parian

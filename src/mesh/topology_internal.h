// Which vertices share a position and which triangles share an edge. Internal to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/mesh.h"

namespace parian {

using Triangle = std::array<std::uint32_t, 3>;

// result[i] = the first j <= i whose `words` 32-bit words equal those of i.
std::vector<std::uint32_t> find_first_equals(const std::uint32_t* keys, std::size_t count,
                                             std::size_t words);
// The same for exactly equal positions (-0 = 0).
std::vector<std::uint32_t> weld_positions(std::span<const Vec3> positions);

// Corner 3 t + k stands for the edge from vertex k of triangle t to its vertex (k + 1) % 3.
// Calls visit(corners, count) for each edge between welded vertices with all corners on it, in a
// fixed order.
template <typename Visit>
void for_each_edge(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld,
                   const Visit& visit);

struct Vec3d {
  double x = 0;
  double y = 0;
  double z = 0;
};
inline Vec3d to_double(Vec3 a) {
  return {a.x, a.y, a.z};
}
inline Vec3d operator-(Vec3d a, Vec3d b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3d operator+(Vec3d a, Vec3d b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3d operator*(Vec3d a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Vec3d cross(Vec3d a, Vec3d b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double dot(Vec3d a, Vec3d b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double length(Vec3d a) {
  return std::sqrt(dot(a, a));
}
inline Vec3 to_float(Vec3d a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}
// Zero stays zero.
inline Vec3 to_unit(Vec3d a) {
  const double l = length(a);
  return l > 0 ? to_float(a * (1 / l)) : Vec3{};
}
// Cross product of two edges: twice the area along the outward normal.
inline Vec3d double_area_normal(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  return cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a);
}

namespace detail {
struct EdgeCorners {
  std::vector<std::uint32_t> begin;                             // by the edge's lower vertex
  std::vector<std::pair<std::uint32_t, std::uint32_t>> others;  // higher vertex, corner
};
EdgeCorners group_edges(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld);
}  // namespace detail

template <typename Visit>
void for_each_edge(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld,
                   const Visit& visit) {
  const detail::EdgeCorners edges = detail::group_edges(triangles, weld);
  std::vector<std::uint32_t> corners;
  for (std::size_t v = 0; v + 1 < edges.begin.size(); ++v) {
    for (std::size_t i = edges.begin[v]; i < edges.begin[v + 1];) {
      corners.clear();
      const std::uint32_t other = edges.others[i].first;
      for (; i < edges.begin[v + 1] && edges.others[i].first == other; ++i)
        corners.push_back(edges.others[i].second);
      visit(corners.data(), corners.size());
    }
  }
}

}  // namespace parian

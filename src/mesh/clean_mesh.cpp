// Meshes from outside: what is wrong with them is named, and what can be mended is.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "mesh/flaps_internal.h"
#include "mesh/mesh.h"
#include "mesh/orient_internal.h"
#include "mesh/topology_internal.h"

namespace parian {
namespace {

// Beyond this, squares of lengths would leave the range of float.
constexpr float largest_coordinate = 1e15f;
// Of the longest edge's square: doubled areas below are rounding errors.
constexpr double least_relative_area = 1e-10;

void check_sizes(const TriangleMesh& mesh, const std::string& name) {
  const std::size_t vertices = mesh.positions.size();
  const auto check_attribute = [&](std::size_t size, const char* what) {
    if (size != 0 && size != vertices)
      throw Error({name, what, fmt::format("{}, one per vertex", vertices), fmt::to_string(size)});
  };
  if (mesh.triangles.empty()) throw Error({name, "", "a mesh with faces", "no faces"});
  check_attribute(mesh.normals.size(), "normals");
  check_attribute(mesh.texcoords.size(), "texture coordinates");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= vertices)
        throw Error({name, fmt::format("triangle {}", t),
                     fmt::format("a vertex below {}", vertices), fmt::to_string(v)});
}

void check_vertex(const TriangleMesh& mesh, std::size_t v, const std::string& name) {
  const Vec3 p = mesh.positions[v];
  for (const float value : {p.x, p.y, p.z})
    if (!(std::abs(value) <= largest_coordinate))
      throw Error({name, fmt::format("vertex {}", v), "coordinates that are finite and below 1e15",
                   fmt::format("({}, {}, {})", p.x, p.y, p.z)});
  if (!mesh.normals.empty() && !is_finite(mesh.normals[v])) {
    const Vec3 n = mesh.normals[v];
    throw Error({name, fmt::format("vertex {}", v), "a finite normal",
                 fmt::format("({}, {}, {})", n.x, n.y, n.z)});
  }
  if (mesh.texcoords.empty()) return;
  const Vec2 uv = mesh.texcoords[v];
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
    throw Error({name, fmt::format("vertex {}", v), "finite texture coordinates",
                 fmt::format("({}, {})", uv.x, uv.y)});
}

std::vector<char> find_used(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = 1;
  return used;
}

// Keeps the vertices that are used.
void compact(TriangleMesh& mesh) {
  const std::vector<char> used = find_used(mesh);
  std::vector<std::uint32_t> place(used.size());
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) continue;
    place[v] = count;
    mesh.positions[count] = mesh.positions[v];
    if (!mesh.normals.empty()) mesh.normals[count] = mesh.normals[v];
    if (!mesh.texcoords.empty()) mesh.texcoords[count] = mesh.texcoords[v];
    mesh.source[count] = mesh.source[v];
    ++count;
  }
  mesh.positions.resize(count);
  mesh.source.resize(count);
  if (!mesh.normals.empty()) mesh.normals.resize(count);
  if (!mesh.texcoords.empty()) mesh.texcoords.resize(count);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = place[v];
}

void merge_vertices(TriangleMesh& mesh, MeshReport& report) {
  const std::size_t words =
      3 + (mesh.normals.empty() ? 0u : 3u) + (mesh.texcoords.empty() ? 0u : 2u);
  std::vector<std::uint32_t> keys;
  keys.reserve(words * mesh.positions.size());
  const auto add = [&](float value) {
    keys.push_back(std::bit_cast<std::uint32_t>(value + 0.0f));  // -0 + 0 = +0
  };
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (const float value : {mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z})
      add(value);
    if (!mesh.normals.empty())
      for (const float value : {mesh.normals[v].x, mesh.normals[v].y, mesh.normals[v].z})
        add(value);
    if (!mesh.texcoords.empty())
      for (const float value : {mesh.texcoords[v].x, mesh.texcoords[v].y}) add(value);
  }
  const std::vector<std::uint32_t> first =
      find_first_equals(keys.data(), mesh.positions.size(), words);
  for (std::size_t v = 0; v < first.size(); ++v)
    if (first[v] != v) ++report.merged_vertices;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = first[v];
}

bool is_degenerate(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  const Vec3d e1 = to_double(mesh.positions[t[1]]) - a;
  const Vec3d e2 = to_double(mesh.positions[t[2]]) - a;
  const double longest = std::max({dot(e1, e1), dot(e2, e2), dot(e2 - e1, e2 - e1)});
  return length(cross(e1, e2)) <= least_relative_area * longest;
}

void drop_degenerate(TriangleMesh& mesh, MeshReport& report, const std::string& name) {
  const std::size_t before = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return is_degenerate(mesh, t); });
  report.degenerate_triangles = before - mesh.triangles.size();
  if (mesh.triangles.empty())
    throw Error({name, "", "a mesh with faces",
                 fmt::format("{} triangles, none of which has an area", before)});
}

// The file's normals, to the outside of their faces: reversed where a component's disagree for the
// most part, and replaced where single ones still do.
void turn_normals(TriangleMesh& mesh, const Orientation& orientation) {
  std::vector<double> agreement(orientation.component_count, 0.0);
  std::vector<std::uint32_t> component(mesh.positions.size());
  std::vector<Vec3d> sums(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3d normal = double_area_normal(mesh, mesh.triangles[t]);
    for (const std::uint32_t v : mesh.triangles[t]) {
      agreement[orientation.component[t]] += dot(normal, to_double(normalize(mesh.normals[v])));
      component[v] = orientation.component[t];
      sums[v] = sums[v] + normal;
    }
  }
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    const Vec3 outward = to_unit(sums[v]);
    Vec3 normal = normalize(mesh.normals[v]);
    if (agreement[component[v]] < 0) normal = -normal;
    if (normal == Vec3{} || dot(normal, outward) < 0) normal = outward;
    mesh.normals[v] = normal;
  }
  // Without a normal from the file or from faces that cancel, any one is as good.
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (mesh.normals[v] == Vec3{}) mesh.normals[v] = to_unit(double_area_normal(mesh, t));
}

}  // namespace

MeshReport clean_mesh(TriangleMesh& mesh, const std::string& name) {
  check_sizes(mesh, name);
  MeshReport report;
  const std::vector<char> used = find_used(mesh);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) {
      check_vertex(mesh, v, name);
    } else {
      ++report.unused_vertices;
    }
  }
  if (mesh.source.empty()) {  // a mesh that is cleaned again keeps its first vertices
    mesh.source_vertices = mesh.positions.size();
    mesh.source.resize(mesh.source_vertices);
    std::iota(mesh.source.begin(), mesh.source.end(), 0u);
  }
  compact(mesh);
  merge_vertices(mesh, report);
  drop_degenerate(mesh, report, name);
  report.cancelled_triangles = cancel_flaps(mesh, weld_positions(mesh.positions));
  compact(mesh);
  const Orientation orientation = find_orientation(mesh, weld_positions(mesh.positions));
  report.boundary_edges = orientation.boundary_edges;
  report.nonmanifold_edges = orientation.nonmanifold_edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (orientation.flip[t] == 0) continue;
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    ++report.flipped_triangles;
  }
  if (mesh.normals.empty()) {
    compute_normals(mesh);
  } else {
    turn_normals(mesh, orientation);
  }
  return report;
}

}  // namespace parian

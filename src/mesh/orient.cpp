#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/orient_internal.h"
#include "mesh/topology_internal.h"

namespace parian {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};

// Sums over the faces of a component, as wound after they agree.
struct Component {
  std::uint32_t first = 0;  // one of its triangles
  std::size_t count = 0;
  double area = 0;
  double reversed_area = 0;  // of faces wound against the first
  Vec3d normal_sum;          // vector area: zero if closed
  double volume = 0;
  Bounds3 box;
  bool closed = false;
  bool turn = false;
};

// neighbours[corner] = the corner of the other face on a manifold edge, or none.
std::vector<std::uint32_t> pair_corners(const TriangleMesh& mesh,
                                        std::span<const std::uint32_t> weld, Orientation& result) {
  std::vector<std::uint32_t> neighbours(3 * mesh.triangles.size(), none);
  for_each_edge(mesh.triangles, weld, [&](const std::uint32_t* corners, std::size_t count) {
    if (count == 1) ++result.boundary_edges;
    if (count > 2) ++result.nonmanifold_edges;
    if (count != 2) return;
    neighbours[corners[0]] = corners[1];
    neighbours[corners[1]] = corners[0];
  });
  return neighbours;
}

void add_face(Component& component, const TriangleMesh& mesh, std::uint32_t t, bool reversed,
              Vec3d origin) {
  const Triangle& v = mesh.triangles[t];
  const Vec3d normal = double_area_normal(mesh, v) * (reversed ? -0.5 : 0.5);
  const double area = length(normal);
  ++component.count;
  component.area += area;
  if (reversed) component.reversed_area += area;
  component.normal_sum = component.normal_sum + normal;
  component.volume += dot(to_double(mesh.positions[v[0]]) - origin, normal) / 3;
  for (const std::uint32_t i : v) extend(component.box, mesh.positions[i]);
}

// Flood over manifold edges from `first`; flip is relative to it.
Component flood(const TriangleMesh& mesh, std::span<const std::uint32_t> weld,
                const std::vector<std::uint32_t>& neighbours, std::uint32_t first, std::uint32_t id,
                Orientation& result) {
  Component component;
  component.first = first;
  // Volumes from a point near the component: exact enough also where it is open.
  const Vec3d origin = to_double(mesh.positions[mesh.triangles[first][0]]);
  const auto start_of = [&](std::uint32_t corner) {
    return weld[mesh.triangles[corner / 3][corner % 3]];
  };
  std::vector<std::uint32_t> stack{first};
  result.component[first] = id;
  while (!stack.empty()) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    add_face(component, mesh, t, result.flip[t] != 0, origin);
    for (std::uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      const std::uint32_t other = neighbours[corner];
      if (other == none || result.component[other / 3] != none) continue;
      // Faces that agree run along their edge in opposite directions.
      const bool agree = start_of(corner) != start_of(other);
      result.flip[other / 3] = agree ? result.flip[t] : !result.flip[t];
      result.component[other / 3] = id;
      stack.push_back(other / 3);
    }
  }
  return component;
}

// How often the component's surface winds around a point: 0 outside, 1 or -1 inside (van Oosterom
// and Strackee 1983 for the solid angle of a triangle).
double winding_number(const TriangleMesh& mesh, const Orientation& orientation, std::uint32_t id,
                      Vec3d point) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (orientation.component[t] != id) continue;
    const Triangle& v = mesh.triangles[t];
    const Vec3d a = to_double(mesh.positions[v[0]]) - point;
    const Vec3d b = to_double(mesh.positions[v[1]]) - point;
    const Vec3d c = to_double(mesh.positions[v[2]]) - point;
    const double la = length(a), lb = length(b), lc = length(c);
    const double angle = 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc +
                                                                 dot(b, c) * la + dot(c, a) * lb);
    sum += orientation.flip[t] != 0 ? -angle : angle;
  }
  return sum / (4 * std::numbers::pi);
}

bool contains(const Bounds3& outer, const Bounds3& inner) {
  return min(outer.lower, inner.lower) == outer.lower &&
         max(outer.upper, inner.upper) == outer.upper;
}

// Is component `id` inside a larger closed one? `budget` triangles may be looked at in all.
bool is_enclosed(const TriangleMesh& mesh, const Orientation& orientation,
                 const std::vector<Component>& components, std::uint32_t id, std::size_t& budget) {
  const Component& inner = components[id];
  const Vec3d point = to_double(mesh.positions[mesh.triangles[inner.first][0]]);
  for (std::uint32_t other = 0; other < components.size(); ++other) {
    const Component& outer = components[other];
    if (other == id || !outer.closed || std::abs(outer.volume) <= std::abs(inner.volume) ||
        !contains(outer.box, inner.box))
      continue;
    if (mesh.triangles.size() > budget) return false;
    budget -= mesh.triangles.size();
    if (std::abs(winding_number(mesh, orientation, other, point)) > 0.5) return true;
  }
  return false;
}

// The original winding is that of most of the area.
void restore_winding(std::vector<Component>& components, Orientation& result) {
  for (Component& c : components) {
    c.turn = c.reversed_area > 0.5 * c.area;
    if (c.turn) c.volume = -c.volume;
    const double side = std::sqrt(c.area);
    c.closed = length(c.normal_sum) < 0.1 * c.area && std::abs(c.volume) > 1e-7 * c.area * side;
  }
  for (std::size_t t = 0; t < result.flip.size(); ++t)
    if (components[result.component[t]].turn) result.flip[t] = !result.flip[t];
}

void turn_components(const TriangleMesh& mesh, std::vector<Component>& components,
                     Orientation& result) {
  double largest = 0;  // signed volume
  for (const Component& c : components)
    if (c.closed && std::abs(c.volume) > std::abs(largest)) largest = c.volume;
  std::size_t budget = std::size_t{1} << 28u;
  double closed_area = 0;
  double turned_area = 0;
  for (std::uint32_t id = 0; id < components.size(); ++id) {
    Component& c = components[id];
    c.turn = c.closed && c.volume < 0;
    if (!c.closed) continue;
    if (c.volume * largest < 0 && is_enclosed(mesh, result, components, id, budget))
      c.turn = !c.turn;
    closed_area += c.area;
    if (c.turn) turned_area += c.area;
  }
  for (Component& c : components)
    if (!c.closed) c.turn = turned_area > 0.5 * closed_area;
  for (std::size_t t = 0; t < result.flip.size(); ++t)
    if (components[result.component[t]].turn) result.flip[t] = !result.flip[t];
}

}  // namespace

Orientation find_orientation(const TriangleMesh& mesh, std::span<const std::uint32_t> weld) {
  Orientation result;
  result.flip.assign(mesh.triangles.size(), 0);
  result.component.assign(mesh.triangles.size(), none);
  const std::vector<std::uint32_t> neighbours = pair_corners(mesh, weld, result);
  std::vector<Component> components;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (result.component[t] == none)
      components.push_back(
          flood(mesh, weld, neighbours, t, static_cast<std::uint32_t>(components.size()), result));
  result.component_count = static_cast<std::uint32_t>(components.size());
  restore_winding(components, result);
  turn_components(mesh, components, result);
  return result;
}

}  // namespace parian

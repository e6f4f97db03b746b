#include "transport/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t none = 0xffffffffu;
// Steeper entries are followed no further within a texel: they transmit little.
constexpr float max_slope = 8;
// Texel centres this close to an edge belong to both of its triangles: no gaps.
constexpr float edge_tolerance = 1e-3f;

std::size_t texels_of(const DepthLayers& layers) {
  return static_cast<std::size_t>(layers.width) * static_cast<std::size_t>(layers.height);
}

// A triangle in the map's space: places in texels, depth as a plane, weights of its corners.
struct Projected {
  Vec3 corner[3];
  float area = 0;  // twice, signed: > 0 where it faces the light
};

Projected project(const TriangleMesh& mesh, const std::vector<Vec3>& places, std::size_t triangle) {
  Projected projected;
  for (std::size_t i = 0; i < 3; ++i) projected.corner[i] = places[mesh.triangles[triangle][i]];
  const Vec3 a = projected.corner[1] - projected.corner[0],
             b = projected.corner[2] - projected.corner[0];
  projected.area = a.x * b.y - a.y * b.x;
  return projected;
}

Vec2 slope_of(const Projected& t) {
  const Vec3 a = t.corner[1] - t.corner[0], b = t.corner[2] - t.corner[0];
  return {(a.z * b.y - b.z * a.y) / t.area, (b.z * a.x - a.z * b.x) / t.area};
}

// Texel columns or rows whose centres lie in [low, high].
struct Span {
  int first = 0, last = 0;
};
Span find_span(float a, float b, float c, int size) {
  const float low = std::min({a, b, c}) - edge_tolerance,
              high = std::max({a, b, c}) + edge_tolerance;
  return {std::max(0, static_cast<int>(std::ceil(low - 0.5f))),
          std::min(size - 1, static_cast<int>(std::floor(high - 0.5f)))};
}

// >= 0 to the left of the line from p to q, and edge_tolerance to its right; x and y are texels
// from `origin`.
struct Edge {
  float x = 0, y = 0, start = 0;
};
Edge make_edge(Vec3 p, Vec3 q, Vec2 origin) {
  const float dx = q.x - p.x, dy = q.y - p.y;
  return {-dy, dx,
          dx * (origin.y - p.y) - dy * (origin.x - p.x) +
              edge_tolerance * (std::abs(dx) + std::abs(dy))};
}

// Calls body(texel, depth) at each texel whose centre the triangle covers.
template <typename Body>
void cover(const DepthLayers& layers, const Projected& t, const Body& body) {
  const Vec3 a = t.corner[0], b = t.corner[t.area < 0 ? 2 : 1], c = t.corner[t.area < 0 ? 1 : 2];
  const Span columns = find_span(a.x, b.x, c.x, layers.width),
             rows = find_span(a.y, b.y, c.y, layers.height);
  if (columns.first > columns.last || rows.first > rows.last) return;
  const Vec2 slope = slope_of(t), origin{static_cast<float>(columns.first) + 0.5f,
                                         static_cast<float>(rows.first) + 0.5f};
  const Edge ab = make_edge(a, b, origin), bc = make_edge(b, c, origin),
             ca = make_edge(c, a, origin);
  const float start = a.z + slope.x * (origin.x - a.x) + slope.y * (origin.y - a.y);
  const float nearest = std::min({a.z, b.z, c.z}), farthest = std::max({a.z, b.z, c.z});
  const int width = columns.last - columns.first, height = rows.last - rows.first;
  std::size_t row = static_cast<std::size_t>(rows.first) * static_cast<std::size_t>(layers.width) +
                    static_cast<std::size_t>(columns.first);
  for (int j = 0; j <= height; ++j, row += static_cast<std::size_t>(layers.width)) {
    const auto y = static_cast<float>(j);
    const float first = ab.start + ab.y * y, second = bc.start + bc.y * y,
                third = ca.start + ca.y * y, depth = start + slope.y * y;
    for (int i = 0; i <= width; ++i) {
      const auto x = static_cast<float>(i);
      const float inside =
          std::min(std::min(first + ab.x * x, second + bc.x * x), third + ca.x * x);
      if (inside < 0) continue;
      body(row + static_cast<std::size_t>(i), std::clamp(depth + slope.x * x, nearest, farthest));
    }
  }
}

DepthLayers make_empty(const TriangleMesh& mesh, Vec3 direction, int resolution) {
  const Frame frame = make_frame(direction);
  Bounds3 box;
  for (const Vec3& position : mesh.positions) extend(box, to_local(frame, position));
  const Vec3 size = extent(box);
  DepthLayers layers;
  // One texel more on each side, so that paths along the outline stay in the map.
  layers.texel_mm = std::max({size.x, size.y, 1e-20f}) / static_cast<float>(resolution - 2);
  const float scale = 1 / layers.texel_mm;
  layers.width = std::min(resolution, static_cast<int>(std::ceil(size.x * scale)) + 2);
  layers.height = std::min(resolution, static_cast<int>(std::ceil(size.y * scale)) + 2);
  layers.axis_x = frame.tangent * scale;
  layers.axis_y = frame.bitangent * scale;
  layers.axis_z = -direction;
  layers.offset = {1 - box.lower.x * scale, 1 - box.lower.y * scale, box.upper.z};
  return layers;
}

// Interpolated over the triangle at a texel's centre.
Vec3 normal_at(const TriangleMesh& mesh, const Projected& t, std::uint32_t triangle, float x,
               float y) {
  const auto weight = [&](std::size_t i, std::size_t j) {
    const Vec3 p = t.corner[i], q = t.corner[j];
    return ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) / t.area;
  };
  const float u = std::clamp(weight(2, 0), 0.0f, 1.0f), v = std::clamp(weight(0, 1), 0.0f, 1.0f);
  const auto& corners = mesh.triangles[triangle];
  return normalize(mesh.normals[corners[0]] * std::max(0.0f, 1 - u - v) +
                   mesh.normals[corners[1]] * u + mesh.normals[corners[2]] * v);
}

// Nearest to the light; of those that look away from it the depth alone.
struct FirstSurface {
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;
};
FirstSurface find_first_surface(const TriangleMesh& mesh, const std::vector<Vec3>& places,
                                const DepthLayers& layers) {
  FirstSurface first{std::vector<float>(texels_of(layers), infinity),
                     std::vector<std::uint32_t>(texels_of(layers), none)};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Projected t = project(mesh, places, i);
    if (t.area == 0) continue;
    const std::uint32_t name = t.area > 0 ? static_cast<std::uint32_t>(i) : none;
    cover(layers, t, [&](std::size_t texel, float depth) {
      if (!(depth < first.depth[texel])) return;
      first.depth[texel] = depth;
      first.triangle[texel] = name;
    });
  }
  return first;
}

// The nearest back face behind the first surface.
std::vector<float> find_exits(const TriangleMesh& mesh, const std::vector<Vec3>& places,
                              const DepthLayers& layers, const FirstSurface& first) {
  std::vector<float> exits(texels_of(layers), infinity);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Projected t = project(mesh, places, i);
    if (!(t.area < 0)) continue;
    cover(layers, t, [&](std::size_t texel, float depth) {
      if (depth > first.depth[texel] && depth < exits[texel]) exits[texel] = depth;
    });
  }
  return exits;
}

struct Texel {
  int column = 0, row = 0;
};
std::size_t index_of(const DepthLayers& layers, Texel texel) {
  return static_cast<std::size_t>(texel.row) * static_cast<std::size_t>(layers.width) +
         static_cast<std::size_t>(texel.column);
}

// Whose surface a texel shows: its own, or where its centre lies outside the outline that of a
// neighbour, for some of the object may lie within the texel.
Texel find_shown(const DepthLayers& layers, const FirstSurface& first, Texel texel) {
  if (first.depth[index_of(layers, texel)] < infinity) return texel;
  for (const Texel step : {Texel{-1, 0}, Texel{1, 0}, Texel{0, -1}, Texel{0, 1}}) {
    const Texel other{texel.column + step.column, texel.row + step.row};
    if (other.column >= 0 && other.row >= 0 && other.column < layers.width &&
        other.row < layers.height && first.triangle[index_of(layers, other)] != none)
      return other;
  }
  return texel;
}

// All of an entry but its depths.
DepthTexel shade(const TriangleMesh& mesh, const Projected& t, std::uint32_t triangle, Texel texel,
                 Vec3 direction, float eta, float steepest) {
  const Vec3 normal = normal_at(mesh, t, triangle, static_cast<float>(texel.column) + 0.5f,
                                static_cast<float>(texel.row) + 0.5f);
  const Refraction light = refract_entry(normal, direction, eta);
  const Vec3 flux = light.direction * light.transmission;
  const Vec2 slope = slope_of(t);
  return {.slope_x = std::clamp(slope.x, -steepest, steepest),
          .slope_y = std::clamp(slope.y, -steepest, steepest),
          .length_ratio = light.length_ratio,
          .flux = {flux.x, flux.y, flux.z}};
}

}  // namespace

Refraction refract_entry(Vec3 normal, Vec3 to_light, float eta) {
  const float cosine = std::min(dot(normal, to_light), 1.0f);
  if (!(cosine > 0)) return {};
  const float inside = std::sqrt(std::max(0.0f, 1 - (1 - cosine * cosine) / (eta * eta)));
  if (!(inside > 0)) return {};
  return {fresnel_transmission(eta, cosine), cosine / inside,
          to_light / eta + normal * (inside - cosine / eta)};
}

DepthLayers make_depth_layers(const TriangleMesh& mesh, Vec3 direction, int resolution, float eta) {
  PARIAN_CHECK_LE(8, resolution);
  DepthLayers layers = make_empty(mesh, direction, resolution);
  std::vector<Vec3> places;
  places.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions)
    places.push_back(Vec3{dot(layers.axis_x, p), dot(layers.axis_y, p), dot(layers.axis_z, p)} +
                     layers.offset);
  const FirstSurface first = find_first_surface(mesh, places, layers);
  const std::vector<float> exits = find_exits(mesh, places, layers, first);
  layers.texels.reserve(exits.size());
  for (Texel texel; texel.row < layers.height; ++texel.row)
    for (texel.column = 0; texel.column < layers.width; ++texel.column) {
      const Texel shown = find_shown(layers, first, texel);
      const std::size_t i = index_of(layers, shown);
      if (first.triangle[i] == none) {
        layers.texels.push_back({.exit = -infinity});
        continue;
      }
      DepthTexel entry = shade(mesh, project(mesh, places, first.triangle[i]), first.triangle[i],
                               shown, direction, eta, max_slope * layers.texel_mm);
      entry.entry = first.depth[i] +
                    entry.slope_x * static_cast<float>(texel.column - shown.column) +
                    entry.slope_y * static_cast<float>(texel.row - shown.row);
      entry.exit = exits[i];
      layers.texels.push_back(entry);
    }
  return layers;
}

}  // namespace parian

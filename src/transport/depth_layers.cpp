#include "transport/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
// Steeper entries are followed no further within a texel: they transmit little.
constexpr float max_slope = 8;
// Texel centres this close to an edge belong to both of its triangles: no gaps.
constexpr float edge_tolerance = 1e-3f;

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

// Calls body(texel, depth) at each texel whose centre the triangle covers.
template <typename Body>
void cover(const DepthLayers& layers, const Projected& t, const Body& body) {
  const Vec3 *a = &t.corner[0], *b = &t.corner[1], *c = &t.corner[2];
  if (t.area < 0) std::swap(b, c);
  const Span columns = find_span(a->x, b->x, c->x, layers.width),
             rows = find_span(a->y, b->y, c->y, layers.height);
  if (columns.first > columns.last || rows.first > rows.last) return;
  const Vec2 slope = slope_of(t);
  const auto edge = [](const Vec3& p, const Vec3& q, float x, float y) {
    const float dx = q.x - p.x, dy = q.y - p.y;
    return dx * (y - p.y) - dy * (x - p.x) + edge_tolerance * (std::abs(dx) + std::abs(dy));
  };
  const float nearest = std::min({a->z, b->z, c->z}), farthest = std::max({a->z, b->z, c->z});
  for (int row = rows.first; row <= rows.last; ++row) {
    const float y = static_cast<float>(row) + 0.5f;
    for (int column = columns.first; column <= columns.last; ++column) {
      const float x = static_cast<float>(column) + 0.5f;
      if (edge(*a, *b, x, y) < 0 || edge(*b, *c, x, y) < 0 || edge(*c, *a, x, y) < 0) continue;
      const float depth = a->z + slope.x * (x - a->x) + slope.y * (y - a->y);
      body(static_cast<std::size_t>(row) * static_cast<std::size_t>(layers.width) +
               static_cast<std::size_t>(column),
           std::clamp(depth, nearest, farthest));
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
  const auto texels =
      static_cast<std::size_t>(layers.width) * static_cast<std::size_t>(layers.height);
  layers.texels.assign(texels, {});
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

void shade_texel(const TriangleMesh& mesh, const std::vector<Vec3>& places, std::uint32_t triangle,
                 Vec3 direction, float eta, float x, float y, DepthTexel& texel) {
  const Projected t = project(mesh, places, triangle);
  const Vec2 slope = slope_of(t);
  const Refraction refraction = refract_entry(normal_at(mesh, t, triangle, x, y), direction, eta);
  texel.slope_x = slope.x;
  texel.slope_y = slope.y;
  texel.length_ratio = refraction.length_ratio;
  const Vec3 flux = refraction.direction * refraction.transmission;
  texel.flux[0] = flux.x;
  texel.flux[1] = flux.y;
  texel.flux[2] = flux.z;
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
  constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> nearest(layers.texels.size(), none);
  for (DepthTexel& texel : layers.texels) texel.entry = texel.exit = infinity;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Projected t = project(mesh, places, i);
    if (t.area == 0) continue;
    cover(layers, t, [&](std::size_t texel, float depth) {
      if (!(depth < layers.texels[texel].entry)) return;
      layers.texels[texel].entry = depth;
      nearest[texel] = t.area > 0 ? static_cast<std::uint32_t>(i) : none;
    });
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Projected t = project(mesh, places, i);
    if (!(t.area < 0)) continue;
    cover(layers, t, [&](std::size_t texel, float depth) {
      DepthTexel& at = layers.texels[texel];
      if (depth > at.entry && depth < at.exit) at.exit = depth;
    });
  }
  std::size_t i = 0;
  for (int row = 0; row < layers.height; ++row)
    for (int column = 0; column < layers.width; ++column, ++i) {
      DepthTexel& texel = layers.texels[i];
      if (nearest[i] == none) {
        texel = {.entry = 0, .exit = -infinity};
        continue;
      }
      shade_texel(mesh, places, nearest[i], direction, eta, static_cast<float>(column) + 0.5f,
                  static_cast<float>(row) + 0.5f, texel);
      const float limit = max_slope * layers.texel_mm;
      texel.slope_x = std::clamp(texel.slope_x, -limit, limit);
      texel.slope_y = std::clamp(texel.slope_y, -limit, limit);
    }
  return layers;
}

}  // namespace parian

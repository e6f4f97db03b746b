#include "scene/mask_brush.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace parian {
namespace {

constexpr float least_facing = -0.3f;    // cosine: as samples of a surface have it
constexpr double reach_of_corner = 1.5;  // times the distance of the nearest vertex

// 1 at the middle, 0 at the brush's edge.
float fall_off(double at, double reach, double softness) {
  const double inner = (1 - softness) * reach;
  if (at <= inner) return 1;
  if (at >= reach) return 0;
  const double t = (reach - at) / (reach - inner);
  return static_cast<float>(t * t * (3 - 2 * t));
}

float in_thousandths(double weight) {
  return static_cast<float>(std::round(1000 * weight) / 1000);
}

std::size_t source_of(const TriangleMesh& mesh, std::size_t vertex) {
  return mesh.source.empty() ? vertex : mesh.source[vertex];
}

}  // namespace

ParamList describe(MaskBrush& brush) {
  return {{.name = "radius-mm",
           .help = "of the brush on the mesh ([ and ])",
           .target = &brush.radius_mm,
           .min = 0.001,
           .max = 1e6,
           .unit = "mm"},
          {.name = "softness",
           .help = "part of the radius over which the brush falls to nothing",
           .target = &brush.softness,
           .min = 0,
           .max = 1},
          {.name = "strength",
           .help = "how much one stroke adds or takes away",
           .target = &brush.strength,
           .min = 0,
           .max = 1},
          {.name = "erases",
           .help = "takes away instead; so does Ctrl while drawing",
           .target = &brush.erases}};
}

VertexMask sample_at_vertices(const SurfaceMask& mask, const TriangleMesh& mesh) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  constexpr Vec2 corners[] = {{0, 0}, {1, 0}, {0, 1}};
  std::vector<std::uint32_t> corner_of(mesh.positions.size(), none);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) corner_of[mesh.triangles[t][k]] = 3 * t + k;
  VertexMask sampled;
  sampled.weights.resize(count_source_vertices(mesh));
  parallel_for(mesh.positions.size(), [&](std::size_t v) {
    if (corner_of[v] == none) return;
    const SurfacePoint point = get_surface_point(mesh, corner_of[v] / 3, corners[corner_of[v] % 3]);
    sampled.weights[source_of(mesh, v)] = in_thousandths(eval_mask(mask, mesh, point));
  });
  return sampled;
}

MaskStroke start_stroke(const MaskBrush& brush, const VertexMask& mask, const TriangleMesh& mesh) {
  MaskStroke stroke{.brush = brush, .before = mask.weights};
  stroke.cover.resize(mesh.positions.size());
  stroke.seen_in.resize(mesh.positions.size());
  return stroke;
}

void touch(MaskStroke& stroke, const TriangleMesh& mesh, const VertexGraph& graph,
           const SurfacePoint& point) {
  const auto reached = [&](std::uint32_t place) {
    if (stroke.seen_in[place] == stroke.walks) return;
    stroke.seen_in[place] = stroke.walks;
    stroke.reached.push_back(place);
  };
  ++stroke.walks;
  stroke.reached.clear();
  float nearest = std::numeric_limits<float>::infinity();
  for (const std::uint32_t corner : mesh.triangles[point.triangle]) {
    reached(graph.place[corner]);
    nearest = std::min(nearest, distance(mesh.positions[corner], point.position));
  }
  const double reach =
      std::max(stroke.brush.radius_mm, reach_of_corner * static_cast<double>(nearest));
  for (std::size_t i = 0; i < stroke.reached.size(); ++i) {
    const std::uint32_t place = stroke.reached[i];
    const auto at = static_cast<double>(distance(mesh.positions[place], point.position));
    const bool is_corner = i < 3;  // of the triangle that is touched
    if (!is_corner &&
        (at > reach || dot(graph.normals[place], point.geometric_normal) < least_facing))
      continue;
    stroke.cover[place] = std::max(stroke.cover[place], fall_off(at, reach, stroke.brush.softness));
    for (std::uint32_t k = graph.begin[place]; k < graph.begin[place + 1]; ++k)
      reached(graph.others[k]);
  }
}

VertexMask paint(const MaskStroke& stroke, const TriangleMesh& mesh, const VertexGraph& graph) {
  VertexMask painted{stroke.before};
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double part = stroke.brush.strength * static_cast<double>(stroke.cover[graph.place[v]]);
    if (part == 0) continue;
    float& weight = painted.weights[source_of(mesh, v)];
    const auto before = static_cast<double>(stroke.before[source_of(mesh, v)]);
    weight =
        in_thousandths(stroke.brush.erases ? before * (1 - part) : before + (1 - before) * part);
  }
  return painted;
}

}  // namespace parian

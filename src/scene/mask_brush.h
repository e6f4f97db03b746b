// Painting of masks (VertexMask) with a brush that touches a surface: what is painted stays at its
// vertices, however samples and texture coordinates repeat.
#pragma once

#include <cstdint>
#include <vector>

#include "base/params.h"
#include "mesh/vertex_graph.h"
#include "scene/surface_mask.h"

namespace parian {

struct MaskBrush {
  double radius_mm = 2;
  double softness = 0.5;  // part of the radius over which it falls, 3 t^2 - 2 t^3
  double strength = 1;    // opacity of one stroke
  bool erases = false;
};
ParamList describe(MaskBrush& brush);

// The mask's values at the mesh's vertices; 0 at those of the file that no face has. The mesh has
// normals, and the mask has been checked.
VertexMask sample_at_vertices(const SurfaceMask& mask, const TriangleMesh& mesh);

// One stroke: where its touches overlap the strongest counts, so that a slow one is like a quick
// one. Keeps no reference to the mesh.
struct MaskStroke {
  MaskBrush brush;
  std::vector<float> before;  // weights when it began, as VertexMask has them
  std::vector<float> cover;   // by place of the graph: how far it has been touched, in [0, 1]
  // Of the last walk; kept for the next one.
  std::vector<std::uint32_t> reached, seen_in;
  std::uint32_t walks = 0;
};
MaskStroke start_stroke(const MaskBrush& brush, const VertexMask& mask, const TriangleMesh& mesh);

// Touches the surface at a point: what lies within the brush's radius (a straight distance) and is
// joined to the point by edges within it. Faces turned away by more than 107 degrees, as the other
// side of a thin sheet, are not touched. Between vertices that are far apart the brush is as large
// as it must be to reach the nearest one.
void touch(MaskStroke& stroke, const TriangleMesh& mesh, const VertexGraph& graph,
           const SurfacePoint& point);

// w + (1 - w) strength cover, or w (1 - strength cover) where the brush erases; in thousandths, so
// that files stay small.
VertexMask paint(const MaskStroke& stroke, const TriangleMesh& mesh, const VertexGraph& graph);

}  // namespace parian

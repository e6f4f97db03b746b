// What an object hides from itself of an environment: its heights along 256 directions, as shadow
// maps of lights that far away, found once per mesh. A ray asks one map, of one of the four
// directions around its own, drawn so that the mean over rays is linear between them
// (shaders/self_occlusion.glsl). Views, materials, lights and turns of an environment need none
// anew.
#pragma once

#include <cstdint>
#include <vector>

#include "gl/objects.h"
#include "mesh/mesh.h"

namespace parian {

inline constexpr int occlusion_side = 16;   // directions: cells of the octahedral square
inline constexpr int occlusion_size = 256;  // texels of a map's side

// Unit vector of cell (x, y) of the square.
Vec3 occlusion_direction(int x, int y);

struct HeightMaps {
  Vec3 middle;
  float radius_mm = 1;  // of a sphere around the mesh, and half a map's side
  // [direction y][direction x][y][x], x and y along the tangents of make_frame(direction): the most
  // of dot(p - middle, direction) over the mesh, [-radius, radius] in steps of 0 to 65,535; 0 where
  // there is nothing.
  std::vector<std::uint16_t> heights;

  float texel_mm() const { return 2 * radius_mm / static_cast<float>(occlusion_size); }
};
// Of points spread over the mesh, so that the time does not depend on its triangles. No texel is
// higher than the mesh is within it.
HeightMaps make_height_maps(const TriangleMesh& mesh);

struct SelfOcclusion {
  Vec3 middle;
  float radius_mm = 1;
  Texture heights;  // a layer for each direction; no texture: nothing is hidden
};
SelfOcclusion make_self_occlusion(const HeightMaps& maps);
void bind_self_occlusion(const Program& program, const SelfOcclusion& occlusion, int unit);

}  // namespace parian

// Lights on the graphics device: shadow maps of directional and point lights, pictures of
// environments, and what each adds to the samples' flux and to a picture by reflection.
#pragma once

#include <vector>

#include "gl/objects.h"
#include "gl/surface_view.h"
#include "scene/scene.h"

namespace parian {

// Directional light: one parallel view of the mesh. Point light outside the mesh's sphere: one view
// of that; inside: six, of a cube.
struct Lamp {
  std::vector<Mat4> views;
  std::vector<Vec2> texel;  // mm: size of a texel, and its growth per mm of distance
  Vec3 place;               // direction towards it, or position
  bool is_near = false;
  Rgb power;
  Texture depth;  // a layer for each view
};
// Draws the shadow maps, of size x size texels.
Lamp make_lamp(const DirectionalLight& light, const MeshBuffers& mesh, int size);
Lamp make_lamp(const PointLight& light, const MeshBuffers& mesh, int size);

// An environment's picture.
struct Sky {
  Texture picture;
  float turn = 0;
  Rgb scale{1, 1, 1};
};
Sky make_sky(const EnvironmentLight& light);

// What lamp.glsl (compiled for as many views) and sky.glsl need, from texture unit `unit` on.
void bind_lamp(const Program& program, const Lamp& lamp, int unit);
void bind_sky(const Program& program, const Sky& sky, int unit);

}  // namespace parian

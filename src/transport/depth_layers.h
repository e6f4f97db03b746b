// What a directional light sees of a mesh: the first entry and the first exit behind it, on a grid
// across the light's direction, with all that single scattering wants to know about the entry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/vec.h"
#include "mesh/mesh.h"

namespace parian {

// The part of the surface that the light meets at a texel's centre. Depths grow away from the
// light, in mm. No entry: exit = -infinity; no exit: +infinity. A texel just outside the outline
// shows what a neighbour does, its entry continued.
struct alignas(32) DepthTexel {
  float entry = 0;
  float slope_x = 0, slope_y = 0;  // of the entry: mm per texel
  float exit = 0;
  float length_ratio = 0;  // s_i' / s_i (Eq. 7)
  float flux[3] = {};      // F_t w_i'
};

struct DepthLayers {
  int width = 0, height = 0;
  float texel_mm = 0;
  Vec3 axis_x, axis_y, axis_z;  // place in texels, and depth: dot product with the axis plus
  Vec3 offset;                  // the offset's component
  std::vector<DepthTexel> texels;
};

// `direction` is unit, to the light. `resolution` texels cover the longer side of what is seen.
// A map that is no longer needed lends its memory.
DepthLayers make_depth_layers(const TriangleMesh& mesh, Vec3 direction, int resolution, float eta,
                              DepthLayers reused = {});

// F_t(w_i), w_i' and s_i' / s_i at a place with this unit normal; transmission is 0 where it looks
// away.
struct Refraction {
  float transmission = 0;
  float length_ratio = 0;
  Vec3 direction;
};
Refraction refract_entry(Vec3 normal, Vec3 to_light, float eta);

}  // namespace parian

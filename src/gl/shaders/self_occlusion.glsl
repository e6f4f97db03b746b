// Whether the object hides an environment from itself: gl/self_occlusion.h.
uniform usampler2DArray object_heights;  // [direction][y][x]; 0: nothing there
uniform vec3 object_middle;
uniform float object_radius;             // mm

const float occlusion_side = 16.0;

// A place off the surface as the maps have it, such that no convex object hides anything from it:
// with a texel's sides of 1 all that shares its texel is within sqrt 2.
vec3 occlusion_place(vec3 position, vec3 face) {
  float texel = 2.0 / float(textureSize(object_heights, 0).x);
  return (position - object_middle) / object_radius + 1.5 * texel * face;
}

// 1 where light comes in along `light`, else 0. `random` in [0, 1)^2 picks the map; one whose
// direction is below the surface's horizon hides nothing.
float sees_environment(vec3 place, vec3 face, vec3 light, vec2 random) {
  vec2 cell = floor((0.5 + 0.5 * encode_octahedral(light)) * occlusion_side - 0.5 + random);
  vec2 inside = clamp(cell, 0.0, occlusion_side - 1.0);
  if (inside.x != cell.x) inside.y = occlusion_side - 1.0 - inside.y;  // the square's edges are
  if (inside.y != cell.y) inside.x = occlusion_side - 1.0 - inside.x;  // folded in their middles
  vec3 n = decode_octahedral((2.0 * inside + 1.0) / occlusion_side - 1.0);
  if (dot(n, face) <= 0.0) return 1.0;
  // The tangents of make_frame (math/vec.h).
  float side = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (side + n.z), b = n.x * n.y * a;
  vec3 at = vec3(dot(place, vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x)),
                 dot(place, vec3(b, side + n.y * n.y * a, -n.y)), dot(place, n));
  ivec3 texel = ivec3(floor((0.5 + 0.5 * at.xy) * vec2(textureSize(object_heights, 0).xy)),
                      inside.y * occlusion_side + inside.x);
  float height = float(texelFetch(object_heights, texel, 0).r);
  return height > 65535.0 * (0.5 + 0.5 * at.z) ? 0.0 : 1.0;
}

// From points of a surface to places in the sample's plane: scene/mapping.h.
uniform int mapping_is_box;
uniform float mapping_uv_size;    // mm
uniform float mapping_scale;
uniform vec2 mapping_turn;        // cosine and sine of the rotation
uniform vec2 mapping_offset;      // mm
uniform vec2 mapping_grid;        // pixels of the sample
uniform float mapping_pitch;      // mm

float sign_of(float v) { return v < 0.0 ? -1.0 : 1.0; }

vec2 project_to_box(vec3 p, vec3 n) {
  vec3 a = abs(n);
  if (a.z >= a.x && a.z >= a.y) return vec2(sign_of(n.z) * p.x, -p.y);
  if (a.x >= a.y) return vec2(sign_of(n.x) * p.z, -p.y);
  return vec2(p.x, -sign_of(n.y) * p.z);
}

// Reflected at the borders -0.5 and size - 0.5, as often as needed.
float mirror_tile(float x, float size) {
  float t = mod(x + 0.5, 2.0 * size);
  return (t >= size ? 2.0 * size - t : t) - 0.5;
}

vec2 map_to_sample(vec3 position, vec3 normal, vec2 texcoord) {
  vec2 place = mapping_is_box != 0 ? project_to_box(position, normal) : texcoord * mapping_uv_size;
  vec2 d = (place - mapping_offset) / mapping_scale;
  vec2 turned = vec2(mapping_turn.x * d.x + mapping_turn.y * d.y,
                     mapping_turn.x * d.y - mapping_turn.y * d.x);
  vec2 pixel = turned / mapping_pitch - 0.5;
  return vec2(mirror_tile(pixel.x, mapping_grid.x), mirror_tile(pixel.y, mapping_grid.y));
}

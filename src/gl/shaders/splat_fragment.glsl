// What a source sends to a texel at this level, before the texel's own profile is known:
//
//   B = sum_i w(r) A(r) a_i(r) flux_i,   B1 = sum_i r w(r) A(r) a_i(r) flux_i
//
// a = exp(h), A the reference profile's, w the level's part of the partition of unity in ln r. B1 is
// summed over the channels.
uniform sampler2DArray level_positions;  // packed normals in w
uniform int layer;
// [i] in the middle of step i: log2 A^2 and w. In the first near_steps of level 0 w is 1 and the near
// term's weight stands there: A^2 w_near area over the integral.
uniform sampler2D level_table;
uniform vec2 table_place;  // factor and offset from r to i
uniform vec4 part_factor;  // from r to the part of the four segments between nodes
uniform vec4 part_offset;
uniform float reach;       // mm
flat in vec3 splat_position;
flat in vec3 splat_log;    // log2(a_i flux_i / A) at the first of the level's nodes
flat in vec3 splat_steps[4];  // from node to node
layout(location = 0) out vec4 out_sum;  // B; B1
#ifdef SINGLE
// Near term (transport/near_term.h): within near_mm the part of the target's own side is apart.
uniform vec2 near_factor;  // 1 / near_mm^2, 1 / mean_mm^2
uniform int near_steps;
uniform float area_mm2;
flat in vec3 splat_flux;
flat in vec3 splat_normal;
layout(location = 1) out vec4 out_near;  // of the near term; its weight
#ifdef MEAN
layout(location = 2) out vec4 out_mean;  // flux around; the area that it enters through
#endif
#endif

void main() {
  vec4 target = texelFetch(level_positions, ivec3(ivec2(gl_FragCoord.xy), layer), 0);
  vec3 d = target.xyz - splat_position;
  float r2 = dot(d, d), r = sqrt(r2);
  if (target.w <= 0.0 || r >= reach) discard;
  vec4 part = clamp(r * part_factor + part_offset, 0.0, 1.0);
  vec3 log_value = splat_log + part.x * splat_steps[0] + part.y * splat_steps[1] +
                   part.z * splat_steps[2] + part.w * splat_steps[3];
  int i = clamp(int(r * table_place.x + table_place.y), 0, STEPS - 1);
  vec4 entry = texelFetch(level_table, ivec2(i, 0), 0);
  vec3 value = exp2(entry.rgb + log_value);
#ifdef SINGLE
  vec2 near = max(1.0 - r2 * near_factor, 0.0);
  near *= near;
  bool is_near = i < near_steps;
  value *= is_near ? 1.0 : entry.a;
  if (dot(unpack_direction(target.w), splat_normal) <= 0.0) {
    is_near = false;
    near = vec2(0.0);
  }
  vec3 close = near.x * value;
  value -= close;
  out_near = vec4(close, is_near ? entry.a : 0.0);
#ifdef MEAN
  out_mean = near.y * vec4(splat_flux, area_mm2);
#endif
#else
  value *= entry.a;
#endif
  out_sum = vec4(value, r * (value.r + value.g + value.b));
}

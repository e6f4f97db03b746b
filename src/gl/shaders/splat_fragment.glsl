// What a source sends to a texel at this level, before the texel's own profile is known:
//
//   B = sum_i w(r) A(r) a_i(r) flux_i,   B1 = sum_i r w(r) A(r) a_i(r) flux_i
//
// a = exp(h), A the reference profile's, w the level's part of the partition of unity in ln r. B1 is
// summed over the channels.
uniform sampler2DArray level_positions;
uniform int layer;
uniform sampler2D level_table;  // [i]: 2 ln A and w in the middle of step i
uniform vec2 table_range;       // mm: first, step
uniform float node_r5[5];       // mm
uniform float reach;
flat in vec3 splat_position;
flat in vec3 splat_log[5];
layout(location = 0) out vec4 out_sum;  // B; B1
#ifdef SINGLE
// Near term (transport/near_term.h): within near_mm the part of the target's own side is apart.
uniform sampler2DArray level_normals;
uniform float near_mm;
uniform float mean_mm;
uniform float area_mm2;
uniform vec3 reference_share;  // 1/3 over the integral of A^2 w_near, per channel
flat in vec3 splat_flux;
flat in vec3 splat_normal;
layout(location = 1) out vec4 out_near;  // of the near term; its weight
#ifdef MEAN
layout(location = 2) out vec4 out_mean;  // flux around; the area that it enters through
#endif

float near_weight(float r, float radius) {
  float u = max(0.0, 1.0 - r * r / (radius * radius));
  return u * u;
}
#endif

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec4 target = texelFetch(level_positions, ivec3(texel, layer), 0);
  float r = distance(target.xyz, splat_position);
  if (target.w <= 0.0 || r >= reach || r <= table_range.x) discard;
  vec4 part = clamp((r - vec4(node_r5[0], node_r5[1], node_r5[2], node_r5[3])) /
                        (vec4(node_r5[1], node_r5[2], node_r5[3], node_r5[4]) -
                         vec4(node_r5[0], node_r5[1], node_r5[2], node_r5[3])),
                    0.0, 1.0);
  vec3 log_moment = splat_log[0] + part.x * (splat_log[1] - splat_log[0]) +
                    part.y * (splat_log[2] - splat_log[1]) +
                    part.z * (splat_log[3] - splat_log[2]) + part.w * (splat_log[4] - splat_log[3]);
  vec4 entry = texelFetch(level_table, ivec2(int((r - table_range.x) / table_range.y), 0), 0);
  vec3 value = entry.a * exp(entry.rgb + log_moment);
#ifdef SINGLE
  float w = near_weight(r, near_mm);
  bool is_near = w > 0.0 && dot(texelFetch(level_normals, ivec3(texel, layer), 0).xyz, splat_normal) > 0.0;
  if (!is_near) w = 0.0;
  vec3 close = w * value;
  value -= close;
  out_near = vec4(close, w * area_mm2 * dot(exp(entry.rgb), reference_share));
#ifdef MEAN
  float of_mean = is_near ? near_weight(r, mean_mm) : 0.0;
  out_mean = of_mean * vec4(splat_flux, area_mm2);
#endif
#endif
  out_sum = vec4(value, r * (value.r + value.g + value.b));
}

// What a source sends to a texel at this level, before the texel's own profile is known:
//
//   B = sum_i w(r) A(r) a_i(r) flux_i,   B1 = sum_i r w(r) A(r) a_i(r) flux_i
//
// a = exp(h), A the reference profile's, w the level's part of the partition of unity. B1 is summed
// over the channels. SINGLE: the near term (transport/near_term.h) on the target's own side is left
// out there and summed apart,
//
//   N = sum_i sqrt(I_i) flux_i k(r),   I_i = int P_i w_near dA,   k = mean of A^2 w_near / I_A
//
// over the channels, beside the sum of k times a sample's area and, MEAN, the flux around. DISCARD:
// where blending costs more than branches.
uniform sampler2DArray level_positions;  // packed normals in w
uniform int layer;
uniform vec4 weight_place;  // factor and offset from r to the part of w's rise, and of its fall
uniform float reach;        // mm
flat in vec4 splat_position;
flat in vec4 splat_fit_0;  // fit_fragment.glsl
flat in vec4 splat_fit_1;
flat in vec4 splat_fit_2;
layout(location = 0) out vec4 out_sum;  // B; B1
#ifdef SINGLE
flat in vec3 splat_normal;
uniform sampler2D kernel;    // [i] in the middle of step i: log2 A^2; k / w_near
uniform float kernel_steps;  // from r to i
uniform vec2 near_factor;    // 1 / near_mm^2, 1 / mean_mm^2
uniform float area_mm2;
layout(location = 1) out vec4 out_near;  // N; sum of k times the area
#ifdef MEAN
flat in vec3 splat_flux;
layout(location = 2) out vec4 out_mean;  // flux around; the area that it enters through
#endif
#else
uniform vec3 support;  // of the reference, mm
#endif

void main() {
  vec4 target = texelFetch(level_positions, ivec3(ivec2(gl_FragCoord.xy), layer), 0);
  vec3 d = target.xyz - splat_position.xyz;
  float r2 = dot(d, d), r = sqrt(r2);
#ifdef DISCARD
  if (r >= reach) discard;
#endif
  vec2 parts = r * weight_place.xz + weight_place.yw;
  float part = clamp(min(parts.x, parts.y), 0.0, 1.0);
  float weight = part * part * (3.0 - 2.0 * part);
  float q = min(r, reach);
  vec3 ends = vec3(splat_fit_0.w, splat_fit_1.w, splat_fit_2.w);
#ifdef SINGLE
  vec4 entry = texelFetch(kernel, ivec2(min(int(r * kernel_steps), STEPS - 1), 0), 0);
  vec3 log_value = entry.rgb + splat_fit_0.rgb + q * (splat_fit_1.rgb + q * splat_fit_2.rgb);
  vec2 near = max(1.0 - r2 * near_factor, 0.0);
  near *= near;
  bool is_own_side = dot(unpack_direction(target.w), splat_normal) > 0.0;
  if (!is_own_side) near = vec2(0.0);
  vec3 value = weight * (1.0 - near.x) * exp2(log_value);
  out_near = near.x * entry.a * vec4(ends, area_mm2);
#ifdef MEAN
  out_mean = near.y * vec4(splat_flux, area_mm2);
#endif
#else
  vec3 log_value = splat_fit_0.rgb + q * (splat_fit_1.rgb + q * (splat_fit_2.rgb + q * ends));
  vec3 value = weight * exp2(log_value);
  value *= vec3(lessThan(vec3(r), support));
#endif
  out_sum = vec4(value, r * (value.r + value.g + value.b));
}

// What a source sends to a texel at this level, before the texel's own profile is known:
//
//   B = sum_i w(r) A(r) a_i(r) flux_i,   B1 = sum_i r w(r) A(r) a_i(r) flux_i
//
// a = exp(h), A the reference profile's, w the level's part of the partition of unity. B1 is summed
// over the channels. SINGLE: the near term (transport/near_term.h) on the target's own side is left
// out there and summed apart,
//
//   N = sum_i sqrt(I_i) flux_i k(r),   I_i = int P_i w_near dA,   k near the mean of A^2 w_near / I_A
//
// over the channels, beside the sum of k times a sample's area and, MEAN, the flux around. BOUNDED:
// the reference ends within this level. DISCARD: where blending costs more than branches.
uniform sampler2D level_positions;  // facing.glsl in w
uniform vec4 weight_place;  // factor and offset from r to w's rise, and to its fall
uniform float reach;        // mm
flat in vec3 splat_position;
flat in vec4 splat_fit_0;  // fit_fragment.glsl
flat in vec4 splat_fit_1;
flat in vec4 splat_fit_2;
layout(location = 0) out vec4 out_sum;  // B; B1
#ifdef SINGLE
flat in vec3 splat_near;    // sqrt(I_i) flux_i
flat in vec3 splat_facing;  // normal on the camera's axes, x and y twice
uniform vec4 near_kernel;  // of k / w_near the eighth root: a cubic in r
uniform vec2 near_factor;  // 1 / near_mm^2, 1 / mean_mm^2
uniform float area_mm2;
layout(location = 1) out vec4 out_near;  // N; sum of k times the area
#ifdef MEAN
flat in vec3 splat_flux;
layout(location = 2) out vec4 out_mean;  // flux around; the area that it enters through
#endif
#endif
#ifdef BOUNDED
uniform vec3 support;  // of the reference, mm
#endif

void main() {
  vec4 target = texelFetch(level_positions, ivec2(gl_FragCoord.xy), 0);
  vec3 d = target.xyz - splat_position;
  float r2 = dot(d, d), r = min(sqrt(r2), reach);
#ifdef DISCARD
  if (r >= reach) discard;
#endif
  vec3 last = vec3(splat_fit_0.w, splat_fit_1.w, splat_fit_2.w);
  vec3 root = splat_fit_0.rgb + r * (splat_fit_1.rgb + r * (splat_fit_2.rgb + r * last));
#ifdef SINGLE
  float part = min(r * weight_place.z + weight_place.w, 1.0);
  float weight = part * part * (3.0 - 2.0 * part);
  vec2 near = max(1.0 - r2 * near_factor, 0.0);
  near *= near;
  vec2 p = unpack_facing(target.w);  // the normal is (2 p, 1 - p p) / (1 + p p)
  float side = splat_facing.z + dot(p, splat_facing.xy - splat_facing.z * p);
  if (side <= 0.0) near = vec2(0.0);
  weight *= 1.0 - near.x;
  float k = near_kernel.x + r * (near_kernel.y + r * (near_kernel.z + r * near_kernel.w));
  k *= k;
  k *= k;
  out_near = near.x * k * k * vec4(splat_near, area_mm2);
#ifdef MEAN
  out_mean = near.y * vec4(splat_flux, area_mm2);
#endif
#else
  vec2 parts = r * weight_place.xz + weight_place.yw;
  float part = clamp(min(parts.x, parts.y), 0.0, 1.0);
  float weight = part * part * (3.0 - 2.0 * part);
#endif
  root *= root;
  root *= root;
  vec3 value = weight * root * root;
#ifdef BOUNDED
  value *= vec3(lessThan(vec3(r), support));
#endif
  out_sum = vec4(value, r * (value.r + value.g + value.b));
}

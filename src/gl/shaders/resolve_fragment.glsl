// Exitance of a pixel from one level. Sums are taken from the level's texels around it, weighted by
// distance in space and on the screen, and get the pixel's own profile at their mean radius:
//
//   M = B a_o(B1 / B) / A(B1 / B),
//
// which is exact to first order in r within the level (B1 / B of the channels together), and leaves the texture of a_o as sharp as
// the picture. PIXELS: the material has a profile for each pixel of the picture, drawn PIXELS x
// PIXELS times.
uniform sampler2D positions;
uniform sampler2D normals;
uniform sampler2D places;
uniform sampler2D level_a;  // positions of the two layers
uniform sampler2D level_b;
uniform sampler2DArray level_sums;
#ifdef SINGLE
uniform sampler2DArray level_near;
#ifdef MEAN
uniform sampler2DArray level_mean;
#endif
#endif
uniform int block;                // pixels of a texel's side
uniform float softness;           // mm
uniform int level_nodes[5];
uniform vec3 reference_nodes[5];
uniform float node_r5[5];
layout(location = 0) out vec4 exitance;

struct Sums {
  vec4 sum;
  vec4 near;
  vec4 mean;
};

void add_texel(inout Sums sums, ivec3 texel, float weight) {
  sums.sum += weight * texelFetch(level_sums, texel, 0);
#ifdef SINGLE
  sums.near += weight * texelFetch(level_near, texel, 0);
#ifdef MEAN
  sums.mean += weight * texelFetch(level_mean, texel, 0);
#endif
#endif
}

// Squared distance over softness squared; far away where there is nothing. The normal is on the
// camera's axes.
float apart(ivec3 texel, vec3 position, vec3 normal) {
  ivec2 size = textureSize(level_a, 0);
  if (any(lessThan(texel.xy, ivec2(0))) || any(greaterThanEqual(texel.xy, size))) return 1e30;
  vec4 there =
      texel.z == 0 ? texelFetch(level_a, texel.xy, 0) : texelFetch(level_b, texel.xy, 0);
  if (there.w <= 0.0) return 1e30;
  vec3 d = (there.xyz - position) / softness;
  float result = dot(d, d);
#ifdef SINGLE
  vec2 p = unpack_facing(there.w);
  float p2 = dot(p, p);
  result += 4.0 * (1.0 - dot(vec3(2.0 * p, 1.0 - p2), normal) / (1.0 + p2));
#endif
  return result;
}

Sums interpolate(ivec2 pixel, vec3 position, vec3 normal) {
  Sums sums = Sums(vec4(0.0), vec4(0.0), vec4(0.0));
  if (block == 1) {
    add_texel(sums, ivec3(pixel, 0), 1.0);
    return sums;
  }
  vec2 at = vec2(pixel) / float(block) - 0.5;  // A is the pixel after the middle on both axes
  ivec2 first = ivec2(floor(at));
  vec2 part = at - vec2(first);
  float distances[8], least = 1e29, most = 0.0, total = 0.0;
  int count = 4;  // B only where some A lies on another surface
  for (int i = 0; i < count; ++i) {
    distances[i] = apart(ivec3(first + ivec2(i & 1, (i >> 1) & 1), i >> 2), position, normal);
    least = min(least, distances[i]);
    most = max(most, distances[i]);
    if (i == 3 && most > 4.0) count = 8;
  }
  for (int i = 0; i < count; ++i) {
    if (distances[i] > least + 40.0) continue;
    ivec2 corner = ivec2(i & 1, (i >> 1) & 1);
    float tent = (corner.x == 1 ? part.x : 1.0 - part.x) * (corner.y == 1 ? part.y : 1.0 - part.y);
    float weight = (tent + 1e-3) * exp(-0.5 * (distances[i] - least));
    add_texel(sums, ivec3(first + corner, i >> 2), weight);
    total += weight;
  }
  if (total > 0.0) {
    sums.sum /= total;
    sums.near /= total;
    sums.mean /= total;
  }
  return sums;
}

// ln(a_o / A) at a radius, linear between the level's nodes.
vec3 log_ratio_at(Corners corners, vec3 support, float r) {
  int k = r < node_r5[1] ? 0 : r < node_r5[2] ? 1 : r < node_r5[3] ? 2 : 3;
  ivec2 nodes = ivec2(level_nodes[k], level_nodes[k + 1]);
  float t = clamp((r - node_r5[k]) / (node_r5[k + 1] - node_r5[k]), 0.0, 1.0);
  vec3 ratio = half_log_at(corners, nodes, t) +
               mix(cut_log(support, nodes.x) - reference_nodes[k],
                   cut_log(support, nodes.y) - reference_nodes[k + 1], t);
  return clamp(ratio, -40.0, 40.0);  // what lies beyond is nothing, and must not become 0 / 0
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 position = texelFetch(positions, pixel, 0);
  Sums sums = interpolate(pixel, position.xyz, to_camera_axes(texelFetch(normals, pixel, 0).xyz));
  vec3 result = sums.sum.rgb;
  float r = sums.sum.a / max(result.r + result.g + result.b, 1e-30);
#ifndef SINGLE
  if (result == vec3(0.0)) discard;
#endif
#ifdef PIXELS
  Corners corners = Corners(pixel / PIXELS, pixel / PIXELS, vec2(0.0));
#else
  Corners corners = find_corners(texelFetch(places, pixel, 0).xy);
#endif
  vec3 support = mix_corners(corners, material_support);
  result *= exp(log_ratio_at(corners, support, r));
#ifdef SINGLE
  vec3 n = mix_corners(corners, near_count);
  vec3 log_integral = mix_corners(corners, near_integral);
  vec3 limit = mix(vec3(1e30), 1.0 + 2.0 / max(n - 1.0, 1e-6), vec3(greaterThan(n, vec3(1.0))));
  vec3 scale = clamp(vec3(1.0 / max(sums.near.a, 1e-30)), 1.0 / limit, limit);
  vec3 close = scale * sums.near.rgb * exp(0.5 * log_integral);
#ifdef MEAN
  vec3 u = clamp((n - 2.0) / 6.0, 0.0, 1.0);
  vec3 trust = sums.mean.a > 0.0 ? u * u * (3.0 - 2.0 * u) : vec3(1.0);
  close = mix(vec3(0.0), trust * close, greaterThan(trust, vec3(0.0))) +
          (1.0 - trust) * exp(log_integral) * sums.mean.rgb / max(sums.mean.a, 1e-30);
#endif
  result += close;
#endif
  exitance = vec4(result, 1.0);
}

// Exitance of a pixel from one or two levels. Sums are taken from each level's texels around the
// pixel, weighted by distance in space and on the screen, and get its own profile at their mean
// radius:
//
//   M = sum_l B a_o(B1 / B) / A(B1 / B),
//
// which is exact to first order in r within a level (B1 / B of the channels together), and leaves
// the texture of a_o as sharp as the picture. SINGLE: level 0 alone. PIXELS: the
// material has a profile for each pixel of the picture, drawn PIXELS x PIXELS times.
uniform sampler2D positions;
uniform sampler2D normals;
uniform sampler2D places;
uniform sampler2D level0_a;  // positions of the two layers
uniform sampler2D level0_b;
uniform sampler2DArray level0_sums;
#ifdef SINGLE
const int most_levels = 1;
uniform sampler2DArray level_near;
#ifdef MEAN
uniform sampler2DArray level_mean;
#endif
#else
const int most_levels = 2;
uniform sampler2D level1_a;
uniform sampler2D level1_b;
uniform sampler2DArray level1_sums;
uniform int level_count;              // of these
#endif
uniform int block[most_levels];       // pixels of a texel's side
uniform float softness[most_levels];  // mm
uniform int level_nodes[5 * most_levels];
uniform vec3 reference_nodes[5 * most_levels];
layout(location = 0) out vec4 exitance;

struct Seen {
  ivec2 pixel;
  vec3 position;
  vec3 normal;
  Corners corners;
  vec3 support;
};

// The four texels of each layer (gl/splat_levels.h) around a pixel, and their weights.
struct Texels {
  ivec2 first;
  ivec2 last;
  vec4 a;
  vec4 b;
  bool has_b;
};

// Squared distance over softness squared; far away where there is nothing. Normals are on the
// camera's axes.
float apart(sampler2D level_positions, ivec2 texel, bool is_inside, Seen seen, float unit,
            bool with_normal) {
  vec4 there = texelFetch(level_positions, texel, 0);
  if (!is_inside || there.w <= 0.0) return 1e30;
  vec3 d = (there.xyz - seen.position) / unit;
  float result = dot(d, d);
  if (with_normal) {
    vec2 p = unpack_facing(there.w);
    float p2 = dot(p, p);
    result += 4.0 * (1.0 - dot(vec3(2.0 * p, 1.0 - p2), seen.normal) / (1.0 + p2));
  }
  return result;
}

vec4 all_apart(sampler2D level_positions, Texels at, ivec4 inside, Seen seen, float unit,
               bool with_normal) {
  ivec2 a = at.first, b = at.last;
  bvec4 is = bvec4(inside);
  return vec4(
      apart(level_positions, a, is.x && is.y, seen, unit, with_normal),
      apart(level_positions, ivec2(b.x, a.y), is.z && is.y, seen, unit, with_normal),
      apart(level_positions, ivec2(a.x, b.y), is.x && is.w, seen, unit, with_normal),
      apart(level_positions, b, is.z && is.w, seen, unit, with_normal));
}

Texels find_texels(sampler2D level_a, sampler2D level_b, int level, Seen seen, bool with_normal) {
  Texels at;
  at.has_b = false;
  at.b = vec4(0.0);
  if (block[level] == 1) {
    at.first = at.last = seen.pixel;
    at.a = vec4(1.0, 0.0, 0.0, 0.0);
    return at;
  }
  // A is the pixel after the middle on both axes.
  vec2 middle = vec2(seen.pixel) / float(block[level]) - 0.5, corner = floor(middle);
  vec2 part = middle - corner;
  ivec2 last = textureSize(level_a, 0) - 1, first = ivec2(corner);
  at.first = max(first, ivec2(0));
  at.last = min(first + 1, last);
  ivec4 inside = ivec4(greaterThanEqual(first, ivec2(0)), lessThan(first, last));
  vec4 a = all_apart(level_a, at, inside, seen, softness[level], with_normal);
  vec4 b = vec4(1e30);
  float most = max(max(a.x, a.y), max(a.z, a.w));
  if (most > 4.0) {  // B only where some A lies on another surface
    at.has_b = true;
    b = all_apart(level_b, at, inside, seen, softness[level], with_normal);
  }
  vec4 nearer = min(a, b);
  float least = min(min(nearer.x, nearer.y), min(nearer.z, nearer.w));
  if (least > 1e29) {
    at.a = vec4(0.0);
    return at;
  }
  vec2 rest = 1.0 - part;
  vec4 tents = vec4(rest.x * rest.y, part.x * rest.y, rest.x * part.y, part.x * part.y) + 1e-3;
  at.a = tents * exp(-0.5 * (a - least));
  at.b = at.has_b ? tents * exp(-0.5 * (b - least)) : vec4(0.0);
  float total = dot(at.a + at.b, vec4(1.0));
  at.a /= total;
  at.b /= total;
  return at;
}

vec4 mix_layer(sampler2DArray values, Texels at, int layer, vec4 weight) {
  ivec2 a = at.first, b = at.last;
  return weight.x * texelFetch(values, ivec3(a, layer), 0) +
         weight.y * texelFetch(values, ivec3(b.x, a.y, layer), 0) +
         weight.z * texelFetch(values, ivec3(a.x, b.y, layer), 0) +
         weight.w * texelFetch(values, ivec3(b, layer), 0);
}
vec4 mix_texels(sampler2DArray values, Texels at) {
  vec4 sum = mix_layer(values, at, 0, at.a);
  if (at.has_b) sum += mix_layer(values, at, 1, at.b);
  return sum;
}

// ln(a_o / A) at a radius, linear between the level's nodes.
vec3 log_ratio_at(Seen seen, int level, float r) {
  int k = 5 * level;
  for (int i = 0; i < 3; ++i)
    if (r >= node_r[level_nodes[k + 1]]) ++k;
  ivec2 nodes = ivec2(level_nodes[k], level_nodes[k + 1]);
  float t = clamp((r - node_r[nodes.x]) / (node_r[nodes.y] - node_r[nodes.x]), 0.0, 1.0);
  vec3 ratio = half_log_at(seen.corners, nodes, t) +
               mix(cut_log(seen.support, nodes.x) - reference_nodes[k],
                   cut_log(seen.support, nodes.y) - reference_nodes[k + 1], t);
  return clamp(ratio, -40.0, 40.0);  // what lies beyond is nothing, and must not become 0 / 0
}

// With the pixel's own profile, of sums of one level.
vec3 finish(Seen seen, int level, vec4 sum) {
  float all = sum.r + sum.g + sum.b;
  if (all == 0.0) return vec3(0.0);
  return sum.rgb * exp(log_ratio_at(seen, level, sum.a / max(all, 1e-30)));
}

vec3 resolve_group(sampler2D level_a, sampler2D level_b, sampler2DArray level_sums, int level,
                   Seen seen) {
  Texels at = find_texels(level_a, level_b, level, seen, false);
  return finish(seen, level, mix_texels(level_sums, at));
}

#ifdef SINGLE
vec3 resolve_single(Seen seen) {
  Texels at = find_texels(level0_a, level0_b, 0, seen, true);
  vec4 near = mix_texels(level_near, at);
  vec3 n = mix_corners(seen.corners, near_count);
  vec3 log_integral = mix_corners(seen.corners, near_integral);
  vec3 limit = mix(vec3(1e30), 1.0 + 2.0 / max(n - 1.0, 1e-6), greaterThan(n, vec3(1.0)));
  vec3 scale = clamp(vec3(1.0 / max(near.a, 1e-30)), 1.0 / limit, limit);
  vec3 close = scale * near.rgb * exp(0.5 * log_integral);
#ifdef MEAN
  vec4 mean = mix_texels(level_mean, at);
  vec3 u = clamp((n - 2.0) / 6.0, 0.0, 1.0);
  vec3 trust = mean.a > 0.0 ? u * u * (3.0 - 2.0 * u) : vec3(1.0);
  close = mix(vec3(0.0), trust * close, greaterThan(trust, vec3(0.0))) +
          (1.0 - trust) * exp(log_integral) * mean.rgb / max(mean.a, 1e-30);
#endif
  return close + finish(seen, 0, mix_texels(level0_sums, at));
}
#endif

void main() {
  Seen seen;
  seen.pixel = ivec2(gl_FragCoord.xy);
  seen.position = texelFetch(positions, seen.pixel, 0).xyz;
  seen.normal = to_camera_axes(texelFetch(normals, seen.pixel, 0).xyz);
#ifdef PIXELS
  seen.corners.pixel[0] = seen.pixel / PIXELS;
  seen.corners.weight[0] = 1.0;
  seen.corners = load_corners(seen.corners);
#else
  seen.corners = find_corners(texelFetch(places, seen.pixel, 0).xy);
#endif
  seen.support = mix_corners(seen.corners, material_support);
#ifdef SINGLE
  vec3 sum = resolve_single(seen);
#else
  vec3 sum = resolve_group(level0_a, level0_b, level0_sums, 0, seen);
  if (level_count > 1) sum += resolve_group(level1_a, level1_b, level1_sums, 1, seen);
#endif
  exitance = vec4(sum, 1.0);
}

// Profiles of the material's pixels at the renderer's radii ("nodes"):
//   h = 1/2 ln P, bilinear over the sample's pixels as material/profile_field.h has it.
// A profile map keeps h of each pixel; a blend (K-BMPP) keeps h of each base material, and for each
// pixel K indices, which are never filtered, and K weights (Eq. 4).
uniform sampler2D material_support;  // mm, beyond which R_d is zero
uniform float node_r[NODES];         // mm
#ifdef BLEND
uniform sampler2D base_rows;          // [base][node], then value and slope at the end of the knots
uniform usampler2DArray blend_index;  // [k]
uniform sampler2DArray blend_weight;  // [k]
uniform sampler2D blend_gain;         // 1/2 ln gain
uniform float blend_end;              // the last knot, mm
uniform float blend_slope;            // least decay beyond it, 1/mm
#else
uniform sampler2DArray half_log_rows;  // [node]
#endif

vec3 pixel_half_log(ivec2 pixel, int node) {
#ifdef BLEND
  vec3 h = texelFetch(blend_gain, pixel, 0).rgb;
  vec3 inside = vec3(0.0), end = vec3(0.0), slope = vec3(0.0);
  bool is_tail = node_r[node] > blend_end;
  for (int k = 0; k < BLEND; ++k) {
    int base = int(texelFetch(blend_index, ivec3(pixel, k), 0).r);
    float weight = texelFetch(blend_weight, ivec3(pixel, k), 0).r;
    if (is_tail) {
      end += weight * texelFetch(base_rows, ivec2(NODES, base), 0).rgb;
      slope += weight * texelFetch(base_rows, ivec2(NODES + 1, base), 0).rgb;
    } else {
      inside += weight * texelFetch(base_rows, ivec2(node, base), 0).rgb;
    }
  }
  if (is_tail) return h + end + min(slope, vec3(blend_slope)) * (node_r[node] - blend_end);
  return h + inside;
#else
  return texelFetch(half_log_rows, ivec3(pixel, node), 0).rgb;
#endif
}

// The four pixels around a place and their weights; centres at integers, clamped to the grid.
struct Corners {
  ivec2 first;
  ivec2 last;
  vec2 part;
};
Corners find_corners(vec2 place) {
  ivec2 size = textureSize(material_support, 0);
  vec2 p = clamp(place, vec2(0.0), vec2(size - 1));
  Corners corners;
  corners.first = min(ivec2(p), max(ivec2(0), size - 2));
  corners.last = min(corners.first + 1, size - 1);
  corners.part = p - vec2(corners.first);
  return corners;
}
vec3 mix_corners(Corners corners, sampler2D values) {
  ivec2 a = corners.first, b = corners.last;
  return mix(mix(texelFetch(values, a, 0).rgb, texelFetch(values, ivec2(b.x, a.y), 0).rgb,
                 corners.part.x),
             mix(texelFetch(values, ivec2(a.x, b.y), 0).rgb, texelFetch(values, b, 0).rgb,
                 corners.part.x),
             corners.part.y);
}
vec3 half_log_at(Corners corners, int node) {
  ivec2 a = corners.first, b = corners.last;
  if (a == b) return pixel_half_log(a, node);
  return mix(
      mix(pixel_half_log(a, node), pixel_half_log(ivec2(b.x, a.y), node), corners.part.x),
      mix(pixel_half_log(ivec2(a.x, b.y), node), pixel_half_log(b, node), corners.part.x),
      corners.part.y);
}

// A profile that ends between nodes: from the node before, exp(h) falls by the exponential that
// leaves as much between both as the cut does: (1 - e^-k) / k = f, the part before the support.
vec3 cut_log(vec3 support, int node) {
  float before = node_r[max(0, node - 1)], step = max(node_r[node] - before, 1e-6);
  vec3 f = clamp((support - before) / step, 0.05, 1.0);
  vec3 k = (1.0 - f) * (1.0 + 1.15 * f) / f;
  return mix(-k, vec3(-20.0), vec3(lessThanEqual(support, vec3(before))));
}

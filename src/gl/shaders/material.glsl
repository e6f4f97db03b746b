// Profiles of the material's pixels at the renderer's radii ("nodes"):
//   h = 1/2 ln P, bilinear over the sample's pixels as material/profile_field.h has it.
// UNIFORM: of one pixel. A profile map keeps h of each pixel; a blend (K-BMPP) keeps h of each base material, and for each
// pixel K indices, which are never filtered, and K weights (Eq. 4).
uniform sampler2D material_support;  // mm, beyond which R_d is zero
uniform float node_r[NODES];         // mm
uniform sampler2D near_integral;     // ln int P w dA, w the near term's weight
uniform sampler2D near_count;        // number of samples that carry it
#ifdef BLEND
uniform sampler2D base_rows;          // [base][node], then value and slope at the end of the knots
uniform usampler2DArray blend_index;  // [k]
uniform sampler2DArray blend_weight;  // [k]
#ifdef GAIN
uniform sampler2D blend_gain;         // 1/2 ln gain
#endif
uniform float blend_end;              // the last knot, mm
uniform float blend_slope;            // least decay beyond it, 1/mm
#else
uniform sampler2DArray half_log_rows;  // [node]
#endif

// At part t of the way from one node to another.
vec3 pixel_half_log(ivec2 pixel, ivec2 nodes, float t) {
#ifdef BLEND
  vec2 r = vec2(node_r[nodes.x], node_r[nodes.y]);
  bool ends = max(r.x, r.y) > blend_end;
  vec3 from = vec3(0.0), to = vec3(0.0), end = vec3(0.0), slope = vec3(0.0);
  for (int k = 0; k < BLEND; ++k) {
    int base = int(texelFetch(blend_index, ivec3(pixel, k), 0).r);
    float weight = texelFetch(blend_weight, ivec3(pixel, k), 0).r;
    from += weight * texelFetch(base_rows, ivec2(nodes.x, base), 0).rgb;
    to += weight * texelFetch(base_rows, ivec2(nodes.y, base), 0).rgb;
    if (ends) {
      end += weight * texelFetch(base_rows, ivec2(NODES, base), 0).rgb;
      slope += weight * texelFetch(base_rows, ivec2(NODES + 1, base), 0).rgb;
    }
  }
  slope = min(slope, vec3(blend_slope));
  if (r.x > blend_end) from = end + slope * (r.x - blend_end);
  if (r.y > blend_end) to = end + slope * (r.y - blend_end);
  vec3 h = mix(from, to, t);
#ifdef GAIN
  h += texelFetch(blend_gain, pixel, 0).rgb;
#endif
  return h;
#else
  return mix(texelFetch(half_log_rows, ivec3(pixel, nodes.x), 0).rgb,
             texelFetch(half_log_rows, ivec3(pixel, nodes.y), 0).rgb, t);
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
#ifdef UNIFORM
  return texelFetch(values, a, 0).rgb;
#endif
  return mix(mix(texelFetch(values, a, 0).rgb, texelFetch(values, ivec2(b.x, a.y), 0).rgb,
                 corners.part.x),
             mix(texelFetch(values, ivec2(a.x, b.y), 0).rgb, texelFetch(values, b, 0).rgb,
                 corners.part.x),
             corners.part.y);
}
vec3 half_log_at(Corners corners, ivec2 nodes, float t) {
  ivec2 a = corners.first, b = corners.last;
#ifdef UNIFORM
  return pixel_half_log(a, nodes, t);
#else
  return mix(mix(pixel_half_log(a, nodes, t), pixel_half_log(ivec2(b.x, a.y), nodes, t),
                 corners.part.x),
             mix(pixel_half_log(ivec2(a.x, b.y), nodes, t), pixel_half_log(b, nodes, t),
                 corners.part.x),
             corners.part.y);
#endif
}

// A profile that ends between nodes: from the node before, exp(h) falls by the exponential that
// leaves as much between both as the cut does: (1 - e^-k) / k = f, the part before the support.
vec3 cut_log(vec3 support, int node) {
  float before = node_r[max(0, node - 1)], step = max(node_r[node] - before, 1e-6);
  vec3 f = clamp((support - before) / step, 0.05, 1.0);
  vec3 k = (1.0 - f) * (1.0 + 1.15 * f) / f;
  return mix(-k, vec3(-20.0), lessThanEqual(support, vec3(before)));
}

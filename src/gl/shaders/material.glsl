// Profiles of the material's pixels at the renderer's radii ("nodes"):
//   h = 1/2 ln P, bilinear over the sample's pixels as material/profile_field.h has it.
// UNIFORM: of one pixel. A profile map keeps h of each pixel; a blend (K-BMPP) keeps h of each base
// material, and for each pixel K indices, which are never filtered, and K weights (Eq. 4).
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

#ifdef UNIFORM
const int corner_count = 1;
#else
const int corner_count = 4;
#endif

// The pixels around a place, with what each holds for any radius.
struct Corners {
  ivec2 pixel[corner_count];
  float weight[corner_count];
#ifdef BLEND
  int base[BLEND * corner_count];  // [corner][k]
  float part[BLEND * corner_count];
#ifdef GAIN
  vec3 gain;
#endif
#endif
};

vec3 mix_corners(Corners corners, sampler2D values) {
  vec3 sum = vec3(0.0);
  for (int c = 0; c < corner_count; ++c)
    sum += corners.weight[c] * texelFetch(values, corners.pixel[c], 0).rgb;
  return sum;
}

Corners load_corners(Corners corners) {
#ifdef BLEND
  for (int c = 0; c < corner_count; ++c)
    for (int k = 0; k < BLEND; ++k) {
      corners.base[BLEND * c + k] =
          int(texelFetch(blend_index, ivec3(corners.pixel[c], k), 0).r);
      corners.part[BLEND * c + k] =
          texelFetch(blend_weight, ivec3(corners.pixel[c], k), 0).r;
    }
#ifdef GAIN
  corners.gain = mix_corners(corners, blend_gain);
#endif
#endif
  return corners;
}

// Centres at integers, clamped to the grid.
Corners find_corners(vec2 place) {
  ivec2 size = textureSize(material_support, 0);
  vec2 p = clamp(place, vec2(0.0), vec2(size - 1));
  Corners corners;
#ifdef UNIFORM
  corners.pixel[0] = ivec2(p);
  corners.weight[0] = 1.0;
#else
  ivec2 a = min(ivec2(p), max(ivec2(0), size - 2)), b = min(a + 1, size - 1);
  vec2 part = p - vec2(a);
  corners.pixel[0] = a;
  corners.pixel[1] = ivec2(b.x, a.y);
  corners.pixel[2] = ivec2(a.x, b.y);
  corners.pixel[3] = b;
  corners.weight[0] = (1.0 - part.x) * (1.0 - part.y);
  corners.weight[1] = part.x * (1.0 - part.y);
  corners.weight[2] = (1.0 - part.x) * part.y;
  corners.weight[3] = part.x * part.y;
#endif
  return load_corners(corners);
}

#ifdef BLEND
// Beyond the last knot: h goes on with the slope it has there.
vec3 tail_half_log(Corners corners, float beyond) {
  vec3 sum = vec3(0.0);
  for (int c = 0; c < corner_count; ++c) {
    vec3 end = vec3(0.0), slope = vec3(0.0);
    for (int k = 0; k < BLEND; ++k) {
      int base = corners.base[BLEND * c + k];
      float part = corners.part[BLEND * c + k];
      end += part * texelFetch(base_rows, ivec2(NODES, base), 0).rgb;
      slope += part * texelFetch(base_rows, ivec2(NODES + 1, base), 0).rgb;
    }
    sum += corners.weight[c] * (end + min(slope, vec3(blend_slope)) * beyond);
  }
  return sum;
}
#endif

// At part t of the way from one node to another.
vec3 half_log_at(Corners corners, ivec2 nodes, float t) {
  vec3 from = vec3(0.0), to = vec3(0.0);
#ifdef BLEND
  for (int i = 0; i < BLEND * corner_count; ++i) {
    float part = corners.weight[i / BLEND] * corners.part[i];
    from += part * texelFetch(base_rows, ivec2(nodes.x, corners.base[i]), 0).rgb;
    to += part * texelFetch(base_rows, ivec2(nodes.y, corners.base[i]), 0).rgb;
  }
  vec2 beyond = vec2(node_r[nodes.x], node_r[nodes.y]) - blend_end;
  if (beyond.x > 0.0) from = tail_half_log(corners, beyond.x);
  if (beyond.y > 0.0) to = tail_half_log(corners, beyond.y);
#ifdef GAIN
  return mix(from, to, t) + corners.gain;
#else
  return mix(from, to, t);
#endif
#else
  for (int c = 0; c < corner_count; ++c) {
    from += corners.weight[c] * texelFetch(half_log_rows, ivec3(corners.pixel[c], nodes.x), 0).rgb;
    to += corners.weight[c] * texelFetch(half_log_rows, ivec3(corners.pixel[c], nodes.y), 0).rgb;
  }
  return mix(from, to, t);
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

// What a source sends, as a splat carries it: in each channel a cubic in r (least squares over the
// level's nodes, gl/splat_fit.h) whose eighth power is
//
//   a_i flux_i A
//
// with a = exp(h), A the reference profile's; fit_0.w, fit_1.w and fit_2.w are the cubic terms of the
// channels. What falls far below the reference is held there, or the fit would swing. SINGLE, of
// samples: fit_3 = sqrt(I_i) flux_i, with I_i = int P_i w dA for the near term's w.
uniform sampler2D source_rows;
#ifdef SINGLE
uniform sampler2D source_flux;
uniform sampler2D source_near;
#endif
uniform int source_lines;
uniform int fit_nodes[NODES];         // indices
uniform vec3 reference_nodes[NODES];  // log2 of the reference there
uniform vec3 kernel_nodes[NODES];     // of its square
uniform vec4 fit[3 * NODES];          // [3 node + channel]: its weight in each coefficient
layout(location = 0) out vec4 fit_0;
layout(location = 1) out vec4 fit_1;
layout(location = 2) out vec4 fit_2;
#ifdef SINGLE
layout(location = 3) out vec4 fit_3;
#endif

const float deepest = 3.0;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec3 flux = vec3(1.0);
#ifdef SINGLE
  flux = texelFetch(source_flux, texel, 0).rgb;
  fit_3 = vec4(flux * texelFetch(source_near, texel, 0).rgb, 0.0);
#endif
  mat4x3 terms = mat4x3(0.0);  // [power][channel]
  float most = 0.0;
  vec3 least = vec3(0.0);
  for (int k = 0; k < NODES; ++k) {
    ivec2 place = ivec2(texel.x, texel.y + fit_nodes[k] * source_lines);
    vec3 sent = flux * texelFetch(source_rows, place, 0).rgb;
    most = max(most, max(sent.r, max(sent.g, sent.b)));
    vec3 value = log2(max(sent, 1e-30)) - reference_nodes[k];
    if (k == 0) least = value - deepest;
    vec3 root = exp2(0.125 * (max(value, least) + kernel_nodes[k]));
    for (int c = 0; c < 3; ++c) {
      vec4 weights = fit[3 * k + c];
      for (int j = 0; j < 4; ++j) terms[j][c] += weights[j] * root[c];
    }
  }
  if (most <= 0.0) terms = mat4x3(0.0);
  fit_0 = vec4(terms[0], terms[3].r);
  fit_1 = vec4(terms[1], terms[3].g);
  fit_2 = vec4(terms[2], terms[3].b);
}

// What a source sends, as a splat carries it: in each channel a polynomial in r (least squares over
// the level's nodes, gl/splat_fit.h) of
//
//   log2(a_i flux_i A)   of a group, of degree 3: fit_2.w ... of the channels are its last terms
//   log2(a_i flux_i / A) of a sample (SINGLE), of degree 2; then w has sqrt(I_i) flux_i
//
// a = exp(h), A the reference profile's, I_i = int P_i w dA with the near term's w. What falls far
// below the reference is held there, or the fit would swing.
uniform sampler2D source_rows;
#ifdef SINGLE
uniform sampler2D source_flux;
uniform sampler2D source_near;
#endif
uniform int source_lines;
uniform int level_nodes[5];       // indices
uniform vec3 reference_nodes[5];  // log2 of the reference there
uniform vec3 kernel_nodes[5];     // of its square, for groups
uniform vec4 fit[5];              // weights of the nodes in each coefficient
layout(location = 0) out vec4 fit_0;
layout(location = 1) out vec4 fit_1;
layout(location = 2) out vec4 fit_2;

const float deepest = 3.0;
const float dark = -1000.0;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec3 flux = vec3(1.0), ends = vec3(0.0);
#ifdef SINGLE
  flux = texelFetch(source_flux, texel, 0).rgb;
  ends = flux * texelFetch(source_near, texel, 0).rgb;
#endif
  fit_0 = fit_1 = fit_2 = vec4(0.0);
  float most = 0.0;
  vec3 least = vec3(0.0);
  for (int k = 0; k < 5; ++k) {
    ivec2 place = ivec2(texel.x, texel.y + level_nodes[k] * source_lines);
    vec3 sent = flux * texelFetch(source_rows, place, 0).rgb;
    most = max(most, max(sent.r, max(sent.g, sent.b)));
    vec3 value = log2(max(sent, 1e-30)) - reference_nodes[k];
    if (k == 0) least = value - deepest;
    value = max(value, least);
#ifndef SINGLE
    value += kernel_nodes[k];
    ends += fit[k].w * value;
#endif
    fit_0.rgb += fit[k].x * value;
    fit_1.rgb += fit[k].y * value;
    fit_2.rgb += fit[k].z * value;
  }
  if (most <= 0.0) {
    fit_0.rgb = vec3(dark);
    fit_1.rgb = fit_2.rgb = vec3(0.0);
  }
  fit_0.w = ends.r;
  fit_1.w = ends.g;
  fit_2.w = ends.b;
}

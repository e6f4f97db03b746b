// From exitance to radiance: L = T M / pi + reflection, T = Fresnel transmission towards the viewer
// where the material's boundary is excluded.
uniform sampler2D positions;
uniform sampler2D normals;
uniform sampler2D exitances;
uniform sampler2D reflections;
uniform int is_reflecting;
uniform int is_transmitting;
uniform float eta;
uniform float exposure;
uniform vec3 background;
layout(location = 0) out vec4 radiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  radiance = vec4(background, 0.0);
  if (texelFetch(positions, pixel, 0).w <= 0.0) return;
  float t = is_transmitting != 0 ? fresnel_transmission(eta, texelFetch(normals, pixel, 0).w) : 1.0;
  vec3 sum = t / 3.14159265 * texelFetch(exitances, pixel, 0).rgb;
  if (is_reflecting != 0) sum += texelFetch(reflections, pixel, 0).rgb;
  radiance = vec4(exposure * sum, 1.0);
}

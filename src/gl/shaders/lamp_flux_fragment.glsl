// What one light adds to the flux that enters at the samples: E F_t (n . w) V times area.
uniform sampler2D sample_positions;
uniform sampler2D sample_normals;
uniform int is_transmitting;
uniform float eta;
uniform float area_mm2;
layout(location = 0) out vec4 flux;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec4 position = texelFetch(sample_positions, texel, 0);
  vec3 normal = texelFetch(sample_normals, texel, 0).xyz;
  if (position.w <= 0.0) discard;
  float cosine = dot(normal, lamp_direction(position.xyz));
  if (cosine <= 0.0) discard;
  float weight = cosine * (is_transmitting != 0 ? fresnel_transmission(eta, cosine) : 1.0) *
                 visibility(position.xyz, normal);
  flux = vec4(area_mm2 * weight * lamp_irradiance(position.xyz), 0.0);
}

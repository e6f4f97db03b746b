// What one light adds to the picture by reflection.
layout(location = 0) out vec4 radiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  Reflector seen = get_reflector(pixel);
  vec3 light = lamp_direction(seen.position);
  if (dot(seen.geometric_normal, light) <= 0.0) discard;
  float f = eval_ggx(seen, light);
  if (f <= 0.0) discard;
  f *= visibility(seen.position, seen.geometric_normal);
  radiance = vec4(f * lamp_irradiance(seen.position), 0.0);
}

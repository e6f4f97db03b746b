// Reflection of an environment: visible normals (Heitz 2018), each looked up in the picture at the
// resolution of its share of the lobe, where the object does not hide it.
uniform int rays;
layout(location = 0) out vec4 radiance;

float reverse_bits(uint bits) {
  bits = (bits << 16u) | (bits >> 16u);
  bits = ((bits & 0x00ff00ffu) << 8u) | ((bits & 0xff00ff00u) >> 8u);
  bits = ((bits & 0x0f0f0f0fu) << 4u) | ((bits & 0xf0f0f0f0u) >> 4u);
  bits = ((bits & 0x33333333u) << 2u) | ((bits & 0xccccccccu) >> 2u);
  bits = ((bits & 0x55555555u) << 1u) | ((bits & 0xaaaaaaaau) >> 1u);
  return float(bits >> 8u) / 16777216.0;
}

// Interleaved gradient noise: neighbouring pixels get different shifts.
float shift_of(ivec2 pixel) {
  return fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  Reflector seen = get_reflector(pixel);
  vec3 n = seen.normal;
  vec3 t1 = normalize(abs(n.z) < 0.9 ? cross(n, vec3(0.0, 0.0, 1.0)) : cross(n, vec3(1.0, 0.0, 0.0)));
  vec3 t2 = cross(n, t1);
  vec3 v = vec3(dot(seen.view, t1), dot(seen.view, t2), dot(seen.view, n));
  vec3 stretched = normalize(vec3(alpha * v.xy, v.z));
  vec3 side = dot(stretched.xy, stretched.xy) > 1e-12 ? normalize(vec3(-stretched.y, stretched.x, 0.0))
                                                     : vec3(1.0, 0.0, 0.0);
  vec3 up = cross(stretched, side);
  vec2 size = vec2(textureSize(sky, 0));
  float texel_angle = 4.0 * pi / (size.x * size.y), shift = shift_of(pixel);
  vec3 place = occlusion_place(seen.position, seen.geometric_normal);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < rays; ++i) {
    vec2 random = fract(vec2((float(i) + 0.5) / float(rays), reverse_bits(uint(i))) +
                        vec2(shift, fract(shift * 7.23)));
    float r = sqrt(random.x), angle = 2.0 * pi * random.y, s = 0.5 * (1.0 + stretched.z);
    float x = r * cos(angle);
    float y = (1.0 - s) * sqrt(max(0.0, 1.0 - x * x)) + s * r * sin(angle);
    vec3 m = side * x + up * y + stretched * sqrt(max(0.0, 1.0 - x * x - y * y));
    m = normalize(vec3(alpha * m.xy, max(1e-6, m.z)));
    vec3 h = t1 * m.x + t2 * m.y + n * m.z;
    vec3 light = normalize(2.0 * dot(seen.view, h) * h - seen.view);
    if (dot(seen.geometric_normal, light) <= 0.0) continue;
    float f = eval_ggx(seen, light);
    if (f <= 0.0) continue;
    // Of a sequence that fills the square with any number of its points (Roberts 2018).
    vec2 of_maps = fract(vec2(0.75487767, 0.56984029) * float(i) + vec2(shift * 3.1, shift * 11.7));
    if (sees_environment(place, seen.geometric_normal, light, of_maps) == 0.0) continue;
    float nv = dot(n, seen.view);
    float pdf = eval_distribution(n, h) / (2.0 * (nv + masking_root(nv)));
    float lod = 0.5 * log2(max(1.0, 1.0 / (float(rays) * pdf * texel_angle)));
    sum += f / pdf * textureLod(sky, sky_place(light), lod).rgb;
  }
  radiance = vec4(sky_scale * sum / float(rays), 0.0);
}

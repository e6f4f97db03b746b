// A directional or point light and what it reaches: shadow maps, one layer for each direction that
// the light looks in.
uniform sampler2DArray shadow_depth;
uniform mat4 shadow_view[SHADOW_VIEWS];  // to device coordinates
uniform vec2 shadow_texel[SHADOW_VIEWS]; // mm: size of a texel, and its growth per mm of distance
uniform vec3 lamp;                       // direction towards it, or its position
uniform int lamp_is_near;                // 1: a position
uniform vec3 lamp_power;                 // irradiance, or intensity

float is_lit(vec3 texel_depth, int view) {
  return texelFetch(shadow_depth, ivec3(ivec2(texel_depth.xy), view), 0).r >= texel_depth.z ? 1.0
                                                                                           : 0.0;
}

// Seen by the light: 0 to 1, bilinear over four texels. The point is moved off the surface.
float visibility(vec3 position, vec3 normal) {
  float far = lamp_is_near != 0 ? distance(position, lamp) : 0.0;
  for (int view = 0; view < SHADOW_VIEWS; ++view) {
    float texel = shadow_texel[view].x + shadow_texel[view].y * far;
    vec4 clip = shadow_view[view] * vec4(position + 1.5 * texel * normal, 1.0);
    if (clip.w <= 0.0) continue;
    vec3 device = clip.xyz / clip.w;
    if (any(greaterThan(abs(device.xy), vec2(1.0)))) continue;
    vec2 size = vec2(textureSize(shadow_depth, 0).xy);
    vec2 at = (0.5 + 0.5 * device.xy) * size - 0.5, first = floor(at), part = at - first;
    float depth = 0.5 + 0.5 * device.z;
    vec2 low = clamp(first, vec2(0.0), size - 1.0), high = clamp(first + 1.0, vec2(0.0), size - 1.0);
    return mix(mix(is_lit(vec3(low, depth), view), is_lit(vec3(high.x, low.y, depth), view), part.x),
               mix(is_lit(vec3(low.x, high.y, depth), view), is_lit(vec3(high, depth), view), part.x),
               part.y);
  }
  return 1.0;
}

// Direction towards the light, and the irradiance of a surface that faces it.
vec3 lamp_direction(vec3 position) {
  return lamp_is_near != 0 ? normalize(lamp - position) : lamp;
}
vec3 lamp_irradiance(vec3 position) {
  vec3 d = lamp - position;
  return lamp_is_near != 0 ? lamp_power / max(dot(d, d), 1e-12) : lamp_power;
}

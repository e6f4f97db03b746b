// Radiance of places from precomputed transport: Eq. 9 (SINGLE 0) or 14 (SINGLE 1) of homogeneous
// editing 2007, without F_t. Three layers hold four colours: four functions of multiple scattering,
// or the four components of a function of single scattering.
uniform sampler2DArray transport;
uniform vec4 weights[LAYERS];
#if SINGLE
uniform sampler2D positions;
uniform sampler2D normals;
uniform vec3 eye;
uniform float eta;
uniform vec3 three_g;
#endif
layout(location = 0) out vec4 exitance;

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  vec4 a = vec4(0.0), b = vec4(0.0), c = vec4(0.0);
  for (int i = 0; i < LAYERS; i += 3) {
    a += weights[i] * texelFetch(transport, ivec3(place, i), 0);
    b += weights[i + 1] * texelFetch(transport, ivec3(place, i + 1), 0);
    c += weights[i + 2] * texelFetch(transport, ivec3(place, i + 2), 0);
  }
  vec3 color0 = a.xyz, color1 = vec3(a.w, b.xy), color2 = vec3(b.zw, c.x), color3 = c.yzw;
#if SINGLE
  // The direction towards the eye, refracted: its part along the surface shrinks by eta.
  vec3 n = texelFetch(normals, place, 0).xyz;
  vec3 w = normalize(eye - texelFetch(positions, place, 0).xyz);
  vec3 along = (w - n * dot(n, w)) / eta;
  vec3 o = along + n * sqrt(max(1.0 - dot(along, along), 0.0));
  exitance = vec4(color0 - three_g * (o.x * color1 + o.y * color2 + o.z * color3), 1.0);
#else
  exitance = vec4(color0 + color1 + color2 + color3, 1.0);
#endif
}

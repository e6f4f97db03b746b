// What a level's texels stand for: position and normal (packed; 0: nothing) of pixel A or B of
// their block.
#ifndef FULL
uniform usampler2D representatives;
#endif
uniform sampler2D positions;
uniform sampler2D normals;
uniform int layer;        // 0: A, 1: B
uniform float apart;      // B counts where it is farther than this from A, times its depth
layout(location = 0) out vec4 out_position;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
#ifdef FULL
  bool is_used = layer == 0 && texelFetch(positions, pixel, 0).w > 0.0;
#else
  uvec4 both = texelFetch(representatives, pixel, 0);
  pixel = ivec2(layer == 0 ? both.xy : both.zw);
  bool is_used = pixel.x != 65535;
  if (is_used && layer == 1) {
    vec3 a = texelFetch(positions, ivec2(both.xy), 0).xyz;
    vec3 b = texelFetch(positions, pixel, 0).xyz;
    is_used = distance(a, b) > apart * to_view(b).z;
  }
#endif
  out_position = vec4(0.0);
  gl_FragDepth = 0.0;
  if (!is_used) return;
  out_position = vec4(texelFetch(positions, pixel, 0).xyz,
                      pack_facing(texelFetch(normals, pixel, 0).xyz));
  gl_FragDepth = 0.5 + 0.5 * device_depth(to_view(out_position.xyz).z);
}

// Camera pyramid: for each block of pixels two that stand for what is seen in it, A in its middle or
// near it and B the farthest from A in space, so that a block across a silhouette has both surfaces.
#ifndef FIRST
uniform usampler2D finer;
#endif
uniform sampler2D positions;
uniform int block;  // pixels of a side
layout(location = 0) out uvec4 representatives;  // A.xy, B.xy; none: 65535

const uint none = 65535u;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  ivec2 middle = block * texel + block / 2;
  uvec2 candidates[8];
  int count = 0;
  for (int i = 0; i < 4; ++i) {
    ivec2 child = 2 * texel + ivec2(i & 1, i >> 1);
#ifdef FIRST
    ivec2 size = textureSize(positions, 0);
    if (child.x < size.x && child.y < size.y && texelFetch(positions, child, 0).w > 0.0)
      candidates[count++] = uvec2(child);
#else
    ivec2 size = textureSize(finer, 0);
    if (child.x >= size.x || child.y >= size.y) continue;
    uvec4 both = texelFetch(finer, child, 0);
    if (both.x != none) candidates[count++] = both.xy;
    if (both.z != none) candidates[count++] = both.zw;
#endif
  }
  representatives = uvec4(none);
  if (count == 0) return;
  uvec2 nearest = candidates[0];
  float least = 1e30;
  if (all(lessThan(middle, textureSize(positions, 0))) &&
      texelFetch(positions, middle, 0).w > 0.0) {
    nearest = uvec2(middle);
    least = 0.0;
  }
  for (int i = 0; i < count; ++i) {
    vec2 d = vec2(ivec2(candidates[i]) - middle);
    if (dot(d, d) < least) {
      least = dot(d, d);
      nearest = candidates[i];
    }
  }
  representatives.xy = nearest;
  vec3 a = texelFetch(positions, ivec2(nearest), 0).xyz;
  float most = 0.0;
  for (int i = 0; i < count; ++i) {
    float apart = distance(a, texelFetch(positions, ivec2(candidates[i]), 0).xyz);
    if (apart > most) {
      most = apart;
      representatives.zw = candidates[i];
    }
  }
}

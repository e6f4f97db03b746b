// The farthest depth seen in each tile of TILE x TILE texels of a level; 0 where nothing is. Splats
// that begin beyond it in all tiles that they touch are not drawn.
uniform sampler2D depth;
layout(location = 0) out vec4 farthest;

void main() {
  ivec2 first = TILE * ivec2(gl_FragCoord.xy);
  ivec2 end = min(first + TILE, textureSize(depth, 0));
  float most = 0.0;
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) most = max(most, texelFetch(depth, ivec2(x, y), 0).r);
  farthest = vec4(most, 0.0, 0.0, 0.0);
}

// Profiles of the samples: exp(h) at every node, once per edit. Node by node below each other, each
// `row_lines` lines high; the one after the last is 1.
uniform sampler2D sample_places;
uniform int row_lines;
layout(location = 0) out vec4 value;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int node = texel.y / row_lines;
  value = vec4(1.0);
  if (node >= NODES) return;
  vec2 place = texelFetch(sample_places, ivec2(texel.x, texel.y % row_lines), 0).xy;
  Corners corners = find_corners(place);
  value.rgb = exp(half_log_at(corners, ivec2(node), 0.0) + cut_log(mix_corners(corners, material_support), node));
}

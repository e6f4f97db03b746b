// Profiles of the samples, once per edit: exp(h) at every node, node by node below each other, each
// `row_lines` lines high; then 1; then the root of the near term's integral.
uniform sampler2D sample_places;
uniform int row_lines;
uniform int first_node;
layout(location = 0) out vec4 value;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int node = first_node + texel.y / row_lines;
  value = vec4(1.0);
  if (node == NODES) return;
  vec2 place = texelFetch(sample_places, ivec2(texel.x, texel.y % row_lines), 0).xy;
  Corners corners = find_corners(place);
  if (node > NODES) {
    value.rgb = exp(0.5 * mix_corners(corners, near_integral));
    return;
  }
  vec3 support = mix_corners(corners, material_support);
  value.rgb = exp(half_log_at(corners, ivec2(node), 0.0) + cut_log(support, node));
}

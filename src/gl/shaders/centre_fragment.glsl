// Where a group stands: the mean of its members' positions by their moments at one node.
uniform sampler2D member_rows;
uniform sampler2D member_positions;
#ifdef SINGLE
uniform sampler2D member_flux;
#endif
uniform int member_count;
uniform int member_lines;
uniform int node;
layout(location = 0) out vec4 centre;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int width = textureSize(member_rows, 0).x;
  int first = 4 * (texel.y * width + texel.x);
  vec4 sum = vec4(0.0);
  for (int i = first; i < min(first + 4, member_count); ++i) {
    ivec2 member = source_texel(i, width);
    vec3 value = texelFetch(member_rows, ivec2(member.x, member.y + node * member_lines), 0).rgb;
#ifdef SINGLE
    value *= texelFetch(member_flux, member, 0).rgb;
#endif
    float weight = value.r + value.g + value.b + 1e-25;
    sum += weight * vec4(texelFetch(member_positions, member, 0).xyz, 1.0);
  }
  centre = sum.w > 0.0 ? vec4(sum.xyz / sum.w, 1.0) : vec4(0.0);
}

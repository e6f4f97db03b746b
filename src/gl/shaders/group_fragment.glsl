// Moments of a group: the sums of its four members', flux times exp(h) at every node. At one radius
// the product of profiles has rank one, so nothing but the spread of the members is lost.
uniform sampler2D member_rows;
#ifdef SINGLE
uniform sampler2D member_flux;
#endif
uniform int member_count;
uniform int member_lines;
uniform int group_lines;
layout(location = 0) out vec4 sum;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  int width = textureSize(member_rows, 0).x;
  int node = texel.y / group_lines;
  int first = 4 * ((texel.y % group_lines) * width + texel.x);
  sum = vec4(0.0);
  for (int i = first; i < min(first + 4, member_count); ++i) {
    ivec2 member = source_texel(i, width);
    vec3 value = texelFetch(member_rows, ivec2(member.x, member.y + node * member_lines), 0).rgb;
#ifdef SINGLE
    value *= texelFetch(member_flux, member, 0).rgb;
#endif
    sum.rgb += value;
  }
}

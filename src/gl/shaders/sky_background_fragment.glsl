// The environment behind the object.
uniform sampler2D positions;
uniform float exposure;
layout(location = 0) out vec4 radiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (texelFetch(positions, pixel, 0).w > 0.0) discard;
  vec2 at = 2.0 * gl_FragCoord.xy / vec2(textureSize(positions, 0)) - 1.0;
  vec3 direction = normalize(camera_forward + camera_right * (at.x * camera_half.x) -
                             camera_up * (at.y * camera_half.y));
  radiance = vec4(exposure * sky_scale * textureLod(sky, sky_place(direction), 0.0).rgb, 0.0);
}

// An environment as a latitude-longitude picture (scene/scene.h).
uniform sampler2D sky;
uniform float sky_turn;  // turns about +y
uniform vec3 sky_scale;

vec2 sky_place(vec3 direction) {
  return vec2(0.5 + atan(direction.x, -direction.z) / 6.28318531 + sky_turn,
              atan(length(direction.xz), direction.y) / 3.14159265);
}

// The pinhole camera of scene/camera.h. Row 0 of a target is the top row of the picture: y is
// turned around here.
uniform vec3 camera_position;
uniform vec3 camera_right;
uniform vec3 camera_up;
uniform vec3 camera_forward;
uniform vec2 camera_half;   // half its extent at distance 1
uniform vec2 camera_range;  // nearest and farthest depth, mm

// x to the right, y down, z = depth, in mm.
vec3 to_view(vec3 position) {
  vec3 d = position - camera_position;
  return vec3(dot(d, camera_right), -dot(d, camera_up), dot(d, camera_forward));
}

// Depth along the view as a device coordinate in [-1, 1].
float device_depth(float z) {
  float n = camera_range.x, f = camera_range.y;
  return ((f + n) - 2.0 * f * n / z) / (f - n);
}

vec4 project(vec3 position) {
  vec3 v = to_view(position);
  float n = camera_range.x, f = camera_range.y;
  return vec4(v.x / camera_half.x, v.y / camera_half.y, ((f + n) * v.z - 2.0 * f * n) / (f - n),
              v.z);
}

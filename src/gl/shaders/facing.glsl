// Normals of what is seen, on the camera's axes (x right, y down, z towards it): as points of a
// paraboloid, p = n.xy / (1 + n.z), which reach to 113 degrees off the axis; as one float of two
// times 12 bits, at least 1.
const float facing_steps = 4094.0;
const float facing_width = 3.0;  // of p

vec3 to_camera_axes(vec3 n) {
  return vec3(dot(n, camera_right), -dot(n, camera_up), -dot(n, camera_forward));
}

float pack_facing(vec3 normal) {
  vec3 n = to_camera_axes(normal);
  vec2 p = n.xy / max(1.0 + n.z, 1e-3);
  vec2 steps = floor(facing_steps * clamp(p / facing_width + 0.5, 0.0, 1.0) + 0.5);
  return 1.0 + steps.x + steps.y / 4096.0;
}

vec2 unpack_facing(float facing) {
  float x = floor(facing);
  vec2 scale = vec2(1.0, 4096.0) * (facing_width / facing_steps);
  return vec2(x, facing - x) * scale - vec2(scale.x + 0.5 * facing_width, 0.5 * facing_width);
}

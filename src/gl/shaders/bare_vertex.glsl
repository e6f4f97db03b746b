// A square of `side` pixels at a pseudo-random place, for measuring.
uniform ivec2 target_size;
uniform float side;

float hash(uint x) {
  x = (x ^ 61u) ^ (x >> 16u);
  x *= 9u;
  x ^= x >> 4u;
  x *= 0x27d4eb2du;
  return float((x ^ (x >> 15u)) >> 8u) / 16777216.0;
}

void main() {
  uint id = uint(gl_InstanceID);
  vec2 corner = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) * side;
  vec2 first = vec2(hash(2u * id), hash(2u * id + 1u)) * (vec2(target_size) - side);
  gl_Position = vec4((first + corner) / vec2(target_size) * 2.0 - 1.0, 0.0, 1.0);
}

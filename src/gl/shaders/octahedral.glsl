// Unit vectors as points of a square; as one float of two times 12 bits, at least 1.
vec2 encode_octahedral(vec3 n) {
  vec2 e = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  return n.z >= 0.0 ? e : (1.0 - abs(e.yx)) * vec2(e.x < 0.0 ? -1.0 : 1.0, e.y < 0.0 ? -1.0 : 1.0);
}

vec3 decode_octahedral(vec2 e) {
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(e.x < 0.0 ? -1.0 : 1.0, e.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}

float pack_normal(vec3 n) {
  vec2 steps = floor(2047.5 * (encode_octahedral(n) + 1.0) + 0.5);
  return 1.0 + steps.x + 4096.0 * steps.y;
}

// Not of unit length, as only its direction counts.
vec3 unpack_direction(float packed_normal) {
  float y = floor((packed_normal - 1.0) * (1.0 / 4096.0));
  vec2 e = vec2(packed_normal - 1.0 - 4096.0 * y, y) * (2.0 / 4095.0) - 1.0;
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float back = max(-n.z, 0.0);
  n.xy -= back * vec2(e.x < 0.0 ? -1.0 : 1.0, e.y < 0.0 ? -1.0 : 1.0);
  return n;
}

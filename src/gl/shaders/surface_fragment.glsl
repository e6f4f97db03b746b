// The camera's geometry buffer: what every pixel sees.
in vec3 surface_position;
in vec3 surface_normal;
in vec2 surface_texcoord;
layout(location = 0) out vec4 out_position;  // mm; 1 where the mesh is
layout(location = 1) out vec4 out_normal;    // unit, outward; cosine to the viewer
layout(location = 2) out vec4 out_place;     // in the sample, pixels

const float least_cosine = 0.1;

// Interpolated normals may turn away at a silhouette: their cosine to the viewer is at least
// least_cosine, or the triangle's own.
float seen_cosine(vec3 normal) {
  vec3 view = normalize(camera_position - surface_position);
  vec3 face = normalize(cross(dFdx(surface_position), dFdy(surface_position)));
  float side = dot(face, view) * dot(face, normal) < 0.0 ? -1.0 : 1.0;
  float wanted = clamp(abs(dot(face, view)), 1e-4, least_cosine);
  return max(side * dot(normal, view), wanted);
}

void main() {
  vec3 normal = normalize(surface_normal);
  out_position = vec4(surface_position, 1.0);
  out_normal = vec4(normal, seen_cosine(normal));
  out_place = vec4(map_to_sample(surface_position, normal, surface_texcoord), 0.0, 0.0);
}

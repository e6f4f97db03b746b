// The camera's geometry buffer: what every pixel sees.
in vec3 surface_position;
in vec3 surface_normal;
in vec2 surface_texcoord;
layout(location = 0) out vec4 out_position;  // mm; 1 where the mesh is
layout(location = 1) out vec4 out_normal;    // unit, outward; cosine to the viewer
layout(location = 2) out vec4 out_place;     // in the sample, pixels; the triangle's normal

const float least_cosine = 0.1;

void main() {
  vec3 normal = normalize(surface_normal);
  vec3 view = normalize(camera_position - surface_position);
  vec3 face = normalize(cross(dFdx(surface_position), dFdy(surface_position)));
  if (dot(face, view) < 0.0) face = -face;
  // Interpolated normals may turn away at a silhouette: their cosine to the viewer is at least
  // least_cosine, or the triangle's own.
  float side = dot(face, normal) < 0.0 ? -1.0 : 1.0;
  float wanted = clamp(dot(face, view), 1e-4, least_cosine);
  out_position = vec4(surface_position, 1.0);
  out_normal = vec4(normal, max(side * dot(normal, view), wanted));
  out_place =
      vec4(map_to_sample(surface_position, normal, surface_texcoord), encode_octahedral(face));
}

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texcoord;
out vec3 surface_position;
out vec3 surface_normal;
out vec2 surface_texcoord;

void main() {
  surface_position = position;
  surface_normal = normal;
  surface_texcoord = texcoord;
  gl_Position = project(position);
}

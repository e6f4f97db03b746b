// Exitance of vertices, interpolated over triangles.
layout(location = 0) in vec3 position;
layout(location = 3) in uint vertex;
uniform sampler2D place_exitance;
out vec3 vertex_exitance;

void main() {
  uint row = uint(textureSize(place_exitance, 0).x);
  vertex_exitance = texelFetch(place_exitance, ivec2(vertex % row, vertex / row), 0).rgb;
  gl_Position = project(position);
}

// Exitance of vertices, interpolated over triangles.
layout(location = 0) in vec3 position;
uniform sampler2D place_exitance;
out vec3 vertex_exitance;

void main() {
  int row = textureSize(place_exitance, 0).x;
  vertex_exitance =
      texelFetch(place_exitance, ivec2(gl_VertexID % row, gl_VertexID / row), 0).rgb;
  gl_Position = project(position);
}

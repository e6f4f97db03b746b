in vec3 vertex_exitance;
layout(location = 0) out vec4 exitance;

void main() {
  exitance = vec4(vertex_exitance, 1.0);
}

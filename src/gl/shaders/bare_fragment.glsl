layout(location = 0) out vec4 value;
void main() { value = vec4(1.0 / 1024.0); }

// Small mesh files for tests and the fuzzer. Internal to this folder and to them.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace parian::mesh_testing {

inline void append_word(std::string& bytes, std::uint32_t word, int size = 4) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xffu);
}
inline void append_float(std::string& bytes, float value) {
  append_word(bytes, std::bit_cast<std::uint32_t>(value));
}

// A tetrahedron of volume 1 / 6, faces outward.
inline constexpr std::array<std::array<float, 3>, 4> corners{
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
inline constexpr std::array<std::array<std::uint32_t, 3>, 4> faces{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

inline std::string make_ascii_ply() {
  return "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\n"
         "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "property float s\nproperty float t\n"
         "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0 9 0 0\n1 0 0 9 1 0\n0 1 0 9 0 1\n0 0 1 9 0.25 0.75\n"
         "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
}

inline std::string make_obj() {
  return "# by hand\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
         "vt 0 0\nvt 1 0\nvt 0 1\nvt 0.25 0.75\n"
         "f 1/1 3/3 2/2\nf 1/1 2/2 4/4\nf 2/2 3/3 4/4\nf 1/1 4/4 3/3\n";
}

inline std::string make_stl() {
  std::string bytes(80, '\0');
  append_word(bytes, 4);
  for (const auto& face : faces) {
    for (const float value : {0.0f, 0.0f, 1.0f}) append_float(bytes, value);
    for (const std::uint32_t v : face)
      for (const float value : corners[v]) append_float(bytes, value);
    append_word(bytes, 0, 2);
  }
  return bytes;
}

inline std::string make_gltf_buffer() {
  std::string buffer;
  for (const auto& corner : corners)
    for (const float value : corner) append_float(buffer, value);
  for (const auto& corner : corners)
    for (const float value : {corner[0], 1 - corner[1]}) append_float(buffer, value);
  for (const auto& face : faces)
    for (const std::uint32_t v : face) append_word(buffer, v, 2);
  return buffer;  // 48 + 32 + 24 bytes
}

// A node that doubles the size with one, mirrored, below it. `uri`: where the buffer is.
inline std::string make_gltf_json(std::string_view uri = "") {
  return std::string(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"scale": [2, 2, 2], "mesh": 0, "children": [1]},
 {"translation": [-1, 0, 0], "scale": [-1, 1, 1], "mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2}]}],
"buffers": [{)") +
         (uri.empty() ? "" : "\"uri\": \"" + std::string(uri) + "\", ") + R"("byteLength": 104}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
 {"buffer": 0, "byteOffset": 48, "byteLength": 32},
 {"buffer": 0, "byteOffset": 80, "byteLength": 24}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
 "min": [0, 0, 0], "max": [1, 1, 1]},
 {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
 {"bufferView": 2, "componentType": 5123, "count": 12, "type": "SCALAR"}]})";
}

inline std::string make_glb() {
  std::string json = make_gltf_json();
  while (json.size() % 4 != 0) json += ' ';
  const std::string buffer = make_gltf_buffer();
  std::string bytes = "glTF";
  append_word(bytes, 2);
  append_word(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append_word(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append_word(bytes, static_cast<std::uint32_t>(buffer.size()));
  bytes += std::string("BIN\0", 4) + buffer;
  return bytes;
}

}  // namespace parian::mesh_testing

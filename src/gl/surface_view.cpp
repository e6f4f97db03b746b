#include "gl/surface_view.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace parian {
namespace {

template <typename T>
std::uint32_t fill_buffer(GLenum target, const std::vector<T>& values) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(target, name);
  glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(),
               GL_STATIC_DRAW);
  return name;
}

}  // namespace

MeshBuffers make_mesh_buffers(const TriangleMesh& mesh) {
  MeshBuffers buffers;
  buffers.box = bounds(mesh);
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  buffers.vertex_array = GlHandle<destroy_vertex_array>(name);
  glBindVertexArray(name);
  constexpr std::size_t stride = 8;
  std::vector<float> vertices(stride * mesh.positions.size(), 0.0f);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = mesh.positions[v], n = mesh.normals[v];
    const Vec2 t = mesh.texcoords.empty() ? Vec2{} : mesh.texcoords[v];
    const float values[stride] = {p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y};
    std::copy_n(values, stride, &vertices[stride * v]);
  }
  buffers.vertices = GlHandle<destroy_buffer>(fill_buffer(GL_ARRAY_BUFFER, vertices));
  const GLint sizes[3] = {3, 3, 2};
  const char* offset = nullptr;  // into the buffer, as OpenGL wants it
  for (GLuint i = 0; i < 3; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, sizes[i], GL_FLOAT, GL_FALSE, stride * sizeof(float), offset);
    offset += static_cast<std::size_t>(sizes[i]) * sizeof(float);
  }
  buffers.indices = GlHandle<destroy_buffer>(fill_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.triangles));
  buffers.index_count = static_cast<int>(3 * mesh.triangles.size());
  glBindVertexArray(0);
  check_gl("mesh");
  return buffers;
}

void draw_mesh(const MeshBuffers& mesh) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glBindVertexArray(mesh.vertex_array.get());
  glDrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
}

SplatCamera make_splat_camera(const Camera& camera, int antialias, const Bounds3& box) {
  Camera larger = camera;
  larger.width *= antialias;
  larger.height *= antialias;
  SplatCamera result;
  result.frame = make_camera_frame(larger);
  const auto depth = [&](Vec3 p) { return dot(p - result.frame.position, result.frame.forward); };
  float least = std::numeric_limits<float>::infinity(), most = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const float z =
        depth({(i & 1u) != 0 ? box.upper.x : box.lower.x, (i & 2u) != 0 ? box.upper.y : box.lower.y,
               (i & 4u) != 0 ? box.upper.z : box.lower.z});
    least = std::min(least, z);
    most = std::max(most, z);
  }
  result.far_mm = std::max(1.01f * most, 1e-3f * diagonal(box));
  result.near_mm = std::max(0.99f * least, 1e-4f * result.far_mm);
  result.middle_mm = std::max(depth(center(box)), 0.7f * most);
  return result;
}

void set_camera(const Program& program, const SplatCamera& camera) {
  const CameraFrame& frame = camera.frame;
  set_uniform(program, "camera_position", frame.position);
  set_uniform(program, "camera_right", frame.right);
  set_uniform(program, "camera_up", frame.up);
  set_uniform(program, "camera_forward", frame.forward);
  set_uniform(program, "camera_half",
              Vec2{static_cast<float>(frame.half_width), static_cast<float>(frame.half_height)});
  set_uniform(program, "camera_range", Vec2{camera.near_mm, camera.far_mm});
}

void set_mapping(const Program& program, const Mapping& mapping, const SampleGrid& grid) {
  const double size =
      mapping.uv_size_mm > 0 ? mapping.uv_size_mm : grid.width * grid.pixel_pitch_mm;
  const double angle = mapping.rotation_deg * std::numbers::pi / 180;
  set_uniform(program, "mapping_is_box", mapping.kind == MappingKind::box ? 1 : 0);
  set_uniform(program, "mapping_uv_size", static_cast<float>(size));
  set_uniform(program, "mapping_scale", static_cast<float>(mapping.scale));
  set_uniform(program, "mapping_turn",
              Vec2{static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))});
  set_uniform(program, "mapping_offset", mapping.offset_mm);
  set_uniform(program, "mapping_grid",
              Vec2{static_cast<float>(grid.width), static_cast<float>(grid.height)});
  set_uniform(program, "mapping_pitch", static_cast<float>(grid.pixel_pitch_mm));
}

GeometryBuffer make_geometry_buffer(int width, int height) {
  GeometryBuffer buffer;
  for (Texture* texture : {&buffer.positions, &buffer.normals, &buffer.places})
    *texture = make_texture(TexelFormat::rgba32f, width, height, "geometry buffer");
  buffer.depth = make_texture(TexelFormat::depth32f, width, height, "geometry buffer");
  buffer.framebuffer = make_framebuffer({{&buffer.positions}, {&buffer.normals}, {&buffer.places}},
                                        "geometry buffer", {&buffer.depth});
  return buffer;
}

void draw_geometry(const GeometryBuffer& buffer, const Program& program, const MeshBuffers& mesh,
                   const SplatCamera& camera, const Mapping& mapping, const SampleGrid& grid) {
  bind(buffer.framebuffer);
  set_additive_blending(false);
  for (int i = 0; i < 3; ++i) clear_color(i);
  clear_depth(1);
  use(program);
  set_camera(program, camera);
  set_mapping(program, mapping, grid);
  draw_mesh(mesh);
  check_gl("geometry buffer");
}

Program make_geometry_program() {
  return make_program({"camera.glsl", "surface_vertex.glsl"},
                      {"camera.glsl", "mapping.glsl", "octahedral.glsl", "surface_fragment.glsl"});
}

}  // namespace parian

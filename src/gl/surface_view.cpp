#include "gl/surface_view.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/closed.h"
#include "mesh/surface_samples.h"

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

// The mesh as devices draw it fastest, who keep some of the vertices that they have just worked
// out: triangles in patches, vertices in the order in which those name them.
struct DrawOrder {
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of new vertices
  std::vector<std::uint32_t> vertices;                  // the mesh's, of each new one
};

DrawOrder make_draw_order(const TriangleMesh& mesh) {
  constexpr std::uint32_t none = 0xffffffff;
  DrawOrder order;
  order.triangles.reserve(mesh.triangles.size());
  order.vertices.reserve(mesh.positions.size());
  std::vector<std::uint32_t> renamed(mesh.positions.size(), none);
  for (const std::uint32_t triangle : order_triangles(mesh)) {
    order.triangles.push_back(mesh.triangles[triangle]);
    for (std::uint32_t& vertex : order.triangles.back()) {
      std::uint32_t& name = renamed[vertex];
      if (name == none) {
        name = static_cast<std::uint32_t>(order.vertices.size());
        order.vertices.push_back(vertex);
      }
      vertex = name;
    }
  }
  return order;
}

bool contains(const Bounds3& box, Vec3 p) {
  return min(box.lower, p) == box.lower && max(box.upper, p) == box.upper;
}

struct DeviceVertex {
  Vec3 position, normal;
  Vec2 texcoord;
  std::uint32_t index = 0;  // in the mesh
};

std::vector<DeviceVertex> make_vertices(const TriangleMesh& mesh, const DrawOrder& order) {
  std::vector<DeviceVertex> vertices;
  vertices.reserve(order.vertices.size());
  for (const std::uint32_t v : order.vertices)
    vertices.push_back({mesh.positions[v], mesh.normals[v],
                        mesh.texcoords.empty() ? Vec2{} : mesh.texcoords[v], v});
  return vertices;
}

}  // namespace

MeshBuffers make_mesh_buffers(const TriangleMesh& mesh) {
  MeshBuffers buffers;
  buffers.box = bounds(mesh);
  buffers.is_watertight = is_watertight(mesh);
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  buffers.vertex_array = GlHandle<destroy_vertex_array>(name);
  glBindVertexArray(name);
  const DrawOrder order = make_draw_order(mesh);
  buffers.vertices =
      GlHandle<destroy_buffer>(fill_buffer(GL_ARRAY_BUFFER, make_vertices(mesh, order)));
  const GLint sizes[3] = {3, 3, 2};
  const char* offset = nullptr;  // into the buffer, as OpenGL wants it
  for (GLuint i = 0; i < 3; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, sizes[i], GL_FLOAT, GL_FALSE, sizeof(DeviceVertex), offset);
    offset += static_cast<std::size_t>(sizes[i]) * sizeof(float);
  }
  glEnableVertexAttribArray(3);
  glVertexAttribIPointer(3, 1, GL_UNSIGNED_INT, sizeof(DeviceVertex), offset);
  buffers.indices = GlHandle<destroy_buffer>(fill_buffer(GL_ELEMENT_ARRAY_BUFFER, order.triangles));
  buffers.index_count = static_cast<int>(3 * mesh.triangles.size());
  glBindVertexArray(0);
  check_gl("mesh");
  return buffers;
}

void draw_mesh(const MeshBuffers& mesh, std::optional<Vec3> eye) {
  const bool is_one_sided = mesh.is_watertight && !(eye && contains(mesh.box, *eye));
  if (is_one_sided) {
    glEnable(GL_CULL_FACE);
    glFrontFace(GL_CW);
    glCullFace(GL_BACK);
  }
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glBindVertexArray(mesh.vertex_array.get());
  glDrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
  glDisable(GL_CULL_FACE);
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
  draw_mesh(mesh, camera.frame.position);
  check_gl("geometry buffer");
}

Program make_geometry_program() {
  return make_program({"camera.glsl", "surface_vertex.glsl"},
                      {"camera.glsl", "mapping.glsl", "octahedral.glsl", "surface_fragment.glsl"});
}

}  // namespace parian

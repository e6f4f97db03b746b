#include "gl/surface_view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "gl/context.h"
#include "mesh/shapes.h"
#include "scene/camera.h"

namespace parian {
namespace {

constexpr int width = 120, height = 90;

Camera look_from(Vec3 position, const TriangleMesh& mesh) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.position = position;
  camera.target = center(bounds(mesh));
  camera.fov_deg = 60;
  return camera;
}

// Positions, and 1 where the mesh is.
std::vector<float> draw(const TriangleMesh& mesh, const Camera& camera) {
  const Program program = make_geometry_program();
  const MeshBuffers buffers = make_mesh_buffers(mesh);
  const GeometryBuffer target = make_geometry_buffer(width, height);
  draw_geometry(target, program, buffers, make_splat_camera(camera, 1, buffers.box), {}, {1, 1, 1});
  return read_pixels(target.framebuffer);
}

std::size_t count_covered(const std::vector<float>& pixels) {
  std::size_t count = 0;
  for (std::size_t i = 3; i < pixels.size(); i += 4) count += pixels[i] > 0 ? 1 : 0;
  return count;
}

// A hole on the far side, which none of these views sees, and all faces are drawn.
TEST(SurfaceView, OfAWatertightMeshIsThatOfAllItsFaces) {
  const OffscreenContext context;
  for (const TriangleMesh& mesh : {make_sphere(4), make_knot(2), make_fin(1)}) {
    const Camera camera = look_from(Vec3{0.3f, 0.5f, 3} * diagonal(bounds(mesh)), mesh);
    const std::vector<float> whole = draw(mesh, camera);
    TriangleMesh open = mesh;
    const auto farthest = std::min_element(open.triangles.begin(), open.triangles.end(),
                                           [&](const auto& a, const auto& b) {
                                             return mesh.positions[a[0]].z < mesh.positions[b[0]].z;
                                           });
    open.triangles.erase(farthest);
    EXPECT_TRUE(make_mesh_buffers(mesh).is_watertight);
    EXPECT_FALSE(make_mesh_buffers(open).is_watertight);
    EXPECT_EQ(whole, draw(open, camera));
    EXPECT_GT(count_covered(whole), 100u);
  }
}

TEST(SurfaceView, InsidesAreSeenFromWithinAndThroughHoles) {
  const OffscreenContext context;
  TriangleMesh mesh = make_sphere(4);
  EXPECT_EQ(count_covered(draw(mesh, look_from({0.2f, 0.1f, 0.3f}, mesh))), width * height);
  // Half of it, from its open side: as many pixels as the whole has.
  const Camera camera = look_from({0, 0, 4}, mesh);
  const std::size_t whole = count_covered(draw(mesh, camera));
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return mesh.positions[t[0]].z + mesh.positions[t[1]].z + mesh.positions[t[2]].z > 0.6f;
  });
  EXPECT_NEAR(static_cast<double>(count_covered(draw(mesh, camera))), static_cast<double>(whole),
              0.05 * static_cast<double>(whole));
}

}  // namespace
}  // namespace parian

// What the camera sees: the mesh drawn into a geometry buffer.
#pragma once

#include <optional>

#include "gl/objects.h"
#include "mesh/mesh.h"
#include "scene/camera.h"
#include "scene/mapping.h"

namespace parian {

// In an order of its own; attribute 3 of the vertices is their index in the mesh.
struct MeshBuffers {
  GlHandle<destroy_vertex_array> vertex_array;
  GlHandle<destroy_buffer> vertices, indices;
  int index_count = 0;
  Bounds3 box;
  bool is_watertight = false;
};
// Of a mesh with normals.
MeshBuffers make_mesh_buffers(const TriangleMesh& mesh);
// Front to back by the depth test, seen from `eye`, or from infinity. Faces that look away are left
// out where the mesh is watertight and the eye is outside its box, as others hide them. Views
// mirror: what is counter-clockwise from outside is clockwise on the target.
void draw_mesh(const MeshBuffers& mesh, std::optional<Vec3> eye);

// Camera with the depths between which the mesh lies.
struct SplatCamera {
  CameraFrame frame;
  float near_mm = 0;
  float far_mm = 1;
  float middle_mm = 1;  // depth of the box's centre, or most of the way to its end from within
};
SplatCamera make_splat_camera(const Camera& camera, int antialias, const Bounds3& box);
void set_camera(const Program& program, const SplatCamera& camera);
void set_mapping(const Program& program, const Mapping& mapping, const SampleGrid& grid);

struct GeometryBuffer {
  Texture positions, normals, places, depth;
  Framebuffer framebuffer;
};
GeometryBuffer make_geometry_buffer(int width, int height);
void draw_geometry(const GeometryBuffer& buffer, const Program& program, const MeshBuffers& mesh,
                   const SplatCamera& camera, const Mapping& mapping, const SampleGrid& grid);
Program make_geometry_program();

}  // namespace parian

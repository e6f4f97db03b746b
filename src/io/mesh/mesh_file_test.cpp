#include "io/mesh/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/test_errors.h"
#include "io/json/files.h"
#include "io/json/test_folder.h"
#include "io/mesh/test_files_internal.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

using namespace mesh_testing;
using testing::HasSubstr;
using testing::StartsWith;

struct MeshFile : testing::Test, TestFolder {
  MeshFile() : TestFolder("mesh") {}
  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(at(name), std::ios::binary) << bytes;
    return at(name);
  }
  // The message of what loading throws, without the path before it.
  std::string error_of(const std::string& name, const std::string& bytes) const {
    return error_of(put(name, bytes));
  }
  static std::string error_of(const std::string& path) {
    std::string text = parian::error_of([&] { load_mesh(path); });
    if (text == "no error") return text;
    EXPECT_THAT(text, StartsWith(path + ": "));
    return text.substr(std::min(text.size(), path.size() + 2));
  }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

Vec2 texcoord_at(const TriangleMesh& mesh, Vec3 position) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.positions[v] == position) return mesh.texcoords[v];
  ADD_FAILURE() << "no such vertex";
  return {};
}

void expect_tetrahedron(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(enclosed_volume(mesh), 1 / 6.0, 1e-6);
  for (std::size_t v = 0; v < 4; ++v)  // outward from the middle
    EXPECT_GT(dot(mesh.normals[v], mesh.positions[v] - Vec3{0.25f, 0.25f, 0.25f}), 0);
}

TEST_F(MeshFile, ReadsEveryKindTheSame) {
  for (const auto& [name, bytes] :
       {std::pair{"a.ply", make_ascii_ply()}, {"a.OBJ", make_obj()}, {"a.stl", make_stl()}}) {
    const TriangleMesh mesh = load_mesh(put(name, bytes));
    expect_tetrahedron(mesh);
    // v = 0 is at the top: the files have t = 0.75 there.
    if (!mesh.texcoords.empty()) {
      EXPECT_EQ(texcoord_at(mesh, {0, 0, 1}), (Vec2{0.25f, 0.25f})) << name;
    }
    EXPECT_EQ(mesh.texcoords.empty(), std::string(name) == "a.stl");
  }
}

TEST_F(MeshFile, GltfNodesArePlacedAndMirrored) {
  put("buffer.bin", make_gltf_buffer());
  for (const std::string& file :
       {put("a.glb", make_glb()), put("a.gltf", make_gltf_json("buffer.bin"))}) {
    MeshReport report;
    const TriangleMesh mesh = load_mesh(file, &report);
    EXPECT_EQ(mesh.triangles.size(), 8u);
    // Twice the size, 8 / 6, and its mirror image beside it, from x = -2 to -4.
    EXPECT_NEAR(enclosed_volume(mesh), 16 / 6.0, 1e-5);
    EXPECT_NEAR(bounds(mesh).lower.x, -4, 1e-6);
    EXPECT_NEAR(bounds(mesh).upper.x, 2, 1e-6);
    EXPECT_EQ(report.flipped_triangles, 0u);
    // glTF has v = 0 at the top itself: 1 - z's 0 in the file.
    EXPECT_NEAR(texcoord_at(mesh, {0, 0, 2}).y, 1, 1e-6);
    EXPECT_NEAR(texcoord_at(mesh, {0, 2, 0}).y, 0, 1e-6);
  }
}

TEST_F(MeshFile, PlyRoundTrips) {
  TriangleMesh mesh = make_fin();
  clean_mesh(mesh, "fin");
  save_mesh(at("fin.ply"), mesh);
  MeshReport report;
  const TriangleMesh read = load_mesh(at("fin.ply"), &report);
  EXPECT_EQ(report.merged_vertices + report.flipped_triangles + report.boundary_edges, 0u);
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_EQ(read.triangles, mesh.triangles);
  ASSERT_EQ(read.normals.size(), mesh.normals.size());
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    EXPECT_LT(distance(read.normals[v], mesh.normals[v]), 1e-6f);
    EXPECT_NEAR(read.texcoords[v].y, mesh.texcoords[v].y, 1e-7);
    EXPECT_EQ(read.texcoords[v].x, mesh.texcoords[v].x);
  }
}

TEST_F(MeshFile, PlyTypesOrdersAndPolygons) {
  // Big-endian, doubles, quads with 16-bit indices, an element of no interest before.
  std::string bytes =
      "ply\r\nformat binary_big_endian 1.0\r\nelement camera 1\r\nproperty list uchar short odd\r\n"
      "element vertex 4\r\nproperty double x\r\nproperty double z\r\nproperty double y\r\n"
      "element face 1\r\nproperty uchar flags\r\nproperty list ushort int16 vertex_index\r\n"
      "end_header\r\n";
  const auto add = [&](std::uint64_t bits, int size) {
    for (int i = size; i-- > 0;) bytes += static_cast<char>(bits >> (8 * i) & 0xffu);
  };
  add(2, 1);
  add(0xffff, 2);
  add(7, 2);
  for (const auto& [x, z] : {std::pair{0.0, 0.0}, {3.0, 0.0}, {3.0, -2.0}, {0.0, -2.0}})
    for (const double value : {x, z, 0.5}) add(std::bit_cast<std::uint64_t>(value), 8);
  add(9, 1);
  add(4, 2);
  for (const std::uint64_t v : {0, 1, 2, 3}) add(v, 2);
  const TriangleMesh mesh = load_mesh(put("q.ply", bytes));
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_NEAR(surface_area(mesh), 6, 1e-6);
  EXPECT_EQ(mesh.normals[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(mesh.positions[2], (Vec3{3, 0.5f, -2}));
}

TEST_F(MeshFile, FilesThatAreNotMeshes) {
  EXPECT_EQ(error_of(at("none.ply")), "expected a readable file, found no such file");
  EXPECT_EQ(error_of(at("a.fbx")),
            "expected a file name that ends in .ply, .obj, .gltf, .glb or .stl, found '.fbx'");
  EXPECT_EQ(
      error_of(at("a")),
      "expected a file name that ends in .ply, .obj, .gltf, .glb or .stl, found no extension");
  EXPECT_EQ(error_of("a.obj", ""), "expected a readable mesh, found an empty file");
  EXPECT_EQ(error_of("a.ply", "solid\n"),
            "line 1: expected a PLY file, which begins with 'ply', found another first line");
  EXPECT_EQ(error_of("a.glb", "not a binary glTF file at all"),
            "expected a binary glTF file, found another beginning");
  EXPECT_THAT(error_of("a.gltf", "{\"asset\": "), HasSubstr("line 1"));
  EXPECT_THAT(error_of("a.stl", "solid"), StartsWith("expected a readable mesh, found "));
}

TEST_F(MeshFile, ContentsThatAreNoSurface) {
  const std::string ply = make_ascii_ply();
  EXPECT_EQ(error_of("v.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
            "expected a mesh with faces, found no faces");
  EXPECT_EQ(error_of("n.ply", replaced(ply, "\n0 1 0 9", "\n0 nan 0 9")),
            "vertex 2: expected coordinates that are finite and below 1e15, found (0, nan, 0)");
  EXPECT_EQ(error_of("h.ply", replaced(ply, "\n0 1 0 9", "\n0 1e99 0 9")),
            "vertex 2: expected coordinates that are finite and below 1e15, found (0, inf, 0)");
  EXPECT_EQ(error_of("i.ply", replaced(ply, "3 1 2 3", "3 1 2 4")),
            "face 2: expected a vertex below 4, found 4");
  EXPECT_EQ(error_of("j.ply", replaced(ply, "3 1 2 3", "3 1 -2 3")),
            "face 2: expected a vertex below 4, found -2");
  EXPECT_EQ(error_of("d.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n"),
            "expected a mesh with faces, found 2 triangles, none of which has an area");
  EXPECT_THAT(error_of("o.obj", "v 0 0 0\nv 1 0 0\nf 1 2 7\n"),
              StartsWith("expected a readable mesh, found "));
}

TEST_F(MeshFile, PlyHeadersAreChecked) {
  const std::string ply = make_ascii_ply();
  EXPECT_EQ(error_of("a.ply", replaced(ply, "ascii", "text")),
            "line 2: expected ascii, binary_little_endian or binary_big_endian, found 'text'");
  EXPECT_EQ(error_of("a.ply", replaced(ply, "float z", "real z")),
            "line 7: expected a PLY type, found 'real'");
  EXPECT_EQ(error_of("a.ply", replaced(ply, "float z", "float w")),
            "vertex 0: expected the properties x, y and z, found other properties");
  EXPECT_EQ(error_of("a.ply", replaced(ply, "vertex 4", "vertex 4000000000")),
            "vertex 0: expected the 4000000000 of the header, found room for 7 in the file");
  EXPECT_EQ(error_of("a.ply", replaced(ply, "vertex 4", "vertex 1e3")),
            "line 4: expected a number of elements below 2^32, found '1e3'");
  EXPECT_EQ(error_of("a.ply", replaced(ply, "\n0 1 0 9", "\n0 1x 0 9")),
            "vertex 2: expected a number, found '1x'");
  EXPECT_EQ(error_of("a.ply", replaced(ply, "3 1 2 3", "99 1 2 3")),
            "face 2: expected a list of 99, found the end of the file");
}

// A file that was cut off is never taken for a whole one.
TEST_F(MeshFile, TruncatedFilesAreErrors) {
  save_mesh(at("whole.ply"), make_sphere(0));
  const std::string binary = read_file(at("whole.ply"), 1 << 20);
  for (const auto& [name, bytes] : {std::pair{"t.ply", binary},
                                    {"u.ply", make_ascii_ply()},
                                    {"t.glb", make_glb()},
                                    {"t.stl", make_stl()}}) {
    for (std::size_t size = 0; size + 2 < bytes.size(); size += 1 + bytes.size() / 60)
      EXPECT_NE(error_of(name, bytes.substr(0, size)), "no error") << name << " " << size;
  }
  EXPECT_EQ(error_of("t.ply", binary.substr(0, binary.size() - 1)),
            "face 19: expected 20 elements, found the end of the file");
  EXPECT_EQ(error_of("t.glb", make_glb().substr(0, 500)), "expected 892 bytes, found 500 bytes");
  // An OBJ file states no sizes: within a line it shows, between faces it cannot.
  const std::string obj = make_obj();
  EXPECT_EQ(error_of("t.obj", obj.substr(0, obj.size() - 5)),
            "last line: expected a face of 3 vertices or more, found 'f 1/1 4/4'");
}

TEST_F(MeshFile, GltfThatWouldHangOrOverflowIsRefused) {
  const std::string json = make_gltf_json("buffer.bin");
  put("buffer.bin", make_gltf_buffer());
  EXPECT_EQ(error_of("a.gltf", replaced(json, "\"count\": 12", "\"count\": 1200000000")),
            "/accessors/2: expected data within its view of 24 bytes, found data that end at "
            "2400000000");
  EXPECT_EQ(
      error_of("a.gltf", replaced(json, "\"byteLength\": 32", "\"byteLength\": 320")),
      "/bufferViews/1: expected a view within its buffer of 104 bytes, found one that ends at "
      "368");
  EXPECT_EQ(error_of("a.gltf", replaced(json, "\"children\": [1]", "\"children\": [0]")),
            "/nodes/0: expected nodes nested at most 256 deep, found more");
  EXPECT_EQ(error_of("a.gltf", replaced(json, "\"children\": [1]", "\"children\": [2]")),
            "/nodes/0/children/0: expected the index of one of 2 nodes, found the number 2");
  std::filesystem::remove(at("buffer.bin"));
  EXPECT_THAT(error_of("a.gltf", json), StartsWith("expected a readable mesh, found "));
}

TEST_F(MeshFile, SavesPlyOnlyAndWhole) {
  const TriangleMesh mesh = make_sphere(0);
  EXPECT_EQ(parian::error_of([&] { save_mesh(at("a.obj"), mesh); }),
            at("a.obj") + ": expected a file name that ends in .ply, found '.obj'");
  EXPECT_THROW(save_mesh(at("none/a.ply"), mesh), Error);
}

}  // namespace
}  // namespace parian

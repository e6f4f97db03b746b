// Mutated mesh files: bytes changed, numbers replaced, cut off.
#include <fstream>
#include <stdexcept>

#include "fuzz_case.h"
#include "io/json/files.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/test_files_internal.h"
#include "mesh/shapes.h"

namespace parian::fuzz {
namespace {

std::string make_binary_ply(const std::string& path) {
  save_mesh(path, make_sphere(0));
  return read_file(path, 1 << 20);
}

void mutate(Case& c, std::string& bytes) {
  static const std::vector<std::string> tokens{
      "0", "-1", "9", "4294967295", "4294967296", "1e30", "nan", "2147483647", "\n", " ", "{", "]"};
  for (std::size_t edits = 1 + c.below(3); edits > 0; --edits) {
    const std::size_t at = c.below(bytes.size());
    const std::string token = c.pick(tokens);
    if (c.one_in(2)) {
      bytes[at] = static_cast<char>(sample_u32(c.rng));
    } else {
      bytes.replace(at, 1 + c.below(2), token);
    }
  }
  if (c.one_in(4)) bytes.resize(c.below(bytes.size()));
}

}  // namespace

void fuzz_mesh(Case& c) {
  static const std::vector<std::string> extensions{".ply", ".ply", ".obj", ".stl", ".glb", ".gltf"};
  const std::size_t kind = c.below(extensions.size());
  const std::string path = c.folder + "/mesh" + extensions[kind];
  std::string bytes;
  switch (kind) {
    case 0:
      bytes = mesh_testing::make_ascii_ply();
      break;
    case 1: {
      static const std::string binary = make_binary_ply(path);
      bytes = binary;
      break;
    }
    case 2:
      bytes = mesh_testing::make_obj();
      break;
    case 3:
      bytes = mesh_testing::make_stl();
      break;
    case 4:
      bytes = mesh_testing::make_glb();
      break;
    default:
      std::ofstream(c.folder + "/mesh.bin", std::ios::binary) << mesh_testing::make_gltf_buffer();
      bytes = mesh_testing::make_gltf_json("mesh.bin");
  }
  mutate(c, bytes);
  c.note(extensions[kind] + ", changed");
  std::ofstream(path, std::ios::binary) << bytes;
  const TriangleMesh mesh = load_mesh(path);
  if (mesh.triangles.empty() || mesh.normals.size() != mesh.positions.size())
    throw std::logic_error("a mesh without faces or normals was accepted");
  for (const Vec3& n : mesh.normals)
    if (!(std::abs(length(n) - 1) < 1e-3f)) throw std::logic_error("a normal is not of length 1");
}

}  // namespace parian::fuzz

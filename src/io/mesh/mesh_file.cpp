#include "io/mesh/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <filesystem>
#include <new>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "io/json/files.h"
#include "io/mesh/readers_internal.h"

namespace parian {
namespace {

constexpr std::size_t max_file_bytes = std::size_t{1} << 31u;
// What node trees that repeat a mesh may add up to.
constexpr std::size_t max_triangles = std::size_t{1} << 28u;
constexpr std::size_t max_nodes = std::size_t{1} << 20u;

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

[[noreturn]] void throw_extension(const std::string& path, const std::string& known) {
  const std::string extension = extension_of(path);
  throw Error({.file = path,
               .expected = fmt::format("a file name that ends in {}", known),
               .found = extension.empty() ? "no extension" : "'" + extension + "'"});
}

[[noreturn]] void throw_broken(const std::string& path, std::string reason) {
  // assimp's name for what it reads from memory
  const std::string_view unnamed = "$$$___magic___$$$";
  if (const std::size_t at = reason.find(unnamed); at != std::string::npos)
    reason.replace(at, unnamed.size(), "the mesh");
  throw Error({.file = path, .expected = "a readable mesh", .found = single_line(reason)});
}

const aiScene* read_scene(Assimp::Importer& importer, const std::string& path,
                          const std::string& bytes) {
  constexpr unsigned steps = aiProcess_Triangulate | aiProcess_FlipUVs;
  const std::string extension = extension_of(path);
  try {
    // Of all kinds only glTF's text needs the files beside it.
    const aiScene* scene =
        extension == ".gltf"
            ? importer.ReadFile(path, steps)
            : importer.ReadFileFromMemory(bytes.data(), bytes.size(), steps, extension.c_str() + 1);
    if (scene == nullptr) throw_broken(path, importer.GetErrorString());
    return scene;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error({.file = path, .expected = "memory for the mesh", .found = "too little"},
                ErrorKind::resource);
  } catch (const std::exception& error) {
    throw_broken(path, error.what());
  }
}

struct PlacedMesh {
  const aiMesh* mesh = nullptr;
  aiMatrix4x4 to_world;
};

// The scene's meshes, one for each node that shows it.
std::vector<PlacedMesh> place_meshes(const aiScene& scene, const std::string& path) {
  std::vector<PlacedMesh> placed;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> stack;
  if (scene.mRootNode != nullptr) stack.emplace_back(scene.mRootNode, aiMatrix4x4());
  std::size_t nodes = 0;
  std::size_t triangles = 0;
  while (!stack.empty()) {
    const auto [node, parent] = stack.back();
    stack.pop_back();
    const aiMatrix4x4 to_world = parent * node->mTransformation;
    if (++nodes > max_nodes) throw_broken(path, "too many nodes");
    for (unsigned i = 0; i < node->mNumMeshes; ++i) {
      if (node->mMeshes[i] >= scene.mNumMeshes) throw_broken(path, "a node without its mesh");
      const aiMesh* mesh = scene.mMeshes[node->mMeshes[i]];
      triangles += mesh->mNumFaces;
      if (triangles > max_triangles) throw_broken(path, "more than 2^28 triangles");
      placed.push_back({mesh, to_world});
    }
    for (unsigned i = node->mNumChildren; i-- > 0;)
      stack.emplace_back(node->mChildren[i], to_world);
  }
  return placed;
}

Vec3 to_vec3(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

void append(TriangleMesh& mesh, const PlacedMesh& placed, bool normals, bool texcoords,
            const std::string& path) {
  const aiMesh& part = *placed.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const aiMatrix3x3 linear(placed.to_world);
  aiMatrix3x3 for_normals = linear;
  for_normals.Inverse().Transpose();
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    mesh.positions.push_back(to_vec3(placed.to_world * part.mVertices[v]));
    if (normals) mesh.normals.push_back(normalize(to_vec3(for_normals * part.mNormals[v])));
    if (texcoords)
      mesh.texcoords.push_back({part.mTextureCoords[0][v].x, part.mTextureCoords[0][v].y});
  }
  const bool mirrored = linear.Determinant() < 0;
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines
    std::array<std::uint32_t, 3> t{face.mIndices[0], face.mIndices[1], face.mIndices[2]};
    for (std::uint32_t& v : t) {
      if (v >= part.mNumVertices)
        throw_broken(path, fmt::format("a face with vertex {} of {}", v, part.mNumVertices));
      v += first;
    }
    if (mirrored) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }
}

TriangleMesh merge_meshes(const aiScene& scene, bool keep_normals, const std::string& path) {
  const std::vector<PlacedMesh> parts = place_meshes(scene, path);
  // An attribute counts where every part has it.
  const bool normals =
      keep_normals && std::all_of(parts.begin(), parts.end(),
                                  [](const auto& part) { return part.mesh->HasNormals(); });
  const bool texcoords = std::all_of(
      parts.begin(), parts.end(), [](const auto& part) { return part.mesh->HasTextureCoords(0); });
  TriangleMesh mesh;
  for (const PlacedMesh& part : parts) append(mesh, part, normals, texcoords, path);
  return mesh;
}

TriangleMesh decode_by_assimp(const std::string& bytes, const std::string& path,
                              const std::string& extension) {
  if (extension == ".obj") check_obj(bytes, path);
  if (extension == ".gltf") check_gltf(bytes, path);
  if (extension == ".glb") check_glb(bytes, path);
  Assimp::Importer importer;
  const aiScene* scene = read_scene(importer, path, bytes);
  return merge_meshes(*scene, extension != ".stl", path);
}

}  // namespace

TriangleMesh load_mesh(const std::string& path, MeshReport* report) {
  const std::string extension = extension_of(path);
  if (extension != ".ply" && extension != ".obj" && extension != ".gltf" && extension != ".glb" &&
      extension != ".stl")
    throw_extension(path, ".ply, .obj, .gltf, .glb or .stl");
  const std::string bytes = read_file(path, max_file_bytes);
  if (bytes.empty()) throw Error({path, "", "a readable mesh", "an empty file"});
  TriangleMesh mesh =
      extension == ".ply" ? decode_ply(bytes, path) : decode_by_assimp(bytes, path, extension);
  const MeshReport found = clean_mesh(mesh, path);
  if (report != nullptr) *report = found;
  return mesh;
}

void save_mesh(const std::string& path, const TriangleMesh& mesh) {
  if (extension_of(path) != ".ply") throw_extension(path, ".ply");
  check_writable(path);
  write_text(path, encode_ply(mesh));
}

}  // namespace parian

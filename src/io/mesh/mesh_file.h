// Mesh files by extension: .ply, .obj, .gltf, .glb and .stl.
#pragma once

#include <string>

#include "mesh/mesh.h"

namespace parian {

// All triangles of the file in one mesh, polygons triangulated, node transforms applied, then
// clean_mesh, which fills `report`. Units are the file's (fit_to_size gives them in mm). Texture
// coordinates are turned to v = 0 at the image's top row, as glTF has it; PLY and OBJ have it at
// the bottom. The normals of STL, which are those of its facets, are replaced by smooth ones.
// Throws Error naming the file for one that is missing, broken, larger than 2 GiB or of another
// kind, and as clean_mesh does.
TriangleMesh load_mesh(const std::string& path, MeshReport* report = nullptr);

// Binary little-endian PLY with normals (nx ny nz) and texture coordinates (s t) where the mesh
// has them.
void save_mesh(const std::string& path, const TriangleMesh& mesh);

}  // namespace parian

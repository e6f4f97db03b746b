// What assimp does not do safely: PLY, and checks of OBJ and glTF before it reads them. Internal to
// this folder.
#pragma once

#include <string>
#include <string_view>

#include "mesh/mesh.h"

namespace parian {

// ASCII and both binary kinds; polygons become fans. Our own, though assimp reads PLY as well (the
// 871,414 triangles of a scanned dragon in 0.42 s): of 600 files with one to three bytes changed,
// assimp 5.2.5 took the process down for 117.
TriangleMesh decode_ply(std::string_view bytes, const std::string& path);
// Binary, little-endian.
std::string encode_ply(const TriangleMesh& mesh);

// Throws when the file ends within a vertex or face: it was cut off.
void check_obj(std::string_view bytes, const std::string& path);
// Throws unless the JSON is valid, accessors and views lie within their buffers, and the nodes are
// a tree: assimp hangs on or allocates for files where they do not.
void check_gltf(std::string_view json, const std::string& path);
void check_glb(std::string_view bytes, const std::string& path);

// Text from a library as one line of at most 200 printable characters.
std::string single_line(std::string_view text);

}  // namespace parian

// Meshes and environments for pictures, as `./run assets` fetches them; without them a built-in
// shape and sky stand in.
#pragma once

#include <string>

#include "mesh/mesh.h"
#include "scene/scene.h"

namespace parian {

// The file of the cache, its longest side size_mm; or the knot, at this detail.
TriangleMesh make_bench_mesh(const std::string& file, int detail, double size_mm);
EnvironmentLight make_bench_environment();

}  // namespace parian

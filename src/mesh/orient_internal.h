// Which way a mesh's faces should look. Internal to this folder.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/mesh.h"

namespace parian {

struct Orientation {
  std::vector<char> flip;                // [triangle] the winding is to be reversed
  std::vector<std::uint32_t> component;  // [triangle] connected over manifold edges
  std::uint32_t component_count = 0;
  std::size_t boundary_edges = 0;
  std::size_t nonmanifold_edges = 0;
};

// Faces that share a manifold edge agree; of the two windings that a component may have, the one
// that more of its area has in the file is its original one. Then,
// - a component that is closed but for small gaps (its normals sum to less than a tenth of its
//   area) looks outward: its signed volume is positive. One that lies inside a larger one, and was
//   wound against the mesh's largest, is a cavity of it, and looks inward;
// - any other component is turned if most of the closed ones' area was, and else kept.
Orientation find_orientation(const TriangleMesh& mesh, std::span<const std::uint32_t> weld);

}  // namespace parian

// Flaps: faces on the same three places that look opposite ways. Internal to this folder.
#pragma once

#include <cstdint>
#include <span>

#include "mesh/mesh.h"

namespace parian {

// Decimated scans are full of them. They enclose nothing, and would bear samples that no light
// reaches. Removes such pairs of faces, which leaves a closed mesh closed; returns the number of
// faces removed. A mesh of which more than half would go is left alone: it is a sheet with two
// sides.
std::size_t cancel_flaps(TriangleMesh& mesh, std::span<const std::uint32_t> weld);

}  // namespace parian

// Thins candidates on a surface to blue noise. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "math/vec.h"

namespace parian {

struct Candidate {
  Vec3 position;
  Vec3 normal;  // of the triangle
  Vec2 barycentric;
  std::uint32_t triangle = 0;
  std::uint32_t group = 0;
};

// Leaves `count` of the candidates, sorted so that neighbours in space are near in memory: of each
// group, numbered from 0, `per_group`, and of the last what remains.
void eliminate_samples(std::vector<Candidate>& candidates, std::size_t count, double area,
                       std::size_t per_group, const Progress& progress);

}  // namespace parian

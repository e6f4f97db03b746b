// Refraction of a directional light at many entries of a depth map, vectorised.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "transport/depth_layers.h"

namespace parian {

// Normals, of any length, where light enters in a row of a map, and their columns.
struct EntryRow {
  std::size_t count = 0;
  std::vector<float> normal[3];
  std::vector<std::uint32_t> column;
  // Room for what is found.
  std::vector<float> length_ratio, flux[3];
};
EntryRow make_entry_row(std::size_t width);

inline void append(EntryRow& row, Vec3 normal, int column) {
  row.normal[0][row.count] = normal.x;
  row.normal[1][row.count] = normal.y;
  row.normal[2][row.count] = normal.z;
  row.column[row.count++] = static_cast<std::uint32_t>(column);
}

// Sets length_ratio and flux of the row's texels, as refract_entry finds them.
void refract_entries(EntryRow& row, Vec3 to_light, float eta, DepthTexel* texels);

}  // namespace parian

// A measured BSSRDF held in memory: small tables, tests and examples. Large ones stay on disk and
// are read through a SliceSource.
#pragma once

#include "material/slices.h"

namespace parian {

struct BssrdfTable {
  TableHeader header;
  std::vector<float> reflectance;  // [channel][offset][y][x], 1/mm^2, NaN = not measured
};

// Allocates, all values NaN.
BssrdfTable make_bssrdf_table(TableHeader header);

inline float* slice_of(BssrdfTable& table, int channel, int offset_index) {
  const std::size_t index = static_cast<std::size_t>(channel) * table.header.offsets.size() +
                            static_cast<std::size_t>(offset_index);
  return table.reflectance.data() + index * table.header.pixels();
}
inline const float* slice_of(const BssrdfTable& table, int channel, int offset_index) {
  return slice_of(const_cast<BssrdfTable&>(table), channel, offset_index);
}

// A source over the table, which must outlive it. Checks values as clean_slice does.
std::unique_ptr<SliceSource> make_slices(const BssrdfTable& table, std::string name = {});

// Reads a whole source into memory.
BssrdfTable read_table(const SliceSource& source);

// The offsets of a disc of `radius` pixels in the half plane, by rows: (0,0), (1,0), ...
std::vector<Offset> half_disc_offsets(double radius);
// Those of them that fit into a grid.
std::vector<Offset> half_disc_offsets(double radius, int width, int height);

}  // namespace parian

// Where the slices of a table lie in its file, so that they can be read past HDF5: the addresses
// of all slices, collected once at opening. Internal to this folder.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "io/hdf5/raw_file_internal.h"
#include "io/hdf5/read_internal.h"

namespace parian::hdf5 {

struct Extent {
  std::uint64_t address = 0;
  std::uint64_t bytes = 0;  // 0: never written
};

struct SliceLayout {
  bool deflated = false;       // zlib streams, else plain little-endian floats
  bool shuffled = false;       // bytes of equal significance together, before deflate
  std::vector<Extent> slices;  // [channel][offset]
};

// Empty when the values have to go through HDF5: other types, other chunks, other filters, or an
// index whose walk would take longer than it saves. Every extent lies inside the file.
std::optional<SliceLayout> locate_slices(const File& file, const Dataset& dataset,
                                         const RawFile& raw);

// Undoes shuffle and deflate. False when the data are not that.
bool inflate_slice(const SliceLayout& layout, const std::vector<unsigned char>& stored,
                   float* values, std::size_t count);

// Chunk addresses straight from the version-1 B-tree that indexes chunks in files of HDF5's default
// format (HDF5 file format specification III.A.1 and IV.A). HDF5 1.10 itself finds the address of a
// chunk by a linear search, which is quadratic in their number. Empty on anything unexpected.
std::optional<std::vector<Extent>> walk_chunk_index(const RawFile& raw,
                                                    std::uint64_t header_address,
                                                    const std::vector<std::uint64_t>& shape);

}  // namespace parian::hdf5

// BSSRDF tables in HDF5 (docs/formats.md), streamed slice by slice in both directions.
#pragma once

#include <memory>
#include <string>

#include "material/slices.h"

namespace parian {

// Reads and checks the header; slices are read on demand, from several threads at once. Slices that
// are stored as whole, unfiltered chunks of native floats are read straight from the file; anything
// else that HDF5 can convert (integer or float width, byte order, chunking, filters) goes through
// HDF5. Errors name the file, and the attribute, dataset or [channel][offset][y][x] at fault.
std::unique_ptr<SliceSource> open_table(const std::string& path);

struct TableWriteParams {
  int deflate = 0;  // 0: not compressed; 1 to 9: shuffle + deflate
};

// A table that is written slice by slice and appears at `path`, whole, with finish(). Destroyed
// before that, it leaves nothing behind. Throws Error(resource) on a full disk.
std::unique_ptr<SliceSink> create_table(const std::string& path, const TableHeader& header,
                                        const TableWriteParams& params = {});

}  // namespace parian

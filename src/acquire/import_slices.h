// Slices that another program made, as the table of a description (docs/formats.md, "Imports"):
// what it says about them, and the values of its arrays, which a loader hands over.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/document.h"
#include "base/progress.h"
#include "material/slices.h"

namespace parian {

// An array in C order, or an image as [height][width][channels].
struct NamedArray {
  std::vector<std::size_t> shape;
  std::vector<float> values;
};
// Loads a file; its path is what a description names, resolved against the description's file.
using ArrayLoader = std::function<NamedArray(const std::string& path)>;

// What is to be imported; the header's grid and channels are those of the first array.
struct SliceImport {
  TableHeader header;
  std::vector<std::string> files;  // resolved; one for each offset, [y][x] or [y][x][channel]
  bool together = false;           // one file: [offset][y][x] or [channel][offset][y][x]
};

// Reads and checks a description; loads the first array for its shape. Errors name file and JSON
// pointer, or the array and its shape.
SliceImport read_slice_import(const Document& document, const ArrayLoader& load_array);

// Writes all slices and finishes the sink; one file is in memory at a time. Checks values as
// clean_slice does; errors name the array's file.
void import_slices(const SliceImport& slices, const ArrayLoader& load_array, SliceSink& sink,
                   const Progress& progress = {});

}  // namespace parian

// NumPy's .npy files, versions 1 to 3 (numpy.lib.format), read strictly: numbers in C or Fortran
// order, of either byte order.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace parian {

struct NpyArray {
  std::vector<std::size_t> shape;  // at most 4 axes
  std::vector<float> values;       // C order; NaN and infinities stay
};

// Booleans, integers of 8 to 64 bits and floats of 16, 32 or 64 bits become floats. Everything else
// (structures, objects, complex numbers), a header that is not what numpy.save writes, and data
// that are shorter or longer than the shape says are errors that name `path`.
NpyArray parse_npy(std::string_view bytes, const std::string& path);
NpyArray load_npy(const std::string& path);

// "[3][20][24]"
std::string format_shape(const std::vector<std::size_t>& shape);

}  // namespace parian

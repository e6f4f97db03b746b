// Minimum-error boundary cuts between overlapping patches (Efros and Freeman 2001, section 2.1).
#pragma once

#include <vector>

namespace parian {

// How many rows or columns of a patch, from each side, lie on what is there already.
struct Overlap {
  int left = 0, right = 0, top = 0, bottom = 0;
};

// For each of length steps the place, in [0, width), where the path of least summed error through
// error[length][width] passes; neighbouring steps differ by one place at most.
std::vector<int> cut_seam(const std::vector<float>& error, int length, int width);

// Which pixels of a width x height patch are taken from the new patch (1) and which stay (0), given
// the squared difference of both at each pixel, [y][x]; only the overlap's entries are read. Each
// side of the overlap is cut along its whole length; the new patch keeps what all cuts leave it.
std::vector<unsigned char> cut_patch(const std::vector<float>& error, int width, int height,
                                     const Overlap& overlap);

}  // namespace parian

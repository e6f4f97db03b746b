// The mean profile of a capture where the light of several dots mixes. Internal to this folder.
#pragma once

#include <cstddef>
#include <vector>

#include "acquire/capture_slices.h"

namespace parian {

// R(x, y) is about T(r) factor(x) factor(y) for r of at least a quarter of the lattice.
struct TailModel {
  std::vector<double> at;      // T by r^2 in pixels, up to reach2
  std::vector<double> factor;  // [y][x]
};
inline int tail_reach2(const CaptureMeta& meta) {
  return 4 * meta.lattice_px * meta.lattice_px;
}

// T is a sum of exponentials with coefficients >= 0, as everything that diffuses is: fitted (least
// squares of relative errors) to all the light between the dots, not only the nearest one's, so
// that even the corners of the lattice's cells count, which all dots around light alike.
TailModel make_tail_model(const CaptureMeta& meta, const DotResponses& responses, int channel);

// Calls body(r2, pixel of the dot) for the dots of the frame of pixel (dot_x, dot_y) that are
// within reach of (x, y).
template <typename Body>
void for_each_dot(const CaptureMeta& meta, int i, int j, int x, int y, const Body& body) {
  const int reach2 = tail_reach2(meta);
  for (int dot_y = j; dot_y < meta.height; dot_y += meta.lattice_px)
    for (int dot_x = i; dot_x < meta.width; dot_x += meta.lattice_px) {
      const int r2 = (dot_x - x) * (dot_x - x) + (dot_y - y) * (dot_y - y);
      if (r2 > reach2) continue;
      body(static_cast<std::size_t>(r2),
           static_cast<std::size_t>(dot_y) * static_cast<std::size_t>(meta.width) +
               static_cast<std::size_t>(dot_x));
    }
}

}  // namespace parian

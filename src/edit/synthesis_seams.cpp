#include "edit/synthesis_seams.h"

#include <algorithm>
#include <cstddef>

#include "base/check.h"

namespace parian {

std::vector<int> cut_seam(const std::vector<float>& error, int length, int width) {
  const auto steps = static_cast<std::size_t>(length), places = static_cast<std::size_t>(width);
  PARIAN_CHECK_EQ(error.size(), steps * places);
  std::vector<double> sum(error.begin(), error.end());
  const auto best_before = [&](std::size_t step, std::size_t place) {
    const double* row = sum.data() + (step - 1) * places;
    std::size_t best = place;  // ties go straight on
    if (place > 0 && row[place - 1] < row[best]) best = place - 1;
    if (place + 1 < places && row[place + 1] < row[best]) best = place + 1;
    return best;
  };
  // E(i, j) = e(i, j) + min(E(i-1, j-1), E(i-1, j), E(i-1, j+1)).
  for (std::size_t step = 1; step < steps; ++step)
    for (std::size_t place = 0; place < places; ++place)
      sum[step * places + place] += sum[(step - 1) * places + best_before(step, place)];
  std::vector<int> seam(steps, 0);
  if (steps == 0 || places == 0) return seam;
  const double* last = sum.data() + (steps - 1) * places;
  std::size_t place = static_cast<std::size_t>(std::min_element(last, last + places) - last);
  for (std::size_t step = steps; step-- > 0;) {
    seam[step] = static_cast<int>(place);
    if (step > 0) place = best_before(step, place);
  }
  return seam;
}

namespace {

// A side's band of the patch, seen from outside inwards: along runs the seam, across goes in.
struct Band {
  int length, depth;
  std::ptrdiff_t origin, along, across;  // offsets into the patch
};

void cut_band(const std::vector<float>& error, const Band& band,
              std::vector<unsigned char>& is_new) {
  if (band.depth == 0) return;
  const auto at = [&](int step, int place) {
    return static_cast<std::size_t>(band.origin + step * band.along + place * band.across);
  };
  std::vector<float> cost;
  cost.reserve(static_cast<std::size_t>(band.length) * static_cast<std::size_t>(band.depth));
  for (int step = 0; step < band.length; ++step)
    for (int place = 0; place < band.depth; ++place) cost.push_back(error[at(step, place)]);
  const std::vector<int> seam = cut_seam(cost, band.length, band.depth);
  for (int step = 0; step < band.length; ++step)
    for (int place = 0; place < seam[static_cast<std::size_t>(step)]; ++place)
      is_new[at(step, place)] = 0;
}

}  // namespace

std::vector<unsigned char> cut_patch(const std::vector<float>& error, int width, int height,
                                     const Overlap& overlap) {
  std::vector<unsigned char> is_new(error.size(), 1);
  const std::ptrdiff_t last_row = static_cast<std::ptrdiff_t>(height - 1) * width;
  cut_band(error, {height, overlap.left, 0, width, 1}, is_new);
  cut_band(error, {height, overlap.right, width - 1, width, -1}, is_new);
  cut_band(error, {width, overlap.top, 0, 1, width}, is_new);
  cut_band(error, {width, overlap.bottom, last_row, 1, -width}, is_new);
  return is_new;
}

}  // namespace parian

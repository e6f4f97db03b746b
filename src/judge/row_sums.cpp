#include "judge/row_sums.h"

#include <utility>

#include "judge/relight.h"

namespace parian {

RowSums measure_row_sums(const SliceSource& table, const Progress& progress) {
  constexpr float rounding = 1e-6f;
  const TableHeader& header = table.header();
  RowSums sums;
  sums.albedo = std::move(
      relight(table, {make_flat_light(FlatLight::uniform, header.width, header.height, 1)},
              progress)
          .front());
  sums.max = at(sums.albedo, 0, 0, 0);
  for (int y = 0; y < header.height; ++y)
    for (int x = 0; x < header.width; ++x)
      for (int c = 0; c < header.channels; ++c) {
        const float rho = at(sums.albedo, x, y, c);
        if (rho > 1 + rounding) ++sums.above_one;
        if (rho <= sums.max) continue;
        sums.max = rho;
        sums.x = x;
        sums.y = y;
        sums.channel = c;
      }
  return sums;
}

}  // namespace parian

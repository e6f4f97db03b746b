#include "compress/local_model.h"

#include <algorithm>

#include "base/parallel.h"

namespace parian {
namespace {

constexpr std::size_t block = 64;  // pixels: rows and planes of a block fit the cache

}  // namespace

AlignedVector<float> make_rows(const RowShape& shape, const float* planes) {
  AlignedVector<float> rows(shape.pixels * shape.stride());
  const std::size_t values = shape.channels * shape.knots;
  parallel_for_blocks(shape.pixels, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 0; i < values; ++i)
      for (std::size_t x = begin; x < end; ++x)
        rows[shape.row(x) + i] = planes[i * shape.pixels + x];
    for (std::size_t x = begin; x < end; ++x)
      std::fill(rows.begin() + static_cast<std::ptrdiff_t>(shape.row(x) + values),
                rows.begin() + static_cast<std::ptrdiff_t>(shape.row(x + 1)), 0.0f);
  });
  return rows;
}

void scatter_rows(const RowShape& shape, const float* rows, float* planes) {
  const std::size_t values = shape.channels * shape.knots;
  parallel_for_blocks(shape.pixels, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 0; i < values; ++i)
      for (std::size_t x = begin; x < end; ++x)
        planes[i * shape.pixels + x] = rows[shape.row(x) + i];
  });
}

}  // namespace parian

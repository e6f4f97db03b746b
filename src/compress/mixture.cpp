#include "compress/mixture.h"

#include "base/parallel.h"
#include "compress/mixture_kernels.h"

namespace parian {

AlignedVector<float> mix_rows(const Mixture& mixture) {
  const std::size_t stride = mixture.shape.stride(), per_pixel = mixture.per_pixel;
  AlignedVector<float> rows(mixture.shape.pixels * stride);
  parallel_for_blocks(mixture.shape.pixels, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t x = begin; x < end; ++x)
      mix_row(mixture.bases.data(), stride, &mixture.index[x * per_pixel],
              &mixture.weight[x * per_pixel], per_pixel, &rows[x * stride]);
  });
  return rows;
}

Mixture with_one_more(const Mixture& mixture) {
  Mixture more = mixture;
  const std::size_t k = mixture.per_pixel, pixels = mixture.shape.pixels;
  more.per_pixel = k + 1;
  more.index.resize(pixels * (k + 1));
  more.weight.resize(pixels * (k + 1));
  for (std::size_t x = 0; x < pixels; ++x) {
    for (std::size_t i = 0; i < k; ++i) {
      more.index[x * (k + 1) + i] = mixture.index[x * k + i];
      more.weight[x * (k + 1) + i] = mixture.weight[x * k + i];
    }
    more.index[x * (k + 1) + k] = mixture.index[x * k + k - 1];
    more.weight[x * (k + 1) + k] = 0;
  }
  return more;
}

}  // namespace parian

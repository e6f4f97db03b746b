// The optimiser's variables: M base profiles, and K indices and weights for each pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "compress/local_model.h"

namespace parian {

struct Mixture {
  RowShape shape;
  std::size_t per_pixel = 2;         // K
  AlignedVector<float> bases;        // [base][stride]: rows as in LocalMetric
  std::vector<std::uint16_t> index;  // [pixel][k]
  std::vector<float> weight;         // [pixel][k], all K, sum 1

  std::size_t base_count() const { return bases.size() / shape.stride(); }
  const float* base(std::size_t i) const { return bases.data() + i * shape.stride(); }
  float* base(std::size_t i) { return bases.data() + i * shape.stride(); }
};

// The profiles of all pixels: rows [pixel][stride].
AlignedVector<float> mix_rows(const Mixture& mixture);

// K grows by one: the new entry repeats the last one, with weight 0.
Mixture with_one_more(const Mixture& mixture);

}  // namespace parian

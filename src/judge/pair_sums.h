// The sums of a comparison. Every pixel row gathers the pairs in which its pixels take part, so
// rows are independent, and each sum runs in the order of channel and offset.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "judge/pair_kernels.h"
#include "judge/relight.h"
#include "judge/slice_batches.h"
#include "material/profile_map.h"

namespace parian {

inline constexpr std::array<FlatLight, 3> flat_lights{FlatLight::uniform, FlatLight::disc,
                                                      FlatLight::line};

// Sums per pixel over its pairs and all channels; counts per pixel row. 0 pixels: not in use.
struct ErrorSums {
  ErrorSums(std::size_t pixels, std::size_t rows);
  std::vector<double> error2, data2, error1, data1;
  std::vector<double> log2;        // of (ln R'/R)^2 at x alone, twice where d != 0
  std::vector<double> log_weight;  // per row: how many logarithms, counted likewise
  std::vector<PairCounts> counts;  // per row: each listed value once
};

// Sums of one channel over the pairs of each pixel times the light, for each of flat_lights.
struct LitSums {
  explicit LitSums(std::size_t pixels);
  void clear();
  std::array<std::vector<double>, flat_lights.size()> data, model;
};

struct PairSums {
  PairSums(const TableHeader& header, const HoldOut& hold_out);
  const TableHeader& header;
  const HoldOut& hold_out;
  std::array<LightPlane, flat_lights.size()> irradiance;
  ErrorSums all, held;
  LitSums lit;
  std::vector<unsigned char> held_masks;  // of a batch: [slice][y][x], 1 where held out
};

// Adds the slices of a batch (source 0 the table, 1 the model), in parallel over rows.
void add_batch(PairSums& sums, const SliceBatch& batch);

}  // namespace parian

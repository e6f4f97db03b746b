// Reading tables, and models beside them, several slices at a time: the slices of a batch are read
// in parallel, then used in parallel over pixel rows. Sums that each row makes in the order of the
// offsets have the same bits for any number of threads and any size of batch, and need no memory
// beyond one set of sums and the batch.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "material/slices.h"

namespace parian {

// Slices of one channel at consecutive offsets of the table.
struct SliceBatch {
  int channel = 0;
  int first = 0;  // index of the first offset
  int count = 0;
  std::size_t pixels = 0;
  std::vector<std::vector<float>> values;  // [source][offset - first][y][x], source 0: the table

  float* slice(int source, int i) {
    return values[static_cast<std::size_t>(source)].data() + static_cast<std::size_t>(i) * pixels;
  }
  const float* slice(int source, int i) const {
    return const_cast<SliceBatch*>(this)->slice(source, i);
  }
};

// Channels [first_channel, end_channel) of the table and, where given, of the model at the same
// offsets (`model_offsets` from match_offsets), in order of channel and offset; body runs on the
// calling thread.
void for_each_batch(const SliceSource& table, const SliceSource* model,
                    const std::vector<int>& model_offsets, int first_channel, int end_channel,
                    const Progress& progress, std::string_view stage,
                    const std::function<void(SliceBatch&)>& body);

// Index in the model of each offset of the table. Throws Error, naming the model, when grids,
// channels or pitches differ or an offset of the table is absent.
std::vector<int> match_offsets(const SliceSource& table, const SliceSource& model);

// The pairs (x, x + d) of one slice as seen from pixel row y.
struct RowPairs {
  int count = 0;            // pairs with x in row y
  std::size_t at = 0;       // first such x
  std::size_t partner = 0;  // its x + d
  int back_count = 0;       // pairs with x + d in row y and d != 0
  std::size_t back_at = 0;  // first such x
  std::size_t back_partner = 0;
};
RowPairs find_row_pairs(const TableHeader& header, Offset offset, int y);

}  // namespace parian

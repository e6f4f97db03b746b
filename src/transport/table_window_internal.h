// A table laid out for gathering: all offsets of a pixel beside each other, and from these the
// window of values that one surface point sees around itself.
#pragma once

#include <cstddef>
#include <vector>

#include "material/bssrdf_table.h"
#include "transport/gather_table.h"

namespace parian {

// Which end of a pair the pixel is: where light leaves, or where it enters.
enum class TableEnd { leaving, entering };

// values[y][x][entry][3]: the pair between pixel (x, y) and (x, y) + entry's offset, NaN where it
// is not measured. Entries are the listed offsets and their reverses.
struct ExpandedTable {
  int width = 0, height = 0;
  int half = 0;  // windows are (2 half + 1) x (2 half + 1)
  int side = 0;  // 2 half + 1
  std::vector<Offset> offsets;
  std::vector<int> slots;  // of each entry in the window
  // Floats of a slot of a window: values; of tables with missing ones, values times weights and
  // then weights; each for three channels and padding.
  std::size_t slot_floats = 4;
  std::vector<float> empty_window;  // what no entry writes: zeros beyond, missing between offsets
  std::vector<float> values;        // and one of padding

  bool has_missing() const { return slot_floats == 8; }
};
ExpandedTable expand_table(const BssrdfTable& table, TableEnd end);

inline std::size_t window_size(const ExpandedTable& table) {
  return table.empty_window.size();
}

// The window of a place, bilinear over the four pixels around it. `window` has window_size floats.
void make_window(const ExpandedTable& table, const SamplePoint& place, float* window);

// A window and where it stands.
struct WindowFrame {
  const float* window = nullptr;
  int side = 0;
  bool has_missing = false;
  float pixels_per_mm = 1;
  Vec3 origin, along_x, along_y;
};
// values[n][4]: red, green, blue and padding at the points; squares[n]: their squared distances.
void look_up_window(const WindowFrame& frame, std::size_t count, const float* x, const float* y,
                    const float* z, float* values, float* squares);

}  // namespace parian

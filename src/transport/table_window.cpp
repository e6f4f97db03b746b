#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/hot.h"
#include "transport/table_window_internal.h"

namespace parian {
namespace {

// Positions in the window, listed or not.
std::size_t slot_of(int side, Offset offset) {
  const int half = side / 2;
  return static_cast<std::size_t>(offset.dy + half) * static_cast<std::size_t>(side) +
         static_cast<std::size_t>(offset.dx + half);
}

// Listed offsets and, where the table is symmetric, their reverses.
std::vector<Offset> all_offsets(const TableHeader& header) {
  std::vector<Offset> offsets = header.offsets;
  if (header.symmetric)
    for (const Offset offset : header.offsets)
      if (offset != Offset{}) offsets.push_back({-offset.dx, -offset.dy});
  return offsets;
}

// Marks what lies between two marked slots of a row (stride 1) or column (stride side).
void fill_lines(std::vector<char>& inside, std::size_t side, std::size_t stride,
                std::size_t next_line) {
  for (std::size_t line = 0; line < side; ++line) {
    char* first = inside.data() + line * next_line;
    std::size_t begin = 0, end = side;
    while (begin < side && !first[begin * stride]) ++begin;
    while (end > begin && !first[(end - 1) * stride]) --end;
    for (std::size_t i = begin; i < end; ++i) first[i * stride] = 1;
  }
}

// Whether each slot is listed or lies between listed ones, where it counts as missing; the others
// are beyond the window: zero.
std::vector<char> find_inside(int side, const std::vector<Offset>& offsets) {
  const auto count = static_cast<std::size_t>(side);
  std::vector<char> inside(count * count, 0);
  for (const Offset d : offsets) inside[slot_of(side, d)] = 1;
  for (int pass = 0; pass < 2; ++pass) {  // twice, for grids of which whole rows are not listed
    fill_lines(inside, count, 1, count);
    fill_lines(inside, count, count, 1);
  }
  return inside;
}

// With the weight 1 at what is beyond, where slots have weights.
std::vector<float> make_empty_window(const std::vector<char>& inside, std::size_t slot_floats) {
  std::vector<float> window(inside.size() * slot_floats, 0.0f);
  for (std::size_t i = 0; i < inside.size() && slot_floats == 8; ++i)
    if (!inside[i]) std::fill_n(window.begin() + static_cast<std::ptrdiff_t>(8 * i + 4), 4, 1.0f);
  return window;
}

// Value of the pair between pixel p and p + d, the component that leaves the grid reflected.
struct PairReader {
  const BssrdfTable& table;
  TableEnd end;
  int half;
  std::vector<int> index;  // of a slot's offset in the table, or -1

  float read(int channel, int x, int y, Offset d) const {
    const TableHeader& header = table.header;
    const auto reflect = [](int p, int delta, int size) {
      return p + delta < 0 || p + delta >= size ? -delta : delta;
    };
    d = {reflect(x, d.dx, header.width), reflect(y, d.dy, header.height)};
    const int px = x + d.dx, py = y + d.dy;
    if (px < 0 || py < 0 || px >= header.width || py >= header.height)
      return std::numeric_limits<float>::quiet_NaN();  // wider than the grid, either way
    const int side = 2 * half + 1;
    const int forward = index[slot_of(side, d)];
    const int reverse = index[slot_of(side, {-d.dx, -d.dy})];
    const bool from_here = header.symmetric ? forward >= 0 : end == TableEnd::leaving;
    const int chosen = from_here ? forward : reverse;
    if (chosen < 0) return std::numeric_limits<float>::quiet_NaN();
    const float* slice = slice_of(table, std::min(channel, header.channels - 1), chosen);
    return from_here ? slice[y * header.width + x] : slice[py * header.width + px];
  }
};

int window_half(const TableHeader& header) {
  int half = 0;
  for (const Offset d : header.offsets) half = std::max({half, std::abs(d.dx), std::abs(d.dy)});
  return half + 1;  // a rim, towards which values fall to zero
}

// window += weight * pixel. The fourth lane is padding.
PARIAN_HOT void add_pixel(const float* PARIAN_RESTRICT pixel, const int* PARIAN_RESTRICT slots,
                          std::size_t entries, float weight, float* PARIAN_RESTRICT window) {
  for (std::size_t e = 0; e < entries; ++e) {
    float* slot = window + 4 * static_cast<std::size_t>(slots[e]);
    for (std::size_t c = 0; c < 4; ++c) slot[c] += weight * pixel[3 * e + c];
  }
}

// The same, leaving out what is NaN.
PARIAN_HOT void add_pixel_with_missing(const float* PARIAN_RESTRICT pixel,
                                       const int* PARIAN_RESTRICT slots, std::size_t entries,
                                       float weight, float* PARIAN_RESTRICT window) {
  for (std::size_t e = 0; e < entries; ++e) {
    float* slot = window + 8 * static_cast<std::size_t>(slots[e]);
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = pixel[3 * e + c];
      const bool is_measured = value == value;
      slot[c] += is_measured ? weight * value : 0.0f;
      slot[4 + c] += is_measured ? weight : 0.0f;
    }
  }
}

// Places of points in a window: tap[n] = first of the four slots, or -1 beyond, and the fractions.
PARIAN_HOT void find_taps(const float* PARIAN_RESTRICT frame, int side, std::size_t count,
                          const float* PARIAN_RESTRICT x, const float* PARIAN_RESTRICT y,
                          const float* PARIAN_RESTRICT z, int* PARIAN_RESTRICT tap,
                          float* PARIAN_RESTRICT fx, float* PARIAN_RESTRICT fy,
                          float* PARIAN_RESTRICT r2) {
  const float last = static_cast<float>(side - 1), half = last / 2;
  for (std::size_t n = 0; n < count; ++n) {
    const float dx = x[n] - frame[0], dy = y[n] - frame[1], dz = z[n] - frame[2];
    const float u = dx * frame[3] + dy * frame[4] + dz * frame[5];
    const float v = dx * frame[6] + dy * frame[7] + dz * frame[8];
    const float square = dx * dx + dy * dy + dz * dz, in_plane = u * u + v * v;
    const bool is_flat = in_plane > 1e-12f * square;
    const float stretch = std::sqrt(is_flat ? square / in_plane : square);
    const float wx = (is_flat ? u : 1.0f) * stretch * frame[9] + half;
    const float wy = (is_flat ? v : 0.0f) * stretch * frame[9] + half;
    const bool is_inside = wx > 0 && wy > 0 && wx < last && wy < last;
    const int ix = static_cast<int>(is_inside ? wx : 0.0f);
    const int iy = static_cast<int>(is_inside ? wy : 0.0f);
    tap[n] = is_inside ? iy * side + ix : -1;
    fx[n] = wx - static_cast<float>(ix);
    fy[n] = wy - static_cast<float>(iy);
    r2[n] = square;
  }
}

PARIAN_HOT void blend_taps(const float* PARIAN_RESTRICT window, int side, std::size_t count,
                           const int* PARIAN_RESTRICT tap, const float* PARIAN_RESTRICT fx,
                           const float* PARIAN_RESTRICT fy, float* PARIAN_RESTRICT out) {
  const std::size_t row = 4 * static_cast<std::size_t>(side);
  for (std::size_t n = 0; n < count; ++n) {
    float* result = out + 4 * n;
    for (std::size_t c = 0; c < 4; ++c) result[c] = 0;
    if (tap[n] < 0) continue;
    const float* first = window + 4 * static_cast<std::size_t>(tap[n]);
    const float w00 = (1 - fx[n]) * (1 - fy[n]), w10 = fx[n] * (1 - fy[n]);
    const float w01 = (1 - fx[n]) * fy[n], w11 = fx[n] * fy[n];
    for (std::size_t c = 0; c < 4; ++c)
      result[c] =
          w00 * first[c] + w10 * first[4 + c] + w01 * first[row + c] + w11 * first[row + 4 + c];
  }
}

PARIAN_HOT void blend_taps_with_missing(const float* PARIAN_RESTRICT window, int side,
                                        std::size_t count, const int* PARIAN_RESTRICT tap,
                                        const float* PARIAN_RESTRICT fx,
                                        const float* PARIAN_RESTRICT fy,
                                        float* PARIAN_RESTRICT out) {
  const std::size_t row = 8 * static_cast<std::size_t>(side);
  for (std::size_t n = 0; n < count; ++n) {
    float* result = out + 4 * n;
    for (std::size_t c = 0; c < 4; ++c) result[c] = 0;
    if (tap[n] < 0) continue;
    const float* first = window + 8 * static_cast<std::size_t>(tap[n]);
    const float w00 = (1 - fx[n]) * (1 - fy[n]), w10 = fx[n] * (1 - fy[n]);
    const float w01 = (1 - fx[n]) * fy[n], w11 = fx[n] * fy[n];
    float sum[8];
    for (std::size_t k = 0; k < 8; ++k)
      sum[k] =
          w00 * first[k] + w10 * first[8 + k] + w01 * first[row + k] + w11 * first[row + 8 + k];
    for (std::size_t c = 0; c < 3; ++c) result[c] = sum[4 + c] > 1e-6f ? sum[c] / sum[4 + c] : 0.0f;
  }
}

}  // namespace

ExpandedTable expand_table(const BssrdfTable& table, TableEnd end) {
  const TableHeader& header = table.header;
  ExpandedTable expanded;
  expanded.width = header.width;
  expanded.height = header.height;
  expanded.half = window_half(header);
  expanded.side = 2 * expanded.half + 1;
  expanded.offsets = all_offsets(header);
  const std::vector<char> inside = find_inside(expanded.side, expanded.offsets);
  PairReader reader{table, end, expanded.half, {}};
  reader.index.assign(inside.size(), -1);
  for (std::size_t i = 0; i < header.offsets.size(); ++i)
    reader.index[slot_of(expanded.side, header.offsets[i])] = static_cast<int>(i);
  for (const Offset d : expanded.offsets)
    expanded.slots.push_back(static_cast<int>(slot_of(expanded.side, d)));
  const std::size_t entries = expanded.offsets.size();
  expanded.values.resize(header.pixels() * entries * 3 + 1);
  float* out = expanded.values.data();
  for (int y = 0; y < header.height; ++y)
    for (int x = 0; x < header.width; ++x)
      for (const Offset d : expanded.offsets)
        for (int c = 0; c < 3; ++c) *out++ = reader.read(c, x, y, d);
  const auto listed = static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1));
  const bool has_missing =
      listed > entries || std::any_of(expanded.values.begin(), expanded.values.end(),
                                      [](float value) { return std::isnan(value); });
  expanded.slot_floats = has_missing ? 8 : 4;
  expanded.empty_window = make_empty_window(inside, expanded.slot_floats);
  return expanded;
}

void make_window(const ExpandedTable& table, const SamplePoint& place, float* window) {
  std::copy(table.empty_window.begin(), table.empty_window.end(), window);
  const double x0 = std::floor(place.x), y0 = std::floor(place.y);
  const float fx = static_cast<float>(place.x - x0), fy = static_cast<float>(place.y - y0);
  const std::size_t entries = table.offsets.size();
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const float weight = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
      if (weight <= 0) continue;
      // Pixels beyond the border mirror those at it.
      const int x = std::clamp(static_cast<int>(x0) + i, 0, table.width - 1);
      const int y = std::clamp(static_cast<int>(y0) + j, 0, table.height - 1);
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(table.width) +
          static_cast<std::size_t>(x);
      const auto add = table.has_missing() ? add_pixel_with_missing : add_pixel;
      add(table.values.data() + pixel * entries * 3, table.slots.data(), entries, weight, window);
    }
}

void look_up_window(const WindowFrame& frame, std::size_t count, const float* x, const float* y,
                    const float* z, float* values, float* squares) {
  const float packed[10] = {frame.origin.x,  frame.origin.y,     frame.origin.z,  frame.along_x.x,
                            frame.along_x.y, frame.along_x.z,    frame.along_y.x, frame.along_y.y,
                            frame.along_y.z, frame.pixels_per_mm};
  constexpr std::size_t batch = 256;
  int tap[batch];
  float fx[batch], fy[batch];
  const auto blend = frame.has_missing ? blend_taps_with_missing : blend_taps;
  for (std::size_t first = 0; first < count; first += batch) {
    const std::size_t n = std::min(batch, count - first);
    find_taps(packed, frame.side, n, x + first, y + first, z + first, tap, fx, fy, squares + first);
    blend(frame.window, frame.side, n, tap, fx, fy, values + 4 * first);
  }
}

std::size_t gather_table_bytes(const TableHeader& header) {
  const auto side = static_cast<std::size_t>(2 * window_half(header) + 1);
  const std::size_t entries = header.offsets.size() * (header.symmetric ? 2 : 1);
  const std::size_t copies = header.symmetric ? 1 : 2;
  return copies * header.pixels() * entries * 3 * sizeof(float) +
         32 * side * side * 8 * sizeof(float);
}

}  // namespace parian

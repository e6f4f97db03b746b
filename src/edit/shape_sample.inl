// sample_shapes for one instruction set, in namespace PARIAN_VECTOR_SPACE with
// vectors of PARIAN_VECTOR_BYTES.
namespace parian::PARIAN_VECTOR_SPACE {
namespace {

using FloatLanes = float __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
using IntLanes = std::int32_t __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
constexpr std::size_t float_lanes = PARIAN_VECTOR_BYTES / sizeof(float);

[[gnu::always_inline]] inline FloatLanes load_floats(const float* from) {
  FloatLanes row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

[[gnu::always_inline]] inline FloatLanes fill_floats(float x) { return x - FloatLanes{}; }

}  // namespace

// The places radius[k] * scale of neighbouring lanes lie in few segments: those between the segment
// of the smallest and that of the largest scale are looked through, in place of a search per lane.
void sample_shapes(const ShapeRows& rows, const float* scale, float* out) {
  const std::size_t last = rows.knots - 1, stride = shape_lanes;
  const float end = rows.radius[last];
  for (std::size_t i = 0; i < shape_lanes; i += float_lanes) {
    const auto [least, largest] = std::minmax_element(scale + i, scale + i + float_lanes);
    const FloatLanes scales = load_floats(scale + i), slope = load_floats(rows.tail_slope + i),
                     support = load_floats(rows.support + i);
    std::size_t low = 0, high = 0;  // segments
    for (std::size_t k = 0; k <= last; ++k) {
      const float radius = rows.radius[k];
      while (low + 1 < last && rows.radius[low + 1] <= radius * *least) ++low;
      while (high + 1 < last && rows.radius[high + 1] <= radius * *largest) ++high;
      const FloatLanes r = radius * scales;
      const FloatLanes inside = r < end ? r : fill_floats(end);
      FloatLanes a = load_floats(rows.value + low * stride + i),
                 b = load_floats(rows.value + (low + 1) * stride + i),
                 start = fill_floats(rows.radius[low]),
                 inverse = fill_floats(rows.inverse_length[low]);
      for (std::size_t j = low + 1; j <= high; ++j) {
        const IntLanes beyond = inside >= rows.radius[j];
        const FloatLanes next = load_floats(rows.value + (j + 1) * stride + i);
        a = beyond ? b : a;
        b = beyond ? next : b;
        start = beyond ? fill_floats(rows.radius[j]) : start;
        inverse = beyond ? fill_floats(rows.inverse_length[j]) : inverse;
      }
      const FloatLanes y = a + (inside - start) * inverse * (b - a) + (r - inside) * slope;
      const FloatLanes row = r <= support ? y : fill_floats(log_of_zero);
      std::memcpy(out + k * shape_lanes + i, &row, sizeof row);
    }
  }
}

}  // namespace parian::PARIAN_VECTOR_SPACE

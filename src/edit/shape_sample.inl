// sample_shapes and mix_shapes for one instruction set, on shape_lanes.inl.
namespace parian::PARIAN_VECTOR_SPACE {

// The places radius[k] * scale of neighbouring lanes lie in few segments: those between the segment
// of the smallest and that of the largest scale are looked through, in place of a search per lane.
void sample_shapes(const ShapeRows& rows, const float* scale, float* out) {
  const std::size_t last = rows.knots - 1, stride = shape_lanes;
  const float end = rows.radius[last];
  for (std::size_t i = 0; i < shape_lanes; i += float_lanes) {
    float least = scale[i], largest = scale[i];
    for (std::size_t j = i + 1; j < i + float_lanes; ++j) {
      least = scale[j] < least ? scale[j] : least;
      largest = scale[j] > largest ? scale[j] : largest;
    }
    const FloatLanes scales = load_floats(scale + i), slope = load_floats(rows.tail_slope + i),
                     support = load_floats(rows.support + i);
    std::size_t low = 0, high = 0;  // segments
    for (std::size_t k = 0; k <= last; ++k) {
      const float radius = rows.radius[k];
      while (low + 1 < last && rows.radius[low + 1] <= radius * least) ++low;
      while (high + 1 < last && rows.radius[high + 1] <= radius * largest) ++high;
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

void mix_shapes(const float* a, const float* a_shift, const float* b, const float* b_shift,
                const float* w, std::size_t knots, float* out) {
  for (std::size_t k = 0; k < knots; ++k) {
    alignas(64) float top[shape_lanes], of_top[shape_lanes], low[shape_lanes];
    for (std::size_t i = 0; i < shape_lanes; i += float_lanes) {
      const std::size_t at = k * shape_lanes + i;
      const FloatLanes ya = load_floats(a + at) + load_floats(a_shift + i),
                       yb = load_floats(b + at) + load_floats(b_shift + i),
                       of_b = load_floats(w + i);
      const IntLanes first = ya > yb;  // the larger of both counts as 1
      const FloatLanes larger = first ? ya : yb, part = first ? 1.0f - of_b : of_b;
      const FloatLanes below = (first ? yb : ya) - larger;
      const FloatLanes cut = below < -80.0f ? fill_floats(-80.0f) : below;
      std::memcpy(top + i, &larger, sizeof larger);
      std::memcpy(of_top + i, &part, sizeof part);
      std::memcpy(low + i, &cut, sizeof cut);
    }
    FloatRow part, x, sum;
    std::memcpy(&part, of_top, sizeof part);
    std::memcpy(&x, low, sizeof x);
    std::memcpy(&sum, top, sizeof sum);
    sum += log_of_normal<FloatRow, IntRow>(part + (1.0f - part) * exp_of_small<FloatRow, IntRow>(x));
    std::memcpy(out + k * shape_lanes, &sum, sizeof sum);
  }
}

ShapeVariant variant(const char* name) {
  return {name, sum_segments, find_crossings, finish_shapes, sample_shapes, mix_shapes};
}

}  // namespace parian::PARIAN_VECTOR_SPACE

// sum_segments, find_crossings and finish_shapes for one instruction set, on shape_lanes.inl.
namespace parian::PARIAN_VECTOR_SPACE {
namespace {

// e^x = 2^k e^f with |f| <= ln 2 / 2 and the polynomial of degree 10 that is nearest to e^f there:
// 2e-16 and rounding. |x| <= 700.
template <typename Vector, typename Whole>
[[gnu::always_inline]] inline Vector exp_vector(Vector x) {
  constexpr double log2_e = 1.4426950408889634, ln2 = 0.6931471805599453;
  constexpr double round = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  const Vector shifted = x * log2_e + round;
  const Vector f = x - (shifted - round) * ln2;
  const Vector f2 = f * f, f4 = f2 * f2;  // by halves, so that little waits for the one before
  const Vector low =
      (1.0 + f * 1.0000000000000067) + f2 * (0.50000000000000056 + f * 0.16666666666554405);
  const Vector middle = (0.041666666666573143 + f * 0.0083333333856677825) +
                        f2 * (0.0013888888932488598 + f * 0.00019841170270440068);
  const Vector high =
      (2.4801504346997687e-5 + f * 2.7640180796209851e-6) + f2 * 2.7626357241447223e-7;
  const Vector p = low + f4 * (middle + f4 * high);
  const Whole power = __builtin_bit_cast(Whole, shifted) << 52;
  return __builtin_bit_cast(Vector, __builtin_bit_cast(Whole, p) + power);
}

[[gnu::always_inline]] inline Lanes clamp_lanes(Lanes x) {
  return least_of(largest_of(x, fill_lanes(-700)), fill_lanes(700));
}

// p[i] = e^y[i], |y| cut at 700.
[[gnu::always_inline]] inline void exp_block(const Lanes* y, Lanes* p) {
  for (std::size_t i = 0; i < shape_lanes / lanes; i += group) {
    Lanes clamped[group];
    for (std::size_t j = 0; j < group; ++j) clamped[j] = clamp_lanes(y[i + j]);
    LaneGroup x;
    std::memcpy(&x, clamped, sizeof x);
    x = exp_vector<LaneGroup, WholeLaneGroup>(x);
    std::memcpy(p + i, &x, sizeof x);
  }
}

// int exp(y) r dr over the segment of length h about radius m where y rises by beta and P = e^y
// from p0 to p1: h m I0 + h^2 I1, I0 = int_{-1/2}^{1/2} P(t) dt = (p1 - p0) / beta and
// I1 = int t P dt = ((p0 + p1) / 2 - I0) / beta; near beta = 0 their series, 6e-14 or better.
constexpr double least_square = 0.0025;  // of beta, for the closed form
template <bool is_steep>
[[gnu::always_inline]] inline Lanes integrate_lanes(Lanes hm, Lanes hh, Lanes beta, Lanes p0,
                                                    Lanes p1) {
  const Lanes middle = 0.5 * (p0 + p1), inverse = 1.0 / beta;
  Lanes i0 = (p1 - p0) * inverse;
  Lanes i1 = (middle - i0) * inverse;
  if constexpr (!is_steep) {
    const Lanes z = beta * beta;
    const WholeLanes small = z < least_square;
    const Lanes series0 = 1.0 + z * (-1.0 / 12 + z * (1.0 / 120 + z * (-17.0 / 20160)));
    const Lanes series1 = 1.0 / 12 + z * (-1.0 / 120 + z * (17.0 / 20160));
    i0 = small ? middle * series0 : i0;
    i1 = small ? middle * beta * series1 : i1;
  }
  return hm * i0 + hh * i1;
}

// Adds the segments of all lanes that rise by `rise`.
constexpr std::size_t vectors = shape_lanes / lanes;
template <bool is_steep>
[[gnu::always_inline]] inline void add_segments(Lanes hm, Lanes hh, const Lanes* rise,
                                                const Lanes* p0, const Lanes* p1, Lanes* sum) {
  for (std::size_t i = 0; i < vectors; ++i)
    sum[i] += integrate_lanes<is_steep>(hm, hh, rise[i], p0[i], p1[i]);
}

}  // namespace

void sum_segments(const float* rows, std::size_t stride, const double* radius, std::size_t knots,
                  ShapeSums* sums) {
  Lanes y[vectors], rise[vectors], values[2][vectors], sum[vectors]{};
  for (std::size_t i = 0; i < vectors; ++i) y[i] = load_lanes(rows + i * lanes);
  exp_block(y, values[0]);
  for (std::size_t k = 1; k < knots; ++k) {
    const Lanes* before = values[(k - 1) % 2];
    Lanes* here = values[k % 2];
    Lanes least = fill_lanes(least_square);
    for (std::size_t i = 0; i < vectors; ++i) {
      const Lanes row = load_lanes(rows + k * stride + i * lanes);
      rise[i] = row - y[i];
      least = least_of(least, rise[i] * rise[i]);
      y[i] = row;
    }
    exp_block(y, here);
    const double h = radius[k] - radius[k - 1], m = 0.5 * (radius[k - 1] + radius[k]);
    if (any_below(least, least_square))
      add_segments<false>(fill_lanes(h * m), fill_lanes(h * h), rise, before, here, sum);
    else
      add_segments<true>(fill_lanes(h * m), fill_lanes(h * h), rise, before, here, sum);
  }
  std::memcpy(sums->value, values[(knots - 1) % 2], sizeof values[0]);
  std::memcpy(sums->integral, sum, sizeof sum);
}

void find_crossings(const float* rows, std::size_t stride, std::size_t knots,
                    ShapeCrossings* crossings) {
  for (std::size_t i = 0; i < shape_lanes; i += float_lanes) {
    FloatLanes top = load_floats(rows + i);
    for (std::size_t k = 1; k < knots; ++k) {
      const FloatLanes row = load_floats(rows + k * stride + i);
      top = row > top ? row : top;
    }
    const FloatLanes level = top - static_cast<float>(log_of_support);
    FloatLanes before = load_floats(rows + i), segment = fill_floats(-1);
    for (std::size_t k = 1; k < knots; ++k) {
      const FloatLanes row = load_floats(rows + k * stride + i);
      const IntLanes crosses = (before > level) & (row <= level);
      segment = crosses ? fill_floats(static_cast<float>(k - 1)) : segment;
      before = row;
    }
    std::memcpy(crossings->top + i, &top, sizeof top);
    std::memcpy(crossings->segment + i, &segment, sizeof segment);
  }
}

void finish_shapes(const float* before, const float* end, double last_radius, double last_length,
                   const ShapeCrossings* crossings, ShapeSums* sums) {
  const double least = -min_tail_decay / last_radius, limit = (support_limit - 1) * last_radius;
  const double inverse_length = 1 / last_length;
  for (std::size_t i = 0; i < shape_lanes; i += lanes) {
    const Lanes y = load_lanes(end + i);
    const Lanes last_slope = (y - load_lanes(before + i)) * inverse_length;
    const Lanes slope = least_of(last_slope, fill_lanes(least));
    const Lanes level = load_lanes(crossings->top + i) - log_of_support;
    Lanes tail = (level - y) / slope;
    tail = least_of(tail, fill_lanes(limit));
    tail = y > level ? tail : Lanes{};
    const Lanes beta = slope * tail, p0 = load_lanes(sums->value + i);
    const Lanes more =
        integrate_lanes<false>(tail * (last_radius + 0.5 * tail), tail * tail, beta, p0,
                               p0 * exp_vector<Lanes, WholeLanes>(clamp_lanes(beta)));
    const Lanes total = 2 * std::numbers::pi * (load_lanes(sums->integral + i) + more);
    std::memcpy(&sums->integral[i], &total, sizeof total);
    std::memcpy(&sums->tail[i], &tail, sizeof tail);
  }
}

}  // namespace parian::PARIAN_VECTOR_SPACE

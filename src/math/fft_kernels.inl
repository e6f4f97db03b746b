// The transforms of fft.h, included once per instruction set with PARIAN_FFT_SPACE naming the
// namespace and `pocketfft` renamed, so that no code of one set leaks into another.
//
// pocketfft's plans transform vectors of lines at once. Its own drivers gather those lines value by
// value, which takes longer than the transforms. Here columns come first, whose values lie side by
// side already; their spectra are transposed in registers into blocks of frequencies along y, in
// which rows lie side by side again.
namespace parian::PARIAN_FFT_SPACE {

typedef float FloatLanes __attribute__((vector_size(32)));
typedef double DoubleLanes __attribute__((vector_size(32)));
template <typename Real>
struct LanesOf;
template <>
struct LanesOf<float> {
  using type = FloatLanes;
};
template <>
struct LanesOf<double> {
  using type = DoubleLanes;
};
template <typename Real>
using Lanes = typename LanesOf<Real>::type;

// Rows become columns.
inline void transpose(FloatLanes* r) {
  FloatLanes t[8], u[8];
  for (int i = 0; i < 8; i += 2) {
    t[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    t[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int i = 0; i < 8; i += 4) {
    u[i] = __builtin_shufflevector(t[i], t[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
    u[i + 1] = __builtin_shufflevector(t[i], t[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    u[i + 2] = __builtin_shufflevector(t[i + 1], t[i + 3], 0, 1, 8, 9, 4, 5, 12, 13);
    u[i + 3] = __builtin_shufflevector(t[i + 1], t[i + 3], 2, 3, 10, 11, 6, 7, 14, 15);
  }
  for (int i = 0; i < 4; ++i) {
    r[i] = __builtin_shufflevector(u[i], u[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    r[i + 4] = __builtin_shufflevector(u[i], u[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}
inline void transpose(DoubleLanes* r) {
  const DoubleLanes t0 = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6),
                    t1 = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
  const DoubleLanes t2 = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6),
                    t3 = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
  r[0] = __builtin_shufflevector(t0, t2, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(t1, t3, 0, 1, 4, 5);
  r[2] = __builtin_shufflevector(t0, t2, 2, 3, 6, 7);
  r[3] = __builtin_shufflevector(t1, t3, 2, 3, 6, 7);
}

template <typename Real>
struct Frame {
  using Vector = Lanes<Real>;
  using Complex = pocketfft::detail::cmplx<Vector>;
  static constexpr int lanes = static_cast<int>(spectrum_lanes<Real>);

  int columns, rows, half, blocks;
  std::shared_ptr<pocketfft::detail::pocketfft_r<Real>> column_plan;
  std::shared_ptr<pocketfft::detail::pocketfft_c<Real>> row_plan;
  pocketfft::detail::arr<Vector> line;  // `lanes` columns

  explicit Frame(const FftGrid& grid)
      : columns(grid.padded_width),
        rows(grid.padded_height),
        half(rows / 2 + 1),
        blocks((half + lanes - 1) / lanes),
        column_plan(pocketfft::detail::get_plan<pocketfft::detail::pocketfft_r<Real>>(
            static_cast<std::size_t>(rows))),
        row_plan(pocketfft::detail::get_plan<pocketfft::detail::pocketfft_c<Real>>(
            static_cast<std::size_t>(columns))),
        line(static_cast<std::size_t>(rows)) {}

  // Rows of frequencies [b lanes, (b + 1) lanes) along y.
  Complex* block(Real* spectrum, int b) const {
    return reinterpret_cast<Complex*>(spectrum) + static_cast<std::ptrdiff_t>(b) * columns;
  }
};

// line[y] = the values of `count` columns at y, zeros below and in missing columns.
template <typename Real>
void load_columns(Frame<Real>& frame, const Real* columns, int width, int height, int count) {
  using Vector = Lanes<Real>;
  for (int y = 0; y < height; ++y) {
    const Real* from = columns + static_cast<std::ptrdiff_t>(y) * width;
    Vector value{};
    if (count == Frame<Real>::lanes) {
      std::memcpy(&value, from, sizeof(Vector));
    } else {
      for (int i = 0; i < count; ++i) value[i] = from[i];
    }
    frame.line[static_cast<std::size_t>(y)] = value;
  }
  for (int y = height; y < frame.rows; ++y) frame.line[static_cast<std::size_t>(y)] = Vector{};
}

template <typename Real>
void store_columns(const Frame<Real>& frame, Real* columns, int width, int height, int count) {
  using Vector = Lanes<Real>;
  for (int y = 0; y < height; ++y) {
    const Vector value = frame.line[static_cast<std::size_t>(y)];
    Real* to = columns + static_cast<std::ptrdiff_t>(y) * width;
    if (count == Frame<Real>::lanes) {
      std::memcpy(to, &value, sizeof(Vector));
    } else {
      for (int i = 0; i < count; ++i) to[i] = value[i];
    }
  }
}

// Where frequency f of a column's transform lies in pocketfft's order r0, r1, i1, r2, i2, ...; -1:
// zero.
inline int real_index(int f, int half) {
  return f >= half ? -1 : f == 0 ? 0 : 2 * f - 1;
}
inline int imaginary_index(int f, int half, int rows) {
  return f == 0 || f >= half || 2 * f >= rows ? -1 : 2 * f;
}

template <typename Real>
void columns_to_blocks(Frame<Real>& frame, Real* spectrum, int x) {
  constexpr int lanes = Frame<Real>::lanes;
  using Vector = Lanes<Real>;
  const auto entry = [&](int index) {
    return index < 0 ? Vector{} : frame.line[static_cast<std::size_t>(index)];
  };
  const int count = std::min(lanes, frame.columns - x);
  for (int b = 0; b < frame.blocks; ++b) {
    Vector real[lanes], imaginary[lanes];
    for (int i = 0; i < lanes; ++i) {
      const int f = b * lanes + i;
      real[i] = entry(real_index(f, frame.half));
      imaginary[i] = entry(imaginary_index(f, frame.half, frame.rows));
    }
    transpose(real);
    transpose(imaginary);
    auto* row = frame.block(spectrum, b) + x;
    for (int i = 0; i < count; ++i) row[i].Set(real[i], imaginary[i]);
  }
}

template <typename Real>
void blocks_to_columns(Frame<Real>& frame, Real* spectrum, int x) {
  constexpr int lanes = Frame<Real>::lanes;
  using Vector = Lanes<Real>;
  const int count = std::min(lanes, frame.columns - x);
  for (int b = 0; b < frame.blocks; ++b) {
    Vector real[lanes] = {}, imaginary[lanes] = {};
    const auto* row = frame.block(spectrum, b) + x;
    for (int i = 0; i < count; ++i) {
      real[i] = row[i].r;
      imaginary[i] = row[i].i;
    }
    transpose(real);
    transpose(imaginary);
    for (int i = 0; i < lanes; ++i) {
      const int f = b * lanes + i, r = real_index(f, frame.half),
                m = imaginary_index(f, frame.half, frame.rows);
      if (r >= 0) frame.line[static_cast<std::size_t>(r)] = real[i];
      if (m >= 0) frame.line[static_cast<std::size_t>(m)] = imaginary[i];
    }
  }
}

template <typename Real>
void forward(const FftGrid& grid, const Real* plane, int width, int height, Real* spectrum) {
  constexpr int lanes = Frame<Real>::lanes;
  Frame<Real> frame(grid);
  int x = 0;
  for (; x < width; x += lanes) {
    load_columns(frame, plane + x, width, height, std::min(lanes, width - x));
    frame.column_plan->exec(frame.line.data(), Real(1), true);
    columns_to_blocks(frame, spectrum, x);
  }
  for (int b = 0; b < frame.blocks; ++b) {
    auto* row = frame.block(spectrum, b);
    if (x < frame.columns)
      std::memset(static_cast<void*>(row + x), 0,
                  static_cast<std::size_t>(frame.columns - x) * sizeof(*row));
    frame.row_plan->exec(row, Real(1), true);
  }
}

template <typename Real>
void inverse(const FftGrid& grid, Real* spectrum, Real* plane) {
  constexpr int lanes = Frame<Real>::lanes;
  Frame<Real> frame(grid);
  const Real factor =
      Real(1) / (static_cast<Real>(grid.padded_width) * static_cast<Real>(grid.padded_height));
  for (int b = 0; b < frame.blocks; ++b)
    frame.row_plan->exec(frame.block(spectrum, b), Real(1), false);
  for (int x = 0; x < grid.width; x += lanes) {
    blocks_to_columns(frame, spectrum, x);
    frame.column_plan->exec(frame.line.data(), factor, false);
    store_columns(frame, plane + x, grid.width, grid.height, std::min(lanes, grid.width - x));
  }
}

void forward_float(const FftGrid& grid, const float* plane, int width, int height,
                   float* spectrum) {
  forward(grid, plane, width, height, spectrum);
}
void forward_double(const FftGrid& grid, const double* plane, int width, int height,
                    double* spectrum) {
  forward(grid, plane, width, height, spectrum);
}
void inverse_float(const FftGrid& grid, float* spectrum, float* plane) {
  inverse(grid, spectrum, plane);
}
void inverse_double(const FftGrid& grid, double* spectrum, double* plane) {
  inverse(grid, spectrum, plane);
}

}  // namespace parian::PARIAN_FFT_SPACE

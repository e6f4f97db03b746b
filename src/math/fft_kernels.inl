// The transforms of fft.h over pocketfft, included once per instruction set with PARIAN_FFT_SPACE
// naming the namespace and `pocketfft` renamed, so that no code of one set leaks into another.
namespace parian::PARIAN_FFT_SPACE {

inline constexpr int block_rows = 16;  // rows that are padded at a time, to stay in cache

template <typename Real>
pocketfft::stride_t row_strides(std::ptrdiff_t row) {
  const auto size = static_cast<std::ptrdiff_t>(sizeof(Real));
  return {row * size, size};
}

template <typename Real>
void transform_columns(const FftGrid& grid, std::complex<Real>* spectrum, bool forward) {
  const auto strides = row_strides<std::complex<Real>>(grid.spectrum_width);
  pocketfft::c2c(
      {static_cast<std::size_t>(grid.padded_height), static_cast<std::size_t>(grid.spectrum_width)},
      strides, strides, {0}, forward, spectrum, spectrum, Real(1));
}

template <typename Real>
void forward(const FftGrid& grid, const Real* plane, int width, int height,
             std::complex<Real>* spectrum) {
  const auto padded = static_cast<std::size_t>(grid.padded_width);
  const auto half = static_cast<std::size_t>(grid.spectrum_width);
  std::vector<Real> rows(padded * block_rows);
  for (int y = 0; y < height; y += block_rows) {
    const auto count = static_cast<std::size_t>(std::min(block_rows, height - y));
    for (std::size_t i = 0; i < count; ++i)
      std::copy_n(plane + (static_cast<std::size_t>(y) + i) * static_cast<std::size_t>(width),
                  width, &rows[i * padded]);
    pocketfft::r2c({count, padded}, row_strides<Real>(grid.padded_width),
                   row_strides<std::complex<Real>>(grid.spectrum_width), 1, true, rows.data(),
                   spectrum + static_cast<std::size_t>(y) * half, Real(1));
  }
  std::fill(spectrum + static_cast<std::size_t>(height) * half, spectrum + grid.spectrum_size(),
            std::complex<Real>());
  transform_columns(grid, spectrum, true);
}

template <typename Real>
void inverse(const FftGrid& grid, std::complex<Real>* spectrum, Real* plane) {
  const auto padded = static_cast<std::size_t>(grid.padded_width);
  const auto half = static_cast<std::size_t>(grid.spectrum_width);
  const Real factor =
      Real(1) / (static_cast<Real>(grid.padded_width) * static_cast<Real>(grid.padded_height));
  transform_columns(grid, spectrum, false);
  std::vector<Real> rows(padded * block_rows);
  for (int y = 0; y < grid.height; y += block_rows) {
    const auto count = static_cast<std::size_t>(std::min(block_rows, grid.height - y));
    pocketfft::c2r({count, padded}, row_strides<std::complex<Real>>(grid.spectrum_width),
                   row_strides<Real>(grid.padded_width), 1, false,
                   spectrum + static_cast<std::size_t>(y) * half, rows.data(), factor);
    for (std::size_t i = 0; i < count; ++i)
      std::copy_n(&rows[i * padded], grid.width,
                  plane + (static_cast<std::size_t>(y) + i) * static_cast<std::size_t>(grid.width));
  }
}

void forward_float(const FftGrid& grid, const float* plane, int width, int height,
                   std::complex<float>* spectrum) {
  forward(grid, plane, width, height, spectrum);
}
void forward_double(const FftGrid& grid, const double* plane, int width, int height,
                    std::complex<double>* spectrum) {
  forward(grid, plane, width, height, spectrum);
}
void inverse_float(const FftGrid& grid, std::complex<float>* spectrum, float* plane) {
  inverse(grid, spectrum, plane);
}
void inverse_double(const FftGrid& grid, std::complex<double>* spectrum, double* plane) {
  inverse(grid, spectrum, plane);
}

}  // namespace parian::PARIAN_FFT_SPACE

#include "math/fft.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "base/aligned.h"
#include "base/random.h"

namespace parian {
namespace {

// Sum of squares of a plane = weighted sum of squares of its spectrum.
void check_parseval(const FftGrid& grid, const std::vector<float>& plane,
                    const AlignedVector<float>& spectrum) {
  constexpr std::size_t lanes = spectrum_lanes<float>;
  std::vector<float> weights(grid.frequencies<float>());
  fill_parseval_weights(grid, weights.data());
  double squares = 0, spectral = 0;
  for (float v : plane) squares += static_cast<double>(v) * static_cast<double>(v);
  for (std::size_t i = 0; i < spectrum.size(); ++i)
    spectral += static_cast<double>(weights[i / (2 * lanes) * lanes + i % lanes]) *
                static_cast<double>(spectrum[i]) * static_cast<double>(spectrum[i]);
  EXPECT_NEAR(spectral / squares, 1, 1e-6);
}

template <typename Real>
void check_round_trip_and_convolution(int w, int h, double tolerance) {
  const int reach = 3;
  const FftGrid grid = make_fft_grid(w, h, reach, reach);
  Rng rng = make_rng(1);
  std::vector<Real> plane(grid.pixels()), result(grid.pixels());
  for (Real& v : plane) v = static_cast<Real>(sample_uniform(rng) - 0.5);
  AlignedVector<Real> spectrum(2 * grid.frequencies<Real>());
  forward_fft(grid, plane.data(), spectrum.data());
  if constexpr (sizeof(Real) == sizeof(float)) check_parseval(grid, plane, spectrum);
  auto copy = spectrum;
  inverse_fft(grid, copy.data(), result.data());
  for (std::size_t i = 0; i < plane.size(); ++i) EXPECT_NEAR(result[i], plane[i], tolerance);

  // A kernel with one tap at (2, -3) shifts, with zeros from outside.
  std::vector<Real> padded(static_cast<std::size_t>(grid.padded_width * grid.padded_height));
  padded[static_cast<std::size_t>((grid.padded_height - 3) * grid.padded_width + 2)] = 1;
  AlignedVector<Real> kernel(spectrum.size());
  forward_fft_padded(grid, padded.data(), kernel.data());
  const std::size_t lanes = spectrum_lanes<Real>;
  for (std::size_t f = 0; f < spectrum.size() / 2; ++f) {
    const std::size_t re = f / lanes * 2 * lanes + f % lanes, im = re + lanes;
    const Real a = spectrum[re], b = spectrum[im];
    spectrum[re] = a * kernel[re] - b * kernel[im];
    spectrum[im] = a * kernel[im] + b * kernel[re];
  }
  inverse_fft(grid, spectrum.data(), result.data());
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const bool inside = x - 2 >= 0 && y + 3 < h;
      const Real expected = inside ? plane[static_cast<std::size_t>((y + 3) * w + x - 2)] : Real(0);
      EXPECT_NEAR(result[static_cast<std::size_t>(y * w + x)], expected, tolerance);
    }
  }
}

// Odd and even sizes, below and above a register's lanes.
constexpr std::pair<int, int> sizes[] = {{13, 9}, {5, 7}, {24, 16}, {22, 33}, {4, 4}};

TEST(Fft, DoubleRoundTripsAndConvolvesWithoutWrapping) {
  for (const auto& [w, h] : sizes) check_round_trip_and_convolution<double>(w, h, 1e-14);
}
TEST(Fft, FloatRoundTripsAndConvolvesWithoutWrapping) {
  for (const auto& [w, h] : sizes) check_round_trip_and_convolution<float>(w, h, 1e-6);
}

TEST(Fft, GridSizesAreFastAndLargeEnough) {
  const FftGrid grid = make_fft_grid(222, 88, 24, 24);
  EXPECT_EQ(grid.padded_width, 250);
  EXPECT_EQ(grid.padded_height, 120);
  EXPECT_EQ(grid.frequencies<float>(), 250u * 64u);  // 61 along y in whole registers
}

}  // namespace
}  // namespace parian

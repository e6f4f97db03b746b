#include "math/fft.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/random.h"

namespace parian {
namespace {

template <typename Real>
void check_round_trip_and_convolution(double tolerance) {
  const int w = 13, h = 9, reach = 3;
  const FftGrid grid = make_fft_grid(w, h, reach, reach);
  Rng rng = make_rng(1);
  std::vector<Real> plane(grid.pixels()), result(grid.pixels());
  for (Real& v : plane) v = static_cast<Real>(sample_uniform(rng) - 0.5);
  std::vector<std::complex<Real>> spectrum(grid.spectrum_size());
  forward_fft(grid, plane.data(), spectrum.data());
  auto copy = spectrum;
  inverse_fft(grid, copy.data(), result.data());
  for (std::size_t i = 0; i < plane.size(); ++i) EXPECT_NEAR(result[i], plane[i], tolerance);

  // A kernel with one tap at (2, -3) shifts, with zeros from outside.
  std::vector<double> padded(static_cast<std::size_t>(grid.padded_width * grid.padded_height));
  padded[static_cast<std::size_t>((grid.padded_height - 3) * grid.padded_width + 2)] = 1;
  std::vector<std::complex<double>> kernel(grid.spectrum_size());
  forward_fft_padded(grid, padded.data(), kernel.data());
  for (std::size_t i = 0; i < kernel.size(); ++i) spectrum[i] *= std::complex<Real>(kernel[i]);
  inverse_fft(grid, spectrum.data(), result.data());
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const bool inside = x - 2 >= 0 && y + 3 < h;
      const Real expected = inside ? plane[static_cast<std::size_t>((y + 3) * w + x - 2)] : Real(0);
      EXPECT_NEAR(result[static_cast<std::size_t>(y * w + x)], expected, tolerance);
    }
  }
}

TEST(Fft, DoubleRoundTripsAndConvolvesWithoutWrapping) {
  check_round_trip_and_convolution<double>(1e-14);
}
TEST(Fft, FloatRoundTripsAndConvolvesWithoutWrapping) {
  check_round_trip_and_convolution<float>(1e-6);
}

TEST(Fft, GridSizesAreFastAndLargeEnough) {
  const FftGrid grid = make_fft_grid(222, 88, 24, 24);
  EXPECT_EQ(grid.padded_width, 250);
  EXPECT_EQ(grid.padded_height, 120);
  EXPECT_EQ(grid.spectrum_width, 126);
}

}  // namespace
}  // namespace parian

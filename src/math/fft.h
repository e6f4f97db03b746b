// Real two-dimensional Fourier transforms of zero-padded planes, for exact (not cyclic)
// convolutions of images, over pocketfft. Deterministic: the same bits on every processor type up
// to libm's sine and cosine.
#pragma once

#include <cstddef>

namespace parian {

// Frequencies that lie side by side in a spectrum: those of one 32-byte register.
template <typename Real>
inline constexpr std::size_t spectrum_lanes = 32 / sizeof(Real);

// Planes of height x width values, row major, seen as the corner of a zero-padded grid.
struct FftGrid {
  int width = 0, height = 0;
  int padded_width = 0, padded_height = 0;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t padded_pixels() const {
    return static_cast<std::size_t>(padded_width) * static_cast<std::size_t>(padded_height);
  }
  // Entries of a real-valued function of frequency; a few at the end of each block are padding.
  template <typename Real>
  std::size_t frequencies() const {
    constexpr std::size_t lanes = spectrum_lanes<Real>;
    const std::size_t half = static_cast<std::size_t>(padded_height) / 2 + 1;
    return (half + lanes - 1) / lanes * lanes * static_cast<std::size_t>(padded_width);
  }
};

// Spectra are opaque but for this: frequency f = lanes * g + l has its real part at 2 lanes g + l
// and its imaginary part lanes further on, so a spectrum has 2 frequencies() values; f = 0 is the
// mean's. They must start on a multiple of 32 bytes (AlignedVector).

// The smallest fast sizes with at least `reach_x` and `reach_y` zeros beside the data, so that
// kernels of that reach do not wrap around.
FftGrid make_fft_grid(int width, int height, int reach_x, int reach_y);

// Unnormalised forward transform of a plane. May be called from several threads.
void forward_fft(const FftGrid& grid, const float* plane, float* spectrum);
void forward_fft(const FftGrid& grid, const double* plane, double* spectrum);

// Normalised inverse; writes the corner that holds the plane. Destroys the spectrum.
void inverse_fft(const FftGrid& grid, float* spectrum, float* plane);
void inverse_fft(const FftGrid& grid, double* spectrum, double* plane);

// Forward transform of a full padded_height x padded_width grid, for kernels that are centred on
// index (0, 0) and wrap around.
void forward_fft_padded(const FftGrid& grid, const float* padded, float* spectrum);
void forward_fft_padded(const FftGrid& grid, const double* padded, double* spectrum);

// Weights of |spectrum|^2 per frequency that give the sum of a plane's squares: frequencies stand
// for their mirror images too, padding counts 0.
void fill_parseval_weights(const FftGrid& grid, float* weights);

}  // namespace parian

// Real two-dimensional Fourier transforms of zero-padded planes, for exact (not cyclic)
// convolutions of images. A thin layer over pocketfft: deterministic, the same bits on every
// processor type up to libm's sine and cosine.
#pragma once

#include <complex>
#include <cstddef>

namespace parian {

// Planes of height x width values, row major, seen as the corner of a zero-padded grid. A spectrum
// holds padded_height x spectrum_width complex values, row major: the half that is not redundant.
struct FftGrid {
  int width = 0, height = 0;
  int padded_width = 0, padded_height = 0;
  int spectrum_width = 0;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t spectrum_size() const {
    return static_cast<std::size_t>(padded_height) * static_cast<std::size_t>(spectrum_width);
  }
};

// The smallest fast sizes with at least `reach_x` and `reach_y` zeros beside the data, so that
// kernels of that reach do not wrap around.
FftGrid make_fft_grid(int width, int height, int reach_x, int reach_y);

// Unnormalised forward transform of a plane. May be called from several threads.
void forward_fft(const FftGrid& grid, const float* plane, std::complex<float>* spectrum);
void forward_fft(const FftGrid& grid, const double* plane, std::complex<double>* spectrum);

// Normalised inverse; writes the corner that holds the plane. Destroys the spectrum.
void inverse_fft(const FftGrid& grid, std::complex<float>* spectrum, float* plane);
void inverse_fft(const FftGrid& grid, std::complex<double>* spectrum, double* plane);

// Forward transform of a full padded_height x padded_width grid, for kernels that are centred on
// index (0, 0) and wrap around.
void forward_fft_padded(const FftGrid& grid, const float* padded, std::complex<float>* spectrum);
void forward_fft_padded(const FftGrid& grid, const double* padded, std::complex<double>* spectrum);

}  // namespace parian

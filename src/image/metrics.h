// How far an image is from a reference: mean squared error, PSNR, SSIM, relative errors. Values
// must be finite; grids and channels must agree (a contract check).
#pragma once

#include <cstddef>
#include <vector>

#include "image/image.h"

namespace parian {

// Mean over pixels and channels of the squared difference.
double mse(const Image& reference, const Image& image);

// 10 log10(peak^2 / mse) with peak = the largest value of the reference; +infinity when the images
// are identical.
double psnr_db(const Image& reference, const Image& image);

// Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004): Gaussian window of 11 x 11 pixels
// with sigma = 1.5, K1 = 0.01, K2 = 0.03, L = the largest value of the reference, over the windows
// that lie inside the image, mean over windows and channels; 1 when identical. Along an axis of
// fewer than 11 pixels the window is as long as the image and the Gaussian is centred in it.
double ssim(const Image& reference, const Image& image);

struct RelativeErrors {
  double mean = 0, p99 = 0, max = 0;  // over pixels; p99: exceeded by one in a hundred
  std::size_t pixels = 0;
};
// Of three channels, |a - b| / (|b| + 1e-3 max |b|) with lengths over channels, over the pixels
// that are covered wholly and not black in the reference. `coverage` [y][x] is 0 to 1.
RelativeErrors relative_errors(const Image& reference, const Image& image,
                               const std::vector<float>& coverage);

}  // namespace parian

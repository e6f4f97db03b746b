// Smoothing and sharpening of property planes: the separable Gaussian, the joint bilateral filter
// (Tomasi and Manduchi 1998; Petschnig et al. 2004, Eq. 5) and the unsharp mask. Planes are
// [plane][y][x]; beyond its border an image is continued by half-sample reflection (f(-1-x) =
// f(x)). All results are the same bits for any number of threads.
#pragma once

#include <vector>

namespace parian {

// sigma_px is at most the larger side of the image; every function throws Error for a sigma that is
// negative, larger or not finite, and for a value that is not finite or larger than 1e30 (it names
// plane and pixel).

// G f: the sampled Gaussian, cut at ceil(3 sigma_px) pixels and normalised, first along x, then
// along y. The mean is preserved; sigma_px = 0 copies. `out` may be `in`. Time is O(pixels sigma).
void gaussian_filter(const float* in, int width, int height, double sigma_px, float* out);

// Joint bilateral filter, one weight for all planes:
//   exp(-|dx|²/(2 sigma_px²)) exp(-|g(x) - g(x + dx)|²/(2 sigma_range²))
// over the square window of the Gaussian, normalised, with the distance |.| over all guide planes
// together (scale them to taste; > 0 planes). sigma_range > 0; where it is large this is
// gaussian_filter to rounding. For ceil(3 sigma_px) > 48 only every n-th pixel of the window along
// x and y takes part, n the smallest number that leaves 48 steps to each side: at most 97² weights
// a pixel whatever the sigma.
std::vector<float> bilateral_filter(const std::vector<float>& planes, int plane_count,
                                    const std::vector<float>& guide, int guide_count, int width,
                                    int height, double sigma_px, double sigma_range);

// Unsharp mask f + amount (f - G f) of every plane: amount > 0 sharpens, -1 gives G f. The mean is
// preserved. amount is finite, at most 1e6 in magnitude.
std::vector<float> unsharp(const std::vector<float>& planes, int plane_count, int width, int height,
                           double sigma_px, double amount);

}  // namespace parian

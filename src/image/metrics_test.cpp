#include "image/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"

namespace parian {
namespace {

Image make_noise(int width, int height, int channels, std::uint64_t seed) {
  Image image = make_image(width, height, channels);
  Rng rng = make_rng(seed);
  for (float& value : image.values) value = static_cast<float>(sample_uniform(rng));
  return image;
}

// SSIM as written in the paper: for each window the weighted mean, then centred moments.
double direct_ssim(const Image& a, const Image& b) {
  const double peak = *std::max_element(a.values.begin(), a.values.end());
  const double c1 = std::pow(0.01 * peak, 2), c2 = std::pow(0.03 * peak, 2);
  const int nx = std::min(11, a.width), ny = std::min(11, a.height);
  const auto weight = [&](int i, int j) {
    const double u = i - (nx - 1) / 2.0, v = j - (ny - 1) / 2.0;
    return std::exp(-(u * u + v * v) / (2 * 1.5 * 1.5));
  };
  double total = 0;
  int count = 0;
  for (int c = 0; c < a.channels; ++c)
    for (int y = 0; y + ny <= a.height; ++y)
      for (int x = 0; x + nx <= a.width; ++x, ++count) {
        double sum = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
        for (int j = 0; j < ny; ++j)
          for (int i = 0; i < nx; ++i) {
            sum += weight(i, j);
            ma += weight(i, j) * at(a, x + i, y + j, c);
            mb += weight(i, j) * at(b, x + i, y + j, c);
          }
        ma /= sum, mb /= sum;
        for (int j = 0; j < ny; ++j)
          for (int i = 0; i < nx; ++i) {
            const double da = at(a, x + i, y + j, c) - ma, db = at(b, x + i, y + j, c) - mb;
            va += weight(i, j) * da * da / sum;
            vb += weight(i, j) * db * db / sum;
            cov += weight(i, j) * da * db / sum;
          }
        total += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
      }
  return total / count;
}

TEST(Metrics, MseIsTheMeanOverPixelsAndChannels) {
  const Image reference = make_image(2, 1, 3, 1);
  Image image = reference;
  at(image, 1, 0, 2) = 1.5f;
  EXPECT_DOUBLE_EQ(mse(reference, image), 0.25 / 6);
}

TEST(Metrics, PsnrOfAConstantDifferenceIsTheClosedForm) {
  Image reference = make_image(5, 4, 1, 0.25f);
  at(reference, 2, 2, 0) = 2;
  Image image = reference;
  for (float& value : image.values) value += 0.125f;
  EXPECT_NEAR(psnr_db(reference, image), 20 * std::log10(2 / 0.125), 1e-12);
  // The peak is the reference's alone.
  EXPECT_NEAR(psnr_db(image, reference), 20 * std::log10(2.125 / 0.125), 1e-12);
  EXPECT_EQ(psnr_db(reference, reference), std::numeric_limits<double>::infinity());
}

TEST(Metrics, SsimOfIdenticalImagesIsOne) {
  const Image noise = make_noise(16, 13, 3, 1);
  EXPECT_EQ(ssim(noise, noise), 1);
  const Image black = make_image(12, 12, 1);
  EXPECT_EQ(ssim(black, black), 1);
}

TEST(Metrics, SsimOfConstantsIsTheLuminanceTerm) {
  const double a = 0.5, b = 0.25, c1 = std::pow(0.01 * a, 2);
  EXPECT_NEAR(ssim(make_image(14, 12, 3, 0.5f), make_image(14, 12, 3, 0.25f)),
              (2 * a * b + c1) / (a * a + b * b + c1), 1e-12);
}

TEST(Metrics, SsimEqualsItsDefinitionAtAnySize) {
  const int sizes[][2] = {{17, 14}, {11, 11}, {5, 20}, {20, 4}, {1, 1}, {2, 3}};
  for (const auto& size : sizes) {
    const Image a = make_noise(size[0], size[1], 3, 2), b = make_noise(size[0], size[1], 3, 3);
    EXPECT_NEAR(ssim(a, b), direct_ssim(a, b), 1e-10) << size[0] << " x " << size[1];
  }
}

TEST(Metrics, SsimDoesNotDependOnTheUnit) {
  const Image a = make_noise(20, 15, 1, 4), b = make_noise(20, 15, 1, 5);
  EXPECT_NEAR(ssim(scale(a, 64), scale(b, 64)), ssim(a, b), 1e-12);
  EXPECT_NEAR(psnr_db(scale(a, 64), scale(b, 64)), psnr_db(a, b), 1e-9);
}

TEST(Metrics, RelativeErrorsOfKnownDifferences) {
  Image reference = make_image(10, 20, 3, 1), image = reference;
  std::vector<float> coverage(200, 1.0f);
  for (int c = 0; c < 3; ++c) {
    at(image, 0, 0, c) = 1.5f;
    at(image, 1, 0, c) = 1.2f;
    at(image, 2, 0, c) = 9;  // not covered wholly
    at(reference, 3, 0, c) = 0;
  }
  coverage[2] = 0.5f;
  const RelativeErrors errors = relative_errors(reference, image, coverage);
  EXPECT_EQ(errors.pixels, 198u);
  EXPECT_NEAR(errors.max, 0.5 / 1.001, 1e-6);
  EXPECT_NEAR(errors.p99, 0.2 / 1.001, 1e-6);
  EXPECT_NEAR(errors.mean, 0.7 / 1.001 / 198, 1e-6);
}

}  // namespace
}  // namespace parian

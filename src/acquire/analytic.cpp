// The analytic engine: the classic dipole (Jensen et al. 2001) with path-averaged coefficients, a
// row of pixels at a time.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "acquire/path_stencil.h"
#include "acquire/provenance.h"
#include "acquire/sample.h"
#include "base/check.h"
#include "base/hot.h"
#include "math/fast_math.h"

namespace parian {
namespace {

constexpr std::size_t block = 128;  // pixels that the kernels work on at a time

// sum[i] += weight (near[i] + far[i])
PARIAN_HOT void add_pair(const float* PARIAN_RESTRICT near, const float* PARIAN_RESTRICT far,
                         double weight, std::size_t count, double* PARIAN_RESTRICT sum) {
  for (std::size_t i = 0; i < count; ++i)
    sum[i] += weight * (static_cast<double>(near[i]) + static_cast<double>(far[i]));
}

// One source of the dipole, at height z = height_factor / sigma_t':
//   z (sigma_tr + 1/d) / d^2 without e^{-sigma_tr d}, whose exponent goes to `exponent` as a float
// and what that lost into the factor, so that the float exponential costs no accuracy.
PARIAN_HOT void eval_source(const double* PARIAN_RESTRICT sigma_a,
                            const double* PARIAN_RESTRICT sigma_s_prime, double height_factor,
                            double r_squared, std::size_t count, float* PARIAN_RESTRICT exponent,
                            double* PARIAN_RESTRICT factor) {
  for (std::size_t i = 0; i < count; ++i) {
    const double sigma_t_prime = sigma_a[i] + sigma_s_prime[i];
    const double sigma_tr = std::sqrt(3 * sigma_a[i] * sigma_t_prime);
    const double z = height_factor / sigma_t_prime;
    const double d_squared = r_squared + z * z;
    const double d = std::sqrt(d_squared);
    const double exact = -sigma_tr * d;
    exponent[i] = static_cast<float>(exact);
    const double lost = exact - static_cast<double>(exponent[i]);
    factor[i] = z * (sigma_tr * d + 1) / (d_squared * d) * (1 + lost);
  }
}

// R_d = alpha' / 4 pi (real + virtual source)
PARIAN_HOT void add_sources(const double* PARIAN_RESTRICT sigma_a,
                            const double* PARIAN_RESTRICT sigma_s_prime,
                            const double* PARIAN_RESTRICT real_factor,
                            const float* PARIAN_RESTRICT real_exp,
                            const double* PARIAN_RESTRICT virtual_factor,
                            const float* PARIAN_RESTRICT virtual_exp, std::size_t count,
                            float* PARIAN_RESTRICT reflectance) {
  constexpr double smallest = std::numeric_limits<float>::min();
  for (std::size_t i = 0; i < count; ++i) {
    const double alpha_prime = sigma_s_prime[i] / (sigma_a[i] + sigma_s_prime[i]);
    const double sources = real_factor[i] * static_cast<double>(real_exp[i]) +
                           virtual_factor[i] * static_cast<double>(virtual_exp[i]);
    const double value = alpha_prime * (1 / (4 * std::numbers::pi)) * sources;
    reflectance[i] = static_cast<float>(value > smallest ? value : smallest);
  }
}

struct Coefficients {
  std::array<double, block> sigma_a, sigma_s_prime;
};

void eval_dipole_block(const Coefficients& mean, double boundary_factor, double r_squared,
                       std::size_t count, float* reflectance) {
  std::array<std::array<double, block>, 2> factor;
  std::array<std::array<float, block>, 2> exponent, exponential;
  const std::array<double, 2> height{1.0, 1 + 4.0 / 3.0 * boundary_factor};
  for (std::size_t k = 0; k < 2; ++k) {
    eval_source(mean.sigma_a.data(), mean.sigma_s_prime.data(), height[k], r_squared, count,
                exponent[k].data(), factor[k].data());
    exp_array(exponent[k].data(), exponential[k].data(), count);
  }
  add_sources(mean.sigma_a.data(), mean.sigma_s_prime.data(), factor[0].data(),
              exponential[0].data(), factor[1].data(), exponential[1].data(), count, reflectance);
}

TableHeader make_header(const Sample& sample) {
  const std::string provenance = make_provenance(
      "analytic", {"model", "dipole with coefficients averaged along the straight path"},
      sample.description);
  return make_table_header(sample, Boundary::excluded, Sampling::point, provenance);
}

class AnalyticSource : public SliceSource {
 public:
  explicit AnalyticSource(const Sample& sample)
      : header_(make_header(sample)),
        name_(sample.name),
        boundary_factor_(dipole_boundary_factor(sample.eta)),
        sigma_a_(sample.sigma_a),
        sigma_s_prime_(sample.sigma_s_prime) {
    const std::size_t count = static_cast<std::size_t>(header_.channels) * header_.pixels();
    PARIAN_CHECK_EQ(sigma_a_.size(), count);
    PARIAN_CHECK_EQ(sigma_s_prime_.size(), count);
  }

  const TableHeader& header() const override { return header_; }
  std::string name() const override { return name_; }

  void read_slice(int channel, int offset_index, float* slice) const override {
    PARIAN_CHECK(channel >= 0 && channel < header_.channels);
    const Offset offset = header_.offsets.at(static_cast<std::size_t>(offset_index));
    std::fill_n(slice, header_.pixels(), std::numeric_limits<float>::quiet_NaN());
    const std::vector<PathPair> stencil = make_path_stencil(offset);
    const PixelRange range = pairs_in_grid(header_, offset);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; x += static_cast<int>(block))
        eval_block(stencil, offset, channel, x, y, std::min(range.x1 - x, static_cast<int>(block)),
                   slice);
  }

 private:
  std::size_t index_of(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(header_.width) +
           static_cast<std::size_t>(x);
  }

  void eval_block(const std::vector<PathPair>& stencil, Offset offset, int channel, int x, int y,
                  int pixels, float* slice) const {
    const auto count = static_cast<std::size_t>(pixels);
    const std::size_t plane = static_cast<std::size_t>(channel) * header_.pixels();
    const float* sigma_a = sigma_a_.data() + plane;
    const float* sigma_s_prime = sigma_s_prime_.data() + plane;
    Coefficients mean{};
    for (const PathPair& pair : stencil) {
      const std::size_t near = index_of(x + pair.near.dx, y + pair.near.dy);
      const std::size_t far = index_of(x + pair.far.dx, y + pair.far.dy);
      add_pair(sigma_a + near, sigma_a + far, pair.weight, count, mean.sigma_a.data());
      add_pair(sigma_s_prime + near, sigma_s_prime + far, pair.weight, count,
               mean.sigma_s_prime.data());
    }
    const double r = length_px(offset) * header_.pixel_pitch_mm;
    eval_dipole_block(mean, boundary_factor_, r * r, count, slice + index_of(x, y));
  }

  TableHeader header_;
  std::string name_;
  double boundary_factor_;
  std::vector<float> sigma_a_;
  std::vector<float> sigma_s_prime_;
};

}  // namespace

std::unique_ptr<SliceSource> make_analytic_source(const Sample& sample) {
  return std::make_unique<AnalyticSource>(sample);
}

}  // namespace parian

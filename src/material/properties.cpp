#include "material/properties.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace parian {
namespace {

constexpr double two_pi = 6.283185307179586;

// int exp(y) r^2 dr over [r0, r0 + h], y linear from y0 to y1: with r = r0 + h t and moments
// m_k = int exp(beta t) t^k dt it is e^y0 h (r0^2 m_0 + 2 r0 h m_1 + h^2 m_2).
double second_moment(double r0, double h, double y0, double y1) {
  const double beta = y1 - y0;
  double m[3];
  if (std::abs(beta) < 0.1) {  // the recurrence cancels: sum of beta^j / (j! (j + k + 1))
    for (int k = 0; k < 3; ++k) {
      double term = 1;
      m[k] = 0;
      for (int j = 0; j < 12; ++j, term *= beta / j) m[k] += term / (j + k + 1);
    }
  } else {
    m[0] = std::expm1(beta) / beta;
    for (int k = 1; k < 3; ++k) m[k] = (std::exp(beta) - k * m[k - 1]) / beta;
  }
  return std::exp(y0) * h * (r0 * r0 * m[0] + 2 * r0 * h * m[1] + h * h * m[2]);
}

double profile_second_moment(const Profile& profile) {
  const auto& [knots, value, support] = profile;
  double integral = 0;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k)
    integral += second_moment(knots[k], knots[k + 1] - knots[k], value[k], value[k + 1]);
  const double tail = support - knots.back();
  if (tail > 0)
    integral += second_moment(knots.back(), tail, value.back(),
                              value.back() + tail_slope(knots, value) * tail);
  return integral;
}

// ln((1 - w) e^a + w e^b); a or b may be -infinity.
double mix_logs(double a, double b, double w) {
  const double top = std::max(a, b);
  return top + std::log((1 - w) * std::exp(a - top) + w * std::exp(b - top));
}

std::vector<double> mix_knots(const std::vector<double>& a, const std::vector<double>& b,
                              double w) {
  std::vector<double> knots;
  if (a.size() == b.size()) {
    knots.reserve(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) knots.push_back((1 - w) * a[k] + w * b[k]);
    return knots;
  }
  knots.reserve(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(knots));
  const double close = 1e-9 * knots.back();
  const auto is_close = [close](double x, double y) { return y - x < close; };
  knots.erase(std::unique(knots.begin(), knots.end(), is_close), knots.end());
  return knots;
}

Profile mix_shapes(const Profile& a, const Profile& b, double w) {
  Profile mixed;
  mixed.knots_mm = mix_knots(a.knots_mm, b.knots_mm, w);
  mixed.log_value.reserve(mixed.knots_mm.size());
  for (double u : mixed.knots_mm)
    mixed.log_value.push_back(mix_logs(eval_log_profile(a, u), eval_log_profile(b, u), w));
  // Beyond both supports, by rounding of the last knot.
  while (std::isinf(mixed.log_value.back())) {
    mixed.knots_mm.pop_back();
    mixed.log_value.pop_back();
  }
  mixed.support_mm = profile_support(mixed.knots_mm, mixed.log_value);
  return mixed;
}

}  // namespace

double profile_range(const Profile& profile, RangeKind* kind) {
  const auto& [knots, value, support] = profile;
  const double level = *std::max_element(value.begin(), value.end()) + std::log(support_threshold);
  const bool inside = value.back() <= level, limited = support >= support_limit * knots.back();
  if (kind != nullptr)
    *kind = inside ? RangeKind::measured : limited ? RangeKind::limited : RangeKind::extrapolated;
  if (!inside) return support;
  std::size_t k = knots.size() - 1;
  while (value[k - 1] <= level) --k;  // ends before 0: the maximum lies above the level
  const double drop = value[k - 1] - value[k];
  return knots[k - 1] + (knots[k] - knots[k - 1]) * ((value[k - 1] - level) / drop);
}

ProfileProperties measure_properties(const Profile& profile) {
  ProfileProperties properties;
  const double integral = profile_integral(profile);
  properties.albedo = two_pi * integral;
  properties.range_mm = profile_range(profile, &properties.range_kind);
  properties.mean_radius_mm = profile_second_moment(profile) / integral;
  return properties;
}

Profile compose_profile(const Profile& shape, double albedo, double range_mm) {
  PARIAN_CHECK_LT(0.0, albedo);
  PARIAN_CHECK_LT(0.0, range_mm);
  const double stretch = range_mm / profile_range(shape);
  const double shift =
      std::log(albedo / (two_pi * profile_integral(shape))) - 2 * std::log(stretch);
  Profile profile = shape;
  for (double& knot : profile.knots_mm) knot *= stretch;
  for (double& value : profile.log_value) value += shift;
  profile.support_mm = shape.support_mm * stretch;
  return profile;
}

Profile profile_shape(const Profile& profile) {
  return compose_profile(profile, two_pi, 1);
}

Profile blend_profiles(const Profile& a, const Profile& b, const PropertyWeights& weights) {
  if (weights == PropertyWeights{}) return a;
  if (weights == PropertyWeights{1, 1, 1}) return b;
  const auto mix = [](double from, double to, double w) { return (1 - w) * from + w * to; };
  const double albedo = mix(diffuse_albedo(a), diffuse_albedo(b), weights.albedo);
  const double range = mix(profile_range(a), profile_range(b), weights.range);
  if (weights.shape == 0) return compose_profile(a, albedo, range);
  if (weights.shape == 1) return compose_profile(b, albedo, range);
  return compose_profile(mix_shapes(profile_shape(a), profile_shape(b), weights.shape), albedo,
                         range);
}

}  // namespace parian

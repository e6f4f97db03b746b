// Single profiles: evaluation, support, closed-form integrals (algorithms: segment integral).
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "material/field_internal.h"
#include "material/profile_map.h"

namespace parian {
namespace {

void apply(double gain, double dilation, Profile& profile) {
  const double shift = std::log(gain) - 2 * std::log(dilation);
  for (double& knot : profile.knots_mm) knot *= dilation;
  for (double& value : profile.log_value) value += shift;
  profile.support_mm = profile_support(profile.knots_mm, profile.log_value);
}

}  // namespace

double tail_slope(const std::vector<double>& knots_mm, const std::vector<double>& log_value) {
  const std::size_t n = knots_mm.size() - 1;
  const double floor = -min_tail_decay / knots_mm[n];
  if (n == 0) return floor;
  return std::min(floor, (log_value[n] - log_value[n - 1]) / (knots_mm[n] - knots_mm[n - 1]));
}

double segment_integral(double r0, double h, double y0, double y1) {
  const double beta = y1 - y0;
  double phi = 1, psi = 0.5;
  if (std::abs(beta) < 0.01) {  // psi cancels: sum of beta^k / (k! (k + 2))
    phi = 1 + beta / 2 * (1 + beta / 3 * (1 + beta / 4 * (1 + beta / 5 * (1 + beta / 6))));
    psi = 1.0 / 2 +
          beta * (1.0 / 3 + beta * (1.0 / 8 + beta * (1.0 / 30 + beta * (1.0 / 144 + beta / 840))));
  } else {
    phi = std::expm1(beta) / beta;
    psi = (std::exp(beta) - phi) / beta;
  }
  return std::exp(y0) * h * (r0 * phi + h * psi);
}

double profile_support(const std::vector<double>& knots_mm, const std::vector<double>& log_value) {
  const double last = knots_mm.back();
  const double level =
      *std::max_element(log_value.begin(), log_value.end()) + std::log(support_threshold);
  if (!(log_value.back() > level)) return last;
  const double crossing = last + (level - log_value.back()) / tail_slope(knots_mm, log_value);
  return std::min(crossing, support_limit * last);
}

double eval_log_profile(const Profile& profile, double r_mm) {
  const auto& [knots, value, support] = profile;
  if (!(r_mm <= support)) return -std::numeric_limits<double>::infinity();
  if (r_mm >= knots.back()) return value.back() + tail_slope(knots, value) * (r_mm - knots.back());
  const auto upper =
      static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), r_mm) - knots.begin());
  const double w = (r_mm - knots[upper - 1]) / (knots[upper] - knots[upper - 1]);
  return (1 - w) * value[upper - 1] + w * value[upper];
}

double profile_integral(const Profile& profile) {
  const auto& [knots, value, support] = profile;
  double integral = 0;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k)
    integral += segment_integral(knots[k], knots[k + 1] - knots[k], value[k], value[k + 1]);
  const double tail = support - knots.back();
  if (tail > 0)
    integral += segment_integral(knots.back(), tail, value.back(),
                                 value.back() + tail_slope(knots, value) * tail);
  return integral;
}

Profile make_profile(const std::vector<double>& knots_mm, std::vector<double> log_value,
                     double gain, double dilation) {
  Profile profile{knots_mm, std::move(log_value), 0};
  apply(gain, dilation, profile);
  return profile;
}

void get_profile(const ProfileMap& map, int channel, int x, int y, Profile& profile) {
  PARIAN_CHECK(x >= 0 && x < map.width && y >= 0 && y < map.height && channel >= 0 &&
               channel < map.channels);
  const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                            static_cast<std::size_t>(x);
  const std::size_t plane = static_cast<std::size_t>(channel) * map.pixels() + pixel;
  profile.knots_mm = map.knots_mm;
  profile.log_value.clear();
  for (std::size_t k = 0; k < map.knots_mm.size(); ++k)
    profile.log_value.push_back(
        static_cast<double>(knot_plane(map, channel, static_cast<int>(k))[pixel]));
  apply(map.gain.empty() ? 1.0 : static_cast<double>(map.gain[plane]),
        map.dilation.empty() ? 1.0 : static_cast<double>(map.dilation[plane]), profile);
}

Profile get_profile(const ProfileMap& map, int channel, int x, int y) {
  Profile profile;
  get_profile(map, channel, x, y, profile);
  return profile;
}

}  // namespace parian

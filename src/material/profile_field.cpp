#include "material/profile_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "base/parallel.h"
#include "material/diffusion.h"
#include "material/field_internal.h"

namespace parian {
namespace {

constexpr int resampled_knots = 112;

// Rows of a whole grid: half_log[pixel][knot][channel] and support[pixel][channel].
struct Rows {
  std::vector<float> half_log, support;
};

// ln P without the cut at the support, so that it is linear over the tail as well.
void fill_row(const Profile& profile, const std::vector<float>& knots, float* half_log) {
  const std::vector<double>&own = profile.knots_mm, &value = profile.log_value;
  std::size_t k = 0;
  const auto fill = [&](std::size_t i, double slope, double end) {
    for (; k < knots.size() && static_cast<double>(knots[k]) < end; ++k)
      half_log[3 * k] =
          static_cast<float>(0.5 * (value[i] + slope * (static_cast<double>(knots[k]) - own[i])));
  };
  for (std::size_t i = 0; i + 1 < own.size(); ++i)
    fill(i, (value[i + 1] - value[i]) / (own[i + 1] - own[i]), own[i + 1]);
  fill(own.size() - 1, tail_slope(own, value), HUGE_VAL);
}

// From 0 to `last`: the first step is `first`, every further one longer by the same factor.
std::vector<float> make_graded_knots(double first, double last, int count) {
  double low = 1, high = 2;  // of the factor q: first (q^n - 1) / (q - 1) = last
  const auto reach = [&](double q) {
    double sum = 0, step = first;
    for (int i = 1; i < count; ++i, step *= q) sum += step;
    return sum;
  };
  for (int i = 0; i < 60; ++i) (reach(0.5 * (low + high)) < last ? low : high) = 0.5 * (low + high);
  const double scale = last / reach(low);
  std::vector<float> knots{0};
  double r = 0, step = first * scale;
  for (int i = 1; i < count; ++i, step *= low) knots.push_back(static_cast<float>(r += step));
  return knots;
}

bool falls_everywhere(const float* half_log, std::size_t row) {
  for (std::size_t i = 0; i + 3 < row; ++i)
    if (half_log[i + 3] > half_log[i]) return false;
  return true;
}

// Bilinear over the four pixels around (x, y).
void eval_rows(const Rows& rows, int width, int height, std::size_t row, double x, double y,
               float* half_log, float* support) {
  std::fill_n(half_log, row, 0.0f);
  std::fill_n(support, 3, 0.0f);
  for (const Corner& corner : find_corners(width, height, x, y)) {
    if (corner.weight == 0) continue;
    const float* from = rows.half_log.data() + corner.pixel * row;
    for (std::size_t i = 0; i < row; ++i) half_log[i] += corner.weight * from[i];
    for (std::size_t c = 0; c < 3; ++c)
      support[c] += corner.weight * rows.support[3 * corner.pixel + c];
  }
}

ProfileField make_field(const ProfileMap& map, double support) {
  ProfileField field;
  field.width = map.width;
  field.height = map.height;
  field.pixel_pitch_mm = map.pixel_pitch_mm;
  field.boundary = map.boundary;
  field.eta = map.eta;
  field.max_support_mm = static_cast<float>(support);
  double smallest_dilation = 1;
  for (float dilation : map.dilation)
    smallest_dilation = std::min(smallest_dilation, static_cast<double>(dilation));
  // A kink of ln P between two new knots is cut off by at most its change of slope times a quarter
  // of their distance, so dilated maps get steps that are short where profiles bend most.
  field.knots_mm = map.dilation.empty() ? extend_knots(map.knots_mm, support)
                                        : make_graded_knots(map.knots_mm[1] * smallest_dilation / 4,
                                                            support * (1 + 1e-6), resampled_knots);
  const auto rows = std::make_shared<Rows>();
  rows->half_log.resize(map.pixels() * field.row());
  rows->support.resize(map.pixels() * 3);
  std::vector<std::uint8_t> falls(static_cast<std::size_t>(map.height), 1);
  parallel_for(falls.size(), [&](std::size_t y) {
    Profile profile;
    for (int x = 0; x < map.width; ++x) {
      const std::size_t pixel =
          y * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x);
      float* half_log = &rows->half_log[pixel * field.row()];
      for (int c = 0; c < 3; ++c) {
        get_profile(map, std::min(c, map.channels - 1), x, static_cast<int>(y), profile);
        fill_row(profile, field.knots_mm, half_log + c);
        rows->support[3 * pixel + static_cast<std::size_t>(c)] =
            static_cast<float>(profile.support_mm);
      }
      if (!falls_everywhere(half_log, field.row())) falls[y] = 0;
    }
  });
  field.monotone = std::find(falls.begin(), falls.end(), 0) == falls.end();
  field.eval = [rows, width = map.width, height = map.height, row = field.row()](
                   double x, double y, float* half_log, float* supports) {
    eval_rows(*rows, width, height, row, x, y, half_log, supports);
  };
  return field;
}

// Knots that share the chords' errors evenly: their density follows sqrt |y''|, y = ln R_d.
std::vector<float> place_knots(const std::vector<ReflectanceCurve>& curves, double support) {
  constexpr int fine = 8192;
  const auto radius = [&](int i) {  // denser towards 0
    const double u = static_cast<double>(i) / fine;
    return support * u * u;
  };
  std::vector<double> sum(fine + 1, 0.0);
  for (int i = 1; i < fine; ++i) {
    const double a = radius(i - 1), b = radius(i), c = radius(i + 1);
    double density = 0;
    for (const ReflectanceCurve& curve : curves) {
      const auto y = [&](double r) { return std::log(eval_curve(curve, r)); };
      const double bend = 2 * ((y(c) - y(b)) / (c - b) - (y(b) - y(a)) / (b - a)) / (c - a);
      density = std::max(density, std::sqrt(std::abs(bend)));
    }
    sum[static_cast<std::size_t>(i)] = sum[static_cast<std::size_t>(i) - 1] + density * (c - a) / 2;
  }
  sum[fine] = sum[fine - 1];
  std::vector<float> knots{0};
  int i = 0;
  for (int k = 1; k + 1 < resampled_knots; ++k) {
    const double target = sum[fine] * k / (resampled_knots - 1);
    while (sum[static_cast<std::size_t>(i)] < target) ++i;
    const auto r = static_cast<float>(radius(i));
    if (r > knots.back()) knots.push_back(r);
  }
  knots.push_back(static_cast<float>(support * (1 + 1e-6)));
  return knots;
}

ProfileField make_field(const Dipole& dipole, double support) {
  ProfileField field;
  field.eta = dipole.eta;
  field.max_support_mm = static_cast<float>(support);
  std::vector<ReflectanceCurve> curves;
  curves.reserve(dipole.channels.size());
  for (std::size_t c = 0; c < dipole.channels.size(); ++c)
    curves.push_back(make_reflectance_curve(dipole, c));
  field.knots_mm = place_knots(curves, support);
  const auto rows = std::make_shared<Rows>();
  rows->half_log.resize(field.row());
  for (std::size_t c = 0; c < 3; ++c) {
    const ReflectanceCurve& curve = curves[std::min(c, curves.size() - 1)];
    for (std::size_t k = 0; k < field.knots(); ++k)
      rows->half_log[3 * k + c] = static_cast<float>(
          0.5 * std::log(eval_curve(curve, static_cast<double>(field.knots_mm[k]))));
    rows->support.push_back(static_cast<float>(support_of(curve)));
  }
  field.monotone = falls_everywhere(rows->half_log.data(), field.row());
  field.eval = [rows](double, double, float* half_log, float* supports) {
    std::copy(rows->half_log.begin(), rows->half_log.end(), half_log);
    std::copy(rows->support.begin(), rows->support.end(), supports);
  };
  return field;
}

// A dilated blend is written out first.
ProfileField make_field(const ProfileBlend& blend, double support) {
  if (!blend.dilation.empty()) return make_field(make_profile_map(blend), support);
  return make_blend_field(blend, support);
}

}  // namespace

std::vector<float> extend_knots(const std::vector<double>& knots, double support) {
  const double last = knots.back();
  std::vector<float> extended{0};
  for (double knot : knots)
    if (knot - static_cast<double>(extended.back()) > 1e-5 * last)
      extended.push_back(static_cast<float>(knot));
  for (double r = tail_step * last; r < 0.95 * support; r *= tail_step)
    extended.push_back(static_cast<float>(r));
  if (support > last * (1 + 1e-6)) extended.push_back(static_cast<float>(support * (1 + 1e-6)));
  return extended;
}

std::array<Corner, 4> find_corners(int width, int height, double x, double y) {
  const double cx = std::clamp(x, 0.0, width - 1.0), cy = std::clamp(y, 0.0, height - 1.0);
  const int x0 = std::min(static_cast<int>(cx), std::max(0, width - 2));
  const int y0 = std::min(static_cast<int>(cy), std::max(0, height - 2));
  const double fx = cx - x0, fy = cy - y0;
  std::array<Corner, 4> corners;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    corners[static_cast<std::size_t>(corner)] = {
        static_cast<std::size_t>(std::min(y0 + dy, height - 1)) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(std::min(x0 + dx, width - 1)),
        static_cast<float>((dx ? fx : 1 - fx) * (dy ? fy : 1 - fy))};
  }
  return corners;
}

ProfileField make_profile_field(const Material& material) {
  const double support = support_mm(material);
  return std::visit([&](const auto& model) { return make_field(model, support); }, material);
}

}  // namespace parian

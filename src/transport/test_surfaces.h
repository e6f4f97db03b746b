// Sources and targets for the gather's tests: a sphere and a plane of even samples, and materials.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "material/profile_field.h"
#include "transport/gather.h"

namespace parian {

// Points of a Fibonacci lattice on the sphere; places in the sample vary over 16 x 16 pixels.
inline std::vector<GatherPoint> make_sphere_points(int count, float radius, double shift = 0) {
  std::vector<GatherPoint> points;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, phi = i * golden + shift, q = std::sqrt(1 - z * z);
    GatherPoint point;
    point.normal = {static_cast<float>(q * std::cos(phi)), static_cast<float>(z),
                    static_cast<float>(q * std::sin(phi))};
    point.position = point.normal * radius;
    point.x = 7.5f + 7.5f * point.normal.x;
    point.y = 7.5f + 7.5f * point.normal.z;
    points.push_back(point);
  }
  return points;
}

inline GatherSources make_sphere_sources(int count, float radius) {
  GatherSources sources;
  sources.points = make_sphere_points(count, radius);
  const double r = radius;
  sources.area_mm2 = 4 * std::numbers::pi * r * r / count;
  for (const GatherPoint& point : sources.points) {
    const float light = std::max(point.normal.y, 0.0f) + (point.normal.x > 0.3f ? 0.5f : 0.01f);
    sources.flux.push_back(Rgb{light, 0.7f * light, 0.2f} * static_cast<float>(sources.area_mm2));
  }
  return sources;
}

// Two materials in a checker of 4 x 4 pixels, on 16 x 16.
inline ProfileMap make_checker(double steepness = 1) {
  std::vector<double> knots;
  for (int k = 0; k <= 10; ++k) knots.push_back(0.4 * k);
  ProfileMap map = make_profile_map(16, 16, 3, 1, knots);
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k <= 10; ++k)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const bool dark = ((x / 4 + y / 4) & 1) != 0;
          const double slope = (dark ? 2.5 : 1.0) * (1 + 0.3 * c) * steepness;
          knot_plane(map, c, k)[y * 16 + x] =
              static_cast<float>((dark ? -2 : -3) - slope * knots[static_cast<std::size_t>(k)]);
        }
  return map;
}

// The defining sum in double precision, without a near term.
inline Rgb gather_plainly(const ProfileField& field, const GatherSources& sources,
                          const GatherPoint& target) {
  std::vector<float> own(field.row()), other(field.row());
  float own_support[3], other_support[3];
  field.eval(static_cast<double>(target.x), static_cast<double>(target.y), own.data(), own_support);
  double sum[3] = {0, 0, 0};
  for (std::size_t i = 0; i < sources.points.size(); ++i) {
    const GatherPoint& source = sources.points[i];
    field.eval(static_cast<double>(source.x), static_cast<double>(source.y), other.data(),
               other_support);
    const double dx =
        static_cast<double>(source.position.x) - static_cast<double>(target.position.x);
    const double dy =
        static_cast<double>(source.position.y) - static_cast<double>(target.position.y);
    const double dz =
        static_cast<double>(source.position.z) - static_cast<double>(target.position.z);
    const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
    std::size_t k = 0;
    while (k + 2 < field.knots() && static_cast<double>(field.knots_mm[k + 1]) <= r) ++k;
    const double r0 = field.knots_mm[k], r1 = field.knots_mm[k + 1], t = (r - r0) / (r1 - r0);
    const float flux[3] = {sources.flux[i].x, sources.flux[i].y, sources.flux[i].z};
    for (std::size_t c = 0; c < 3; ++c) {
      if (r > static_cast<double>(std::min(own_support[c], other_support[c]))) continue;
      const std::size_t at = 3 * k + c;
      const double h0 = static_cast<double>(own[at]) + static_cast<double>(other[at]);
      const double h1 = static_cast<double>(own[at + 3]) + static_cast<double>(other[at + 3]);
      sum[c] += std::exp(h0 + t * (h1 - h0)) * static_cast<double>(flux[c]);
    }
  }
  return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

// |a - b| relative to b, largest of the channels.
inline double relative_difference(Rgb a, Rgb b) {
  const auto of = [](float u, float v) {
    return v == u ? 0.0 : std::abs(static_cast<double>(u - v)) / static_cast<double>(v);
  };
  return std::max({of(a.x, b.x), of(a.y, b.y), of(a.z, b.z)});
}

}  // namespace parian

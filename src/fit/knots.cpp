// Knots and the curvature stencil over them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "fit/reduced_system.h"

namespace parian {
namespace {

void check_knots(const std::vector<double>& knots, double radius_mm) {
  if (knots.size() < 2 || knots.size() > 257 || knots[0] != 0)
    throw Error({.place = "knots-mm",
                 .expected = "2 to 257 increasing lengths from 0",
                 .found = fmt::format("{} that begin at {}", knots.size(), knots[0])});
  for (std::size_t k = 1; k < knots.size(); ++k)
    if (!(knots[k] > knots[k - 1]) || std::isinf(knots[k]))
      throw Error({.place = fmt::format("knots-mm[{}]", k),
                   .expected = fmt::format("a length > {}", knots[k - 1]),
                   .found = fmt::format("{}", knots[k])});
  if (knots.back() > radius_mm * (1 + 1e-9))
    throw Error({.place = "knots-mm",
                 .expected = fmt::format("a last knot of at most {} mm, the table's largest offset",
                                         radius_mm),
                 .found = fmt::format("{} mm", knots.back())});
}

}  // namespace

std::vector<double> make_knots(const TableHeader& header, const FitParams& params) {
  const double reach_mm = radius_px(header) * header.pixel_pitch_mm;
  if (!(reach_mm > 0))
    throw Error({.place = "offsets", .expected = "an offset besides (0, 0)", .found = "none"});
  if (!params.knots_mm.empty()) {
    check_knots(params.knots_mm, reach_mm);
    return params.knots_mm;
  }
  const double radius_mm = params.radius_mm > 0 ? params.radius_mm : reach_mm;
  if (radius_mm > reach_mm * (1 + 1e-9))
    throw Error({.place = "radius-mm",
                 .expected = fmt::format("at most {} mm, the table's largest offset", reach_mm),
                 .found = fmt::format("{} mm", radius_mm)});
  const double pixels = radius_mm / header.pixel_pitch_mm;
  if (pixels < 1 - 1e-9)
    throw Error({.place = "radius-mm",
                 .expected = fmt::format("at least {} mm, the pixel pitch", header.pixel_pitch_mm),
                 .found = fmt::format("{} mm", radius_mm)});
  const int segments =
      params.segments > 0 ? params.segments : std::min(24, static_cast<int>(pixels + 1e-6));
  std::vector<double> knots;
  for (int k = 0; k <= segments; ++k) knots.push_back(radius_mm * k / segments);
  return knots;
}

SecondDifference second_difference(const std::vector<double>& knots_mm, std::size_t left) {
  const double h1 = knots_mm[left + 1] - knots_mm[left];
  const double h2 = knots_mm[left + 2] - knots_mm[left + 1];
  const double scale = 2 * h1 * h2 / (h1 + h2);
  return {scale / h1, -scale / h1 - scale / h2, scale / h2};
}

}  // namespace parian

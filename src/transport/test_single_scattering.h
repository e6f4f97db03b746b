// What the tests of single scattering share: surface points, and attenuation in a basis.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "base/random.h"
#include "mesh/test_meshes.h"
#include "transport/curve_basis.h"
#include "transport/single_scattering.h"

namespace parian {

// `count` centres of triangles, spread over the mesh.
inline std::vector<SurfacePoint> pick_surface_points(const TriangleMesh& mesh, std::size_t count) {
  std::vector<SurfacePoint> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(get_surface_point(
        mesh, static_cast<std::uint32_t>(hash_u64(7, i) % mesh.triangles.size()), {0.3f, 0.4f}));
  return points;
}

// Coefficients of e^{-sigma_t s}.
inline std::vector<double> fit_attenuation(const SplineBasis& basis, double sigma_t) {
  return make_attenuation_projection(basis, KnotChoice::balanced).fit([&](double s) {
    return std::exp(-sigma_t * s);
  });
}

// sum_j e_j S_j of a point.
inline double attenuate(const std::vector<double>& e, const std::vector<float>& value,
                        std::size_t point, std::size_t component = 0, std::size_t channel = 0) {
  double sum = 0;
  for (std::size_t j = 0; j < e.size(); ++j)
    sum += e[j] * static_cast<double>(
                      value[(point * e.size() + j) * single_components + 3 * component + channel]);
  return sum;
}

// sum_j S_j: the transport without attenuation.
inline double sum_functions(const SplineBasis& basis, const std::vector<float>& value,
                            std::size_t point, std::size_t component = 0) {
  return attenuate(std::vector<double>(basis.size(), 1.0), value, point, component);
}

}  // namespace parian

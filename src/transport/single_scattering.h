// Single scattering of homogeneous materials under a light, before the material is known: the
// transport of the attenuation's basis functions (Xu et al. 2007, section 4.2, Eq. 11-15).
//
// A place x_o with normal n sees the points x_s = x_o - s n of its path, s from 0 to s_back, where
// the path meets the surface from inside. Light comes to x_s straight along w (unit, to the light)
// through the entry x_i, s_i away, and has passed the refracted length
//
//   s_i' = s_i c / sqrt(1 - (1 - c^2) / eta^2),  c = |w . n_i|                     (Eq. 7)
//
// where nothing lies between x_i and the light; n_i is the interpolated normal.
//
//   S_j(x_o) = int int G(w_i') B_j(s_i' + s) F_t(w_i) L ds dw,  G = (1, w_i')       (Eq. 15)
//
// with w_i' refracted at x_i and pointing away from the medium. As in the paper there is no cosine
// and no 1 / eta^2. Lengths beyond the basis's last knot count as the last knot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "math/spline_basis.h"
#include "mesh/mesh.h"
#include "mesh/ray_tracer.h"
#include "scene/scene.h"

namespace parian {

// How entries are found: by depth maps seen from the light, common to all places, or by two rays
// for each point of a path. Point lights always take rays.
enum class EntryMethod { depth_layers, rays };

struct SingleScatteringParams {
  int path_samples = 32;  // on each path; an odd number counts as the next even one
  int directions = 128;   // of an environment light
  EntryMethod method = EntryMethod::depth_layers;
  int resolution = 2048;  // texels along the longer side of a depth map
  std::uint64_t seed = 1;
};
ParamList describe(SingleScatteringParams& params);

// Numbers of a place: [function][1, w'x, w'y, w'z][channel].
inline constexpr std::size_t single_components = 12;

// Quadrature on [0, length_mm]: two Gauss points in each of count / 2 intervals, which are equal in
// log(1 + s / scale_mm). `count` is even. Largest errors with the default scale, of
// int e^{-a s} ds, lengths up to 100 mm: 1e-4 with 32 nodes and 1e-3 with 16 for a from 0.2 to
// 40 / mm (sigma_t up to 15 / mm, and the light's way as steep as it gets), 7 % with 8.
inline constexpr double path_scale_mm = 0.05;
void make_path_nodes(double length_mm, int count, double scale_mm, float* s, float* weight);

// How far a ray from a surface point into the object goes to where it meets the surface from
// inside; where it leaves through a hole, to the mesh's box.
double find_path_length(const SurfacePoint& point, Vec3 direction, const Bounds3& box,
                        const RayTracer& tracer);

// Directions of a light far away and what each brings: sum f(w) L dw = sum f(w_k) weight_k. An
// environment's are drawn by brightness, stratified; a black one has none.
struct LightDirection {
  Vec3 direction;  // unit, to the light
  Rgb weight;
};
std::vector<LightDirection> make_light_directions(const Light& light, int count,
                                                  std::uint64_t seed);

// Light that comes to a point inside: an entry, and what passes it.
struct LightEntry {
  Vec3 direction;         // w_i'
  Rgb light;              // F_t(w_i) times weight, or times intensity / distance^2
  double length_mm = 0;   // s_i'
  float distance_mm = 0;  // s_i
  bool reached = false;   // otherwise the rest is not set
};
LightEntry find_entry(Vec3 inside, const LightDirection& light, const TriangleMesh& mesh,
                      const RayTracer& tracer, float eta);
LightEntry find_entry(Vec3 inside, const PointLight& light, const TriangleMesh& mesh,
                      const RayTracer& tracer, float eta);

// The transport of one light, in steps. After n steps step() and value() are all there is to keep:
// restored into a state made in the same way they give the same bits as a run in one go, whatever
// the number of threads. The mesh has normals; it and the tracer must outlive the state.
class SingleTransportState {
 public:
  // eta >= 1.
  SingleTransportState(const SplineBasis& basis, const std::vector<SurfacePoint>& points,
                       const Light& light, const TriangleMesh& mesh, const RayTracer& tracer,
                       double eta, const SingleScatteringParams& params = {});
  ~SingleTransportState();
  SingleTransportState(SingleTransportState&&) noexcept;
  SingleTransportState& operator=(SingleTransportState&&) noexcept;

  std::size_t steps() const;
  std::size_t step() const;  // done
  void advance();            // one step; nothing after the last
  // [point][function][4][channel]: S_j after the last step.
  const std::vector<float>& value() const;
  // Throws Error for a step beyond the last and for values of another number or not finite.
  void restore(std::size_t step, std::vector<float> value);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// All steps: value().
std::vector<float> compute_single_transport(const SplineBasis& basis,
                                            const std::vector<SurfacePoint>& points,
                                            const Light& light, const TriangleMesh& mesh,
                                            const RayTracer& tracer, double eta,
                                            const SingleScatteringParams& params = {},
                                            const Progress& progress = {});

}  // namespace parian

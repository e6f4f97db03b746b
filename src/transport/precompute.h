// Makes the transport of a scene's mesh under its lights (homogeneous_transport.h), light by light,
// so that it can be stopped and taken up again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/ray_tracer.h"
#include "mesh/surface_samples.h"
#include "scene/scene.h"
#include "transport/homogeneous_transport.h"
#include "transport/radial_moments.h"
#include "transport/single_scattering.h"

namespace parian {

struct PrecomputeParams {
  int samples = 200000;  // irradiance samples on the surface
  int rays = 128;        // per sample and environment light
  int multiple_intervals = 16;
  int single_intervals = 16;
  int degree = 1;
  KnotChoice knots = KnotChoice::balanced;
  double opening = 0.5;  // RadialMomentParams
  bool single = true;    // single scattering too
  SingleScatteringParams single_params;
  std::uint64_t seed = 1;
};
ParamList describe(PrecomputeParams& params);

// What transport depends on; stored beside it. Equal content has equal fingerprints.
struct TransportFingerprint {
  std::uint64_t mesh = 0;
  std::uint64_t parameters = 0;  // and eta of the material
  std::vector<std::uint64_t> lights;
  friend bool operator==(const TransportFingerprint&, const TransportFingerprint&) = default;
};
TransportFingerprint fingerprint_of(const Scene& scene, const PrecomputeParams& params);
// Bases for the scene's size and eta, and no light yet.
HomogeneousTransport make_empty_transport(const Scene& scene, const PrecomputeParams& params = {});
// "light 2 (environment)"; lights are numbered from 1.
std::string light_name(const Scene& scene, std::size_t light);

struct PrecomputeReport {
  double sampling_s = 0, irradiance_s = 0, multiple_s = 0, single_s = 0;
  std::size_t samples = 0;
  double sample_spacing_mm = 0;
  double escaping_fraction = 0;  // of rays sent inwards
  double nodes_per_target = 0;
  std::vector<std::string> warnings;
};

// Advances transport by a light at a time. Scene and tracer must outlive it.
class Precompute {
 public:
  // `done`: what an earlier run of the same fingerprint has left; its bits are kept. Throws Error
  // when more than 1 % of inward rays escape (names the mesh).
  Precompute(const Scene& scene, const RayTracer& tracer, const PrecomputeParams& params,
             HomogeneousTransport done = {}, const Progress& progress = {});

  bool is_done() const { return transport_.lights.size() == scene_.lights.size(); }
  std::size_t lights_done() const { return transport_.lights.size(); }
  // The next light. What is there stays whole when it throws, also on cancellation.
  void advance(const Progress& progress = {});
  // Any light over the same mesh, under the name of `index`; nothing is kept.
  LightTransport compute(std::size_t index, const Light& light, const Progress& progress = {});
  const HomogeneousTransport& transport() const { return transport_; }
  const PrecomputeReport& report() const { return report_; }

 private:
  const Scene& scene_;
  const RayTracer& tracer_;
  PrecomputeParams params_;
  SurfaceSamples samples_;
  std::vector<SurfacePoint> places_;  // the vertices
  HomogeneousTransport transport_;
  PrecomputeReport report_;
};

// All of it at once.
HomogeneousTransport precompute_transport(const Scene& scene, const PrecomputeParams& params = {},
                                          const Progress& progress = {});

}  // namespace parian

// Photons in a homogeneous ball, or below a plane, one by one in double precision: what curvature
// changes, and a check of the photon engine that shares no code with it.
#pragma once

#include <cstdint>
#include <vector>

#include "acquire/photon_trace.h"

namespace parian::photon {

// Scatters isotropically.
struct Ball {
  double curvature = 0;  // 1/radius in 1/mm; 0: half-infinite
  double sigma_a = 0, sigma_s = 1;
  double eta = 1.3;
};

// Lambertian light that enters at one point, and where it leaves. On a sphere as in a plane the
// area at chords c to c + dc from a point is 2 pi c dc, so that rings compare as R_d does.
struct BallTally {
  PhotonTotals totals;
  std::vector<double> rings;  // power that left at chords from edges[i] to edges[i + 1]
};
BallTally trace_ball(const Ball& ball, const std::vector<double>& edges_mm, std::uint64_t key,
                     std::uint64_t photons);

}  // namespace parian::photon

#include "bench/photon/ball.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/random.h"
#include "transport/irradiance.h"

namespace parian::photon {
namespace {

using Eigen::Vector3d;

constexpr double roulette_below = 0.1, roulette_to = 0.3;  // of the weight inside at first

struct Photon {
  Vector3d position = Vector3d::Zero();
  Vector3d direction;
  double weight = 1;
};

// The light enters at 0 along z. With curvature k the surface is z = k |p|^2 / 2 and the normal
// towards the inside e_z - k p, of length 1 on the surface; both hold for the plane, k = 0.
Vector3d inward_normal(const Ball& ball, const Vector3d& p) {
  return Vector3d::UnitZ() - ball.curvature * p;
}

// The positive root of (k/2) t^2 - (n . d) t - (z - k |p|^2 / 2) = 0, without cancellation.
double distance_to_surface(const Ball& ball, const Photon& photon) {
  const double k = ball.curvature;
  const double along = inward_normal(ball, photon.position).dot(photon.direction);
  const double depth = std::max(0.0, photon.position.z() - 0.5 * k * photon.position.squaredNorm());
  const double root = std::sqrt(along * along + 2 * k * depth);
  if (along < 0) return 2 * depth / (root - along);
  return k > 0 ? (root + along) / k : std::numeric_limits<double>::infinity();
}

// Marsaglia 1972: uniform on the sphere from a point in the unit disk.
Vector3d sample_direction(Rng& rng) {
  while (true) {
    const double x = 2 * sample_uniform(rng) - 1, y = 2 * sample_uniform(rng) - 1;
    const double s = x * x + y * y;
    if (s >= 1) continue;
    const double scale = 2 * std::sqrt(1 - s);
    return {x * scale, y * scale, 1 - 2 * s};
  }
}

// Through the boundary, by the sine of the angle outside.
double transmission(const Ball& ball, double sine_squared) {
  if (sine_squared >= 1) return 0;  // total reflection
  return static_cast<double>(fresnel_transmission(static_cast<float>(ball.eta),
                                                  static_cast<float>(std::sqrt(1 - sine_squared))));
}

class Walk {
 public:
  Walk(const Ball& ball, const std::vector<double>& edges, Rng& rng, BallTally& tally)
      : ball_(ball), edges_(edges), rng_(rng), tally_(tally) {}

  void run() {
    if (!enter()) return;
    const double sigma_t = ball_.sigma_a + ball_.sigma_s;
    while (photon_.weight > 0) {
      tally_.totals.flights += 1;
      const double to_collision = -std::log1p(-sample_uniform(rng_)) / sigma_t;
      const double to_surface = distance_to_surface(ball_, photon_);
      photon_.position += std::min(to_collision, to_surface) * photon_.direction;
      if (to_surface <= to_collision)
        cross();
      else
        collide(ball_.sigma_s / sigma_t);
    }
  }

 private:
  // Lambertian: sin^2 of the angle outside is uniform; Snell divides it by eta^2.
  bool enter() {
    const double sine_squared = sample_uniform(rng_);
    const double inside = sine_squared / (ball_.eta * ball_.eta);
    // By symmetry the azimuth does not matter.
    photon_.direction = {std::sqrt(inside), 0, std::sqrt(1 - inside)};
    entered_ = photon_.weight = transmission(ball_, sine_squared);
    tally_.totals.launched += 1;
    tally_.totals.specular += 1 - photon_.weight;
    return photon_.weight > 0;
  }

  void cross() {
    const Vector3d normal = inward_normal(ball_, photon_.position);
    const double cosine = std::min(1.0, -normal.dot(photon_.direction));
    const double passes = transmission(ball_, ball_.eta * ball_.eta * (1 - cosine * cosine));
    if (sample_uniform(rng_) >= passes) {
      photon_.direction += 2 * cosine * normal;
      return;
    }
    tally_.totals.reflected += photon_.weight;
    const double chord = photon_.position.norm();
    const auto above = std::upper_bound(edges_.begin(), edges_.end(), chord);
    if (above != edges_.begin() && above != edges_.end())
      tally_.rings[static_cast<std::size_t>(above - edges_.begin() - 1)] += photon_.weight;
    photon_.weight = 0;
  }

  void collide(double albedo) {
    tally_.totals.absorbed += photon_.weight * (1 - albedo);
    photon_.weight *= albedo;
    photon_.direction = sample_direction(rng_);
    if (photon_.weight >= roulette_below * entered_) return;
    const double survivor = roulette_to * entered_;
    const double weight = sample_uniform(rng_) * survivor < photon_.weight ? survivor : 0;
    tally_.totals.roulette += weight - photon_.weight;
    photon_.weight = weight;
  }

  const Ball& ball_;
  const std::vector<double>& edges_;
  Rng& rng_;
  BallTally& tally_;
  Photon photon_;
  double entered_ = 0;
};

}  // namespace

BallTally trace_ball(const Ball& ball, const std::vector<double>& edges_mm, std::uint64_t key,
                     std::uint64_t photons) {
  PARIAN_CHECK(ball.curvature >= 0 && ball.sigma_a >= 0 && ball.sigma_s > 0 && ball.eta >= 1);
  PARIAN_CHECK(edges_mm.size() >= 2);
  BallTally tally{{}, std::vector<double>(edges_mm.size() - 1, 0.0)};
  Rng rng = make_rng(key);
  for (std::uint64_t i = 0; i < photons; ++i) Walk(ball, edges_mm, rng, tally).run();
  return tally;
}

}  // namespace parian::photon

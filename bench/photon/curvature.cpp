// Where the plane fails on curved parts: balls beside the half-infinite medium, by chord.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "bench/photon/ball.h"
#include "bench/photon/batches.h"
#include "bench/photon/study.h"

namespace parian::photon {
namespace {

constexpr double sigma_a = 0.01, sigma_s_prime = 2, eta = 1.3;  // those of study_thickness
constexpr int radii[] = {2, 4, 8, 16, 32};                      // in 1 / sigma_s'
constexpr double shown[] = {0, 0.5, 1, 2, 4, 8, 16, 32};        // edges of rings, in 1 / sigma_s'
constexpr std::size_t shown_rings = std::size(shown) - 1;

std::vector<double> make_edges() {
  std::vector<double> edges;
  for (const double edge : shown) edges.push_back(edge / sigma_s_prime);
  edges.push_back(2 * edges.back());  // the far side of the largest ball
  return edges;
}

using Batches = std::vector<BallTally>;
Batches trace_batches(int radius) {  // 0: half-infinite
  constexpr std::uint64_t batches = 64, photons = 50000;
  const Ball ball{.curvature = radius > 0 ? sigma_s_prime / radius : 0,
                  .sigma_a = sigma_a,
                  .sigma_s = sigma_s_prime,
                  .eta = eta};
  const std::vector<double> edges = make_edges();
  Batches found(batches);
  parallel_for(batches, [&](std::size_t i) {
    found[i] = trace_ball(ball, edges, hash_u64(static_cast<std::uint64_t>(radius), i), photons);
  });
  return found;
}

PhotonEstimate estimate_total(const Batches& batches) {
  return estimate(
      batches, [](const BallTally& each) { return each.totals.reflected / each.totals.launched; });
}

// Up to chord `edge`, one of the edges, in 1 / sigma_s'.
PhotonEstimate estimate_within(const Batches& batches, double edge) {
  const std::vector<double> edges = make_edges();
  return estimate(batches, [&](const BallTally& each) {
    double sum = 0;
    for (std::size_t i = 0; i < each.rings.size(); ++i)
      if (edges[i + 1] <= edge / sigma_s_prime) sum += each.rings[i];
    return sum / each.totals.launched;
  });
}

PhotonEstimate divide(const PhotonEstimate& a, const PhotonEstimate& b) {
  const double ratio = a.value / b.value;
  return {ratio, ratio * std::hypot(a.error / a.value, b.error / b.value)};
}

// Writes values to a table and keeps the largest standard error, in units of the value.
struct Cells {
  double largest_error = 0;

  std::string format(const PhotonEstimate& estimate) {
    largest_error = std::max(largest_error, estimate.error / estimate.value);
    return fmt::format("{:.3f}", estimate.value);
  }
  std::string format_error() const {
    return fmt::format("standard errors at most {:.2f} %", 100 * largest_error);
  }
};

struct Traced {
  int radius = 0;
  Batches batches;
};

void write_totals(const Page& page, const Batches& plane, const std::vector<Traced>& balls) {
  const PhotonEstimate whole = estimate_total(plane);
  const PhotonVolume volume = make_homogeneous(sigma_a, sigma_s_prime, 0, eta);
  Cells cells;
  const std::string half_infinite = cells.format(whole);
  const std::string by_engine =
      cells.format(measure_totals(volume, PhotonEntry::lambertian, 2000000).reflected);
  MarkdownTable table{{"radius [mm]", "radius [1/σ_s′]", "reflected", "by R_d of the plane",
                       "reflected / by R_d of the plane", "reflected / half-infinite"},
                      {}};
  for (const Traced& ball : balls) {
    const PhotonEstimate total = estimate_total(ball.batches);
    const PhotonEstimate predicted = estimate_within(plane, 2 * ball.radius);
    table.rows.push_back({fmt::format("{}", ball.radius / sigma_s_prime),
                          fmt::format("{}", ball.radius), cells.format(total),
                          cells.format(predicted), cells.format(divide(total, predicted)),
                          cells.format(divide(total, whole))});
  }
  write_table(
      page, "balls",
      fmt::format("Balls with σ_a = {}, σ_s′ = {} per mm, η = {}, light from all sides; "
                  "half-infinite: {} reflected ({} by the photon engine); {}.",
                  sigma_a, sigma_s_prime, eta, half_infinite, by_engine, cells.format_error()),
      table);
}

void write_rings(const Page& page, const Batches& plane, const std::vector<Traced>& balls) {
  MarkdownTable table{{"chord [1/σ_s′]"}, {}};
  Cells cells;
  for (const Traced& ball : balls) table.header.push_back(fmt::format("radius {}", ball.radius));
  for (std::size_t i = 0; i < shown_rings; ++i) {
    const auto ring = [i](const BallTally& each) { return each.rings[i] / each.totals.launched; };
    const PhotonEstimate flat = estimate(plane, ring);
    std::vector<std::string> row{fmt::format("{} to {}", shown[i], shown[i + 1])};
    for (const Traced& ball : balls)
      row.push_back(shown[i] < 2 * ball.radius
                        ? cells.format(divide(estimate(ball.batches, ring), flat))
                        : "–");
    table.rows.push_back(row);
  }
  write_table(page, "chords",
              fmt::format("R_d of the ball / R_d of the plane, means over rings of equal chords; "
                          "{}:",
                          cells.format_error()),
              table);
}

}  // namespace

void study_curvature(const Page& page) {
  const Batches plane = trace_batches(0);
  std::vector<Traced> balls;
  for (const int radius : radii) balls.push_back({radius, trace_batches(radius)});
  write_totals(page, plane, balls);
  write_rings(page, plane, balls);
}

}  // namespace parian::photon

#include "transport/near_term.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "math/fast_math.h"

namespace parian {
namespace {

constexpr std::size_t block_values = 3 * lanes;
constexpr double mean_spacings = 2.5;
constexpr double few = 2, enough = 8;

// Gauss-Legendre on [0, 1].
constexpr std::array<double, 6> gauss_x{0.033765242898424, 0.169395306766868, 0.380690406958402,
                                        0.619309593041598, 0.830604693233132, 0.966234757101576};
constexpr std::array<double, 6> gauss_w{0.085662246189585, 0.180380786524069, 0.233956967286346,
                                        0.233956967286346, 0.180380786524069, 0.085662246189585};

// Sums over the samples near each target.
struct NearSums {
  std::array<double, block_values> scattered{};  // S
  std::array<double, block_values> weight{};     // W
  std::array<double, block_values> flux{};       // by a weight of the mean's own,
  std::array<double, lanes> area{};              // and area
};

struct Chunk {
  alignas(64) std::array<float, gather_chunk * lanes> r;
  alignas(64) std::array<float, gather_chunk * block_values> value, target;
};

// What one sample adds to one target.
void add_pair(const NearSamples& samples, std::uint32_t id, const Chunk& chunk, std::size_t i,
              std::size_t lane, const TargetBlock& block, double near_mm, double mean_mm,
              NearSums& near, double* sum) {
  const auto r = static_cast<double>(chunk.r[i * lanes + lane]);
  const double w = near_weight(r, near_mm), of_mean = near_weight(r, mean_mm);
  const bool same_side = w > 0 && dot(samples.normal[id], block.normal[lane]) > 0;
  const Rgb& flux = samples.flux[id];
  const double power[3] = {flux.x, flux.y, flux.z};
  if (same_side) near.area[lane] += of_mean * samples.area_mm2;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t from = (i * 3 + c) * lanes + lane, to = c * lanes + lane;
    const auto value = static_cast<double>(chunk.value[from]);
    if (!same_side) {
      sum[to] += value;
      continue;
    }
    sum[to] += value * (1 - w);
    near.scattered[to] += value * w;
    near.flux[to] += of_mean * power[c];
    near.weight[to] += static_cast<double>(chunk.target[from]) * w * samples.area_mm2;
  }
}

// S I / W as far as it is trusted, for the rest I times the mean irradiance.
void finish_near(const NearSums& near, const NearIntegrals& integrals, double area_mm2,
                 double* sum) {
  for (std::size_t j = 0; j < block_values; ++j) {
    const double integral = integrals.weight[j], square = integrals.square[j];
    const double weight = near.weight[j], area = near.area[j % lanes];
    if (!(square > 0)) continue;
    const double trust = area > 0 ? near_trust(integral * integral / (area_mm2 * square)) : 1;
    if (trust > 0 && weight > 0)
      sum[j] += trust * near_scale(weight, integral, square, area_mm2) * near.scattered[j];
    if (trust < 1) sum[j] += (1 - trust) * integral * near.flux[j] / area;
  }
}

}  // namespace

double near_weight(double r, double near_mm) {
  const double u = 1 - (r / near_mm) * (r / near_mm);
  return u > 0 ? u * u : 0;
}

double near_scale(double weight, double integral, double square, double area_mm2) {
  const double others = integral * integral / (square * area_mm2) - 1;
  const double limit = others > 0 ? 1 + 2 / others : 1e300;
  return std::clamp(integral / weight, 1 / limit, limit);
}

double near_trust(double n) {
  const double u = std::clamp((n - few) / (enough - few), 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

double near_mean_mm(double area_mm2) {
  return mean_spacings * std::sqrt(area_mm2);
}

NearIntegrals integrate_near(const TargetBlock& block, const std::vector<float>& knots,
                             double near_mm) {
  NearIntegrals result;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t to = c * lanes + lane;
      const double end = std::min(near_mm, static_cast<double>(block.support[c][lane]));
      for (std::size_t k = 0; k + 1 < knots.size() && static_cast<double>(knots[k]) < end; ++k) {
        const double r0 = knots[k], r1 = std::min(end, static_cast<double>(knots[k + 1]));
        const float* at = &block.half_log[(3 * k + c) * lanes + lane];
        const double slope =
            static_cast<double>(at[3 * lanes] - at[0]) / (static_cast<double>(knots[k + 1]) - r0);
        for (std::size_t q = 0; q < gauss_x.size(); ++q) {
          const double r = r0 + (r1 - r0) * gauss_x[q];
          const double P = std::exp(2 * (static_cast<double>(at[0]) + slope * (r - r0)));
          const double value = P * near_weight(r, near_mm);
          const double ring = gauss_w[q] * (r1 - r0) * 2 * std::numbers::pi * r;
          result.weight[to] += ring * value;
          result.square[to] += ring * value * value;
        }
      }
    }
  return result;
}

void add_near(const EmitterView& emitters, const KnotView& lookup, const NearSamples& samples,
              const std::vector<std::uint32_t>& ids, const TargetBlock& block,
              const std::vector<float>& knots, double near_mm, double* sum) {
  const BlockView targets = view(block);
  const double mean_mm = near_mean_mm(samples.area_mm2);
  Chunk chunk;
  NearSums near;
  for (std::size_t begin = 0; begin < ids.size(); begin += gather_chunk) {
    const std::size_t count = std::min(gather_chunk, ids.size() - begin);
    eval_distances(emitters, &ids[begin], count, targets, chunk.r.data());
    eval_logs(emitters, lookup, &ids[begin], count, targets, chunk.r.data(), NodeExtent::point,
              chunk.value.data());
    eval_target_logs(lookup, count, targets, chunk.r.data(), chunk.target.data());
    exp_array(chunk.value.data(), chunk.value.data(), count * block_values);
    exp_array(chunk.target.data(), chunk.target.data(), count * block_values);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t lane = 0; lane < lanes; ++lane)
        add_pair(samples, ids[begin + i], chunk, i, lane, block, near_mm, mean_mm, near, sum);
  }
  finish_near(near, integrate_near(block, knots, near_mm), samples.area_mm2, sum);
}

}  // namespace parian

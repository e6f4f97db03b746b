// The weights of each layout at a point.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "acquire/layout.h"
#include "acquire/noise.h"
#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "image/color.h"

namespace parian {
namespace {

struct Point {
  double x = 0, y = 0;  // mm
};
Point rotate(Point p, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x + s * p.y, -s * p.x + c * p.y};
}

double smoothstep(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// What the layouts need beside their parameters. Streams of noise are numbered.
struct Scene {
  const LayoutGrid& grid;
  std::uint64_t stream(std::uint64_t index) const { return hash_u64(grid.seed, index); }
};

void fill_weights(const UniformLayout&, const Scene&, Point, double* weights) {
  weights[0] = 1;
}

void fill_weights(const ChessboardLayout& layout, const Scene& scene, Point p, double* weights) {
  const Point q = rotate(p, layout.rotation_deg);
  const double n = scene.grid.materials;
  const double tile = std::floor(q.x / layout.tile_mm) + std::floor(q.y / layout.tile_mm);
  weights[static_cast<int>(tile - n * std::floor(tile / n))] = 1;
}

// Index of the share that u in [0, 1) falls into.
int choose_share(const std::vector<double>& shares, int count, double u) {
  if (shares.empty()) return std::min(count - 1, static_cast<int>(u * count));
  double sum = 0;
  for (const double share : shares) sum += share;
  int last = 0;
  for (int i = 0; i < count; ++i) {
    const double share = shares[static_cast<std::size_t>(i)];
    if (share <= 0) continue;
    last = i;
    u -= share / sum;
    if (u < 0) break;
  }
  return last;
}

// One stone per cell of a jittered lattice. Returns the elliptic distance from its centre (1 on the
// outline), infinite where the place is empty.
struct Stone {
  double distance = INFINITY;
  std::uint64_t key = 0;
};
Stone make_stone(const StonesLayout& layout, const Scene& scene, double u, double v, double cell_u,
                 double cell_v) {
  const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(cell_u));
  const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(cell_v));
  const std::uint64_t key = hash_u64(hash_u64(scene.stream(0), column), row);
  const auto uniform = [&](std::uint64_t index) { return hash_to_uniform(hash_u64(key, index)); };
  if (uniform(0) >= layout.coverage) return {};
  const Point centre{cell_u + 0.5 + 0.7 * (uniform(1) - 0.5),
                     cell_v + 0.5 + 0.7 * (uniform(2) - 0.5)};
  const double radius = 0.55 * (1 + layout.spread * (2 * uniform(3) - 1));
  const double ratio = std::sqrt(1 + (layout.elongation - 1) * uniform(4));
  const Point q = rotate({u - centre.x, v - centre.y}, 180 * uniform(5));
  return {std::hypot(q.x / (radius * ratio), q.y * ratio / radius), key};
}

void fill_weights(const StonesLayout& layout, const Scene& scene, Point p, double* weights) {
  const double u0 = p.x / layout.size_mm, v0 = p.y / layout.size_mm;
  const double u = u0 + layout.roughness * eval_fractal_noise(scene.stream(1), 3 * u0, 3 * v0, 3);
  const double v = v0 + layout.roughness * eval_fractal_noise(scene.stream(2), 3 * u0, 3 * v0, 3);
  Stone first, second;
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i) {
      const Stone stone = make_stone(layout, scene, u, v, std::floor(u) + i, std::floor(v) + j);
      if (stone.distance < first.distance) {
        second = first;
        first = stone;
      } else if (stone.distance < second.distance) {
        second = stone;
      }
    }
  // Elliptic distances change by about 2 per stone size: half their difference is the way to the
  // border between the two.
  const bool is_gap = (second.distance - first.distance) * layout.size_mm < 2 * layout.gap_mm;
  if (!(first.distance < 1) || is_gap) {
    weights[0] = 1;
    return;
  }
  const double choice = hash_to_uniform(hash_u64(first.key, 6));
  weights[1 + choose_share(layout.shares, scene.grid.materials - 1, choice)] = 1;
}

// Veins are the zero set of a noise; its value over its gradient is the distance from it.
double eval_vein(const VeinsLayout& layout, std::uint64_t seed, Point p) {
  Point q = rotate(p, layout.angle_deg);
  q = {q.x / (layout.spacing_mm * layout.stretch), q.y / layout.spacing_mm};
  const auto noise = [&](double u, double v) {
    return eval_fractal_noise(hash_u64(seed, 0), u, v, layout.octaves);
  };
  constexpr double h = 0.02;
  const double value = noise(q.x, q.y);
  const double du = (noise(q.x + h, q.y) - value) / (h * layout.spacing_mm * layout.stretch);
  const double dv = (noise(q.x, q.y + h) - value) / (h * layout.spacing_mm);
  const double distance = std::abs(value) / (std::hypot(du, dv) + 1e-12);
  const double width =
      layout.width_mm * std::exp(0.5 * eval_noise(hash_u64(seed, 1), 2 * q.x, 2 * q.y));
  // A normal variable exceeds t for the part `presence` of the plane; 1.7 approximates its scale.
  const double presence = std::clamp(layout.presence, 1e-6, 1 - 1e-6);
  const double fade =
      eval_noise(hash_u64(seed, 2), q.x, q.y) + std::log(presence / (1 - presence)) / 1.7;
  return std::exp(-4 * std::numbers::ln2 * distance * distance / (width * width)) *
         smoothstep(0.5 + 2 * fade);
}

void fill_weights(const VeinsLayout& layout, const Scene& scene, Point p, double* weights) {
  weights[0] = 1;
  for (int m = 1; m < scene.grid.materials; ++m) {
    const double vein = eval_vein(layout, scene.stream(static_cast<std::uint64_t>(m)), p);
    for (int i = 0; i < m; ++i) weights[i] *= 1 - vein;
    weights[m] = vein;
  }
}

void fill_weights(const LayersLayout& layout, const Scene& scene, Point p, double* weights) {
  const int n = scene.grid.materials;
  const Point q = rotate(p, layout.angle_deg);
  const double u = p.x / layout.wavelength_mm, v = p.y / layout.wavelength_mm;
  double t = q.y + layout.waviness_mm * eval_fractal_noise(scene.stream(0), u, v, 4);
  t += layout.irregularity * layout.thickness_mm *
       eval_noise(scene.stream(1), t / layout.thickness_mm, 0.5);
  double total = 0;
  for (const double share : layout.shares) total += share;
  const double period = layout.thickness_mm * n;
  t -= period * std::floor(t / period);
  const double softness = std::min(layout.softness_mm, period) + 1e-9;
  const auto step = [&](double edge) { return smoothstep(0.5 + (t - edge) / softness); };
  double edge = 0;
  for (int m = 0; m < n; ++m) {
    const double thickness = layout.shares.empty()
                                 ? period / n
                                 : period * layout.shares[static_cast<std::size_t>(m)] / total;
    const double next = m + 1 == n ? period : edge + thickness;
    // The periods before and after: their transitions reach into this one. The sum telescopes to 1.
    for (const double shift : {-period, 0.0, period})
      weights[m] += step(edge + shift) - step(next + shift);
    edge = next;
  }
}

void fill_weights(const MixingLayout& layout, const Scene& scene, Point p, double* weights) {
  const int n = scene.grid.materials;
  const double u = p.x / layout.wavelength_mm, v = p.y / layout.wavelength_mm;
  double largest = -INFINITY;
  for (int m = 0; m < n; ++m) {
    const double share = layout.shares.empty() ? 1 : layout.shares[static_cast<std::size_t>(m)];
    const auto index = static_cast<std::uint64_t>(m);
    weights[m] = std::log(share) +
                 layout.sharpness * eval_fractal_noise(scene.stream(index), u, v, layout.octaves);
    largest = std::max(largest, weights[m]);
  }
  double sum = 0;
  for (int m = 0; m < n; ++m) sum += weights[m] = std::exp(weights[m] - largest);
  for (int m = 0; m < n; ++m) weights[m] /= sum;
}

double grey_of(const Image& map, int x, int y) {
  x = std::clamp(x, 0, map.width - 1);
  y = std::clamp(y, 0, map.height - 1);
  if (map.channels < 3) return at(map, x, y, 0);
  return luminance(at(map, x, y, 0), at(map, x, y, 1), at(map, x, y, 2));
}

void fill_weights(const ImageLayout& layout, const Scene& scene, Point p, double* weights) {
  const LayoutGrid& grid = scene.grid;
  const double u = p.x / (grid.width * grid.pixel_pitch_mm) * layout.map.width - 0.5;
  const double v = p.y / (grid.height * grid.pixel_pitch_mm) * layout.map.height - 0.5;
  const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
  const double fx = u - x, fy = v - y;
  double grey =
      (1 - fy) * ((1 - fx) * grey_of(layout.map, x, y) + fx * grey_of(layout.map, x + 1, y)) +
      fy * ((1 - fx) * grey_of(layout.map, x, y + 1) + fx * grey_of(layout.map, x + 1, y + 1));
  grey = grey >= 0 ? std::min(grey, 1.0) : 0;  // NaN counts as 0
  if (!layout.thresholds.empty()) {
    const auto above = std::upper_bound(layout.thresholds.begin(), layout.thresholds.end(), grey);
    weights[above - layout.thresholds.begin()] = 1;
    return;
  }
  const double position = grey * (grid.materials - 1);
  const int lower = std::min(static_cast<int>(position), grid.materials - 2);
  weights[lower] = 1 - (position - lower);
  weights[lower + 1] = position - lower;
}

}  // namespace

std::vector<float> make_weights(const Layout& layout, const LayoutGrid& grid) {
  constexpr int points = 4;  // per pixel and axis
  constexpr int most = 16;
  PARIAN_CHECK_LE(1, grid.materials);
  PARIAN_CHECK_LE(grid.materials, most);
  const auto width = static_cast<std::size_t>(grid.width);
  const auto height = static_cast<std::size_t>(grid.height);
  const auto materials = static_cast<std::size_t>(grid.materials);
  std::vector<float> planes(materials * width * height);
  const Scene scene{grid};
  parallel_for(height, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      std::array<double, most> sum{};
      for (int k = 0; k < points * points; ++k) {
        const int column = k % points, row = k / points;
        const Point p{(static_cast<double>(x) + (column + 0.5) / points) * grid.pixel_pitch_mm,
                      (static_cast<double>(y) + (row + 0.5) / points) * grid.pixel_pitch_mm};
        std::array<double, most> weights{};
        std::visit([&](const auto& kind) { fill_weights(kind, scene, p, weights.data()); }, layout);
        for (std::size_t m = 0; m < materials; ++m) sum[m] += weights[m];
      }
      for (std::size_t m = 0; m < materials; ++m)
        planes[(m * height + y) * width + x] = static_cast<float>(sum[m] / (points * points));
    }
  });
  return planes;
}

}  // namespace parian

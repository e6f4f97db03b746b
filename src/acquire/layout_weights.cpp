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
  double x = 0, y = 0, z = 0;  // mm
};
Point rotate(Point p, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x + s * p.y, -s * p.x + c * p.y, p.z};
}

double smoothstep(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// What the layouts need beside their parameters. Streams of noise are numbered.
struct Scene {
  const LayoutGrid& grid;
  std::uint64_t stream(std::uint64_t index) const { return hash_u64(grid.seed, index); }

  // Noise over the plane, or in space.
  double noise(std::uint64_t seed, double u, double v, double w) const {
    return grid.solid ? eval_noise(seed, u, v, w) : eval_noise(seed, u, v);
  }
  double fractal(std::uint64_t seed, double u, double v, double w, int octaves) const {
    return grid.solid ? eval_fractal_noise(seed, u, v, w, octaves)
                      : eval_fractal_noise(seed, u, v, octaves);
  }
};

double length(const Scene& scene, Point p) {
  return scene.grid.solid ? std::hypot(p.x, p.y, p.z) : std::hypot(p.x, p.y);
}

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

// One stone per cell of a jittered lattice: an ellipse, or in space an ellipsoid. Returns the
// elliptic distance from its centre (1 on the outline), infinite where the place is empty.
struct Stone {
  double distance = INFINITY;
  std::uint64_t key = 0;
};
struct Cell {
  double u = 0, v = 0, w = 0;
};
std::uint64_t cell_index(double cell) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(cell));
}
Stone make_stone(const StonesLayout& layout, const Scene& scene, Point at, Cell cell) {
  std::uint64_t key = hash_u64(hash_u64(scene.stream(0), cell_index(cell.u)), cell_index(cell.v));
  if (scene.grid.solid) key = hash_u64(key, cell_index(cell.w));
  const auto uniform = [&](std::uint64_t index) { return hash_to_uniform(hash_u64(key, index)); };
  if (uniform(0) >= layout.coverage) return {};
  const Point from{at.x - (cell.u + 0.5 + 0.7 * (uniform(1) - 0.5)),
                   at.y - (cell.v + 0.5 + 0.7 * (uniform(2) - 0.5)),
                   scene.grid.solid ? at.z - (cell.w + 0.5 + 0.7 * (uniform(7) - 0.5)) : 0};
  const double radius = 0.55 * (1 + layout.spread * (2 * uniform(3) - 1));
  const double ratio = std::sqrt(1 + (layout.elongation - 1) * uniform(4));
  const Point q = rotate(from, 180 * uniform(5));
  return {length(scene, {q.x / (radius * ratio), q.y * ratio / radius, q.z * ratio / radius}), key};
}

void fill_weights(const StonesLayout& layout, const Scene& scene, Point p, double* weights) {
  const Point at{p.x / layout.size_mm, p.y / layout.size_mm, p.z / layout.size_mm};
  const auto roughness = [&](std::uint64_t stream) {
    if (layout.roughness == 0) return 0.0;
    return layout.roughness * scene.fractal(scene.stream(stream), 3 * at.x, 3 * at.y, 3 * at.z, 3);
  };
  const Point moved{at.x + roughness(1), at.y + roughness(2),
                    scene.grid.solid ? at.z + roughness(3) : 0};
  const int reach_w = scene.grid.solid ? 2 : 0;
  // Stones at an elliptic distance beyond this change nothing, and stand within their cells.
  const double most = (1 + 2 * layout.gap_mm / layout.size_mm) * 0.55 * (1 + layout.spread) *
                      std::sqrt(layout.elongation);
  const auto beyond = [](double x, double cell) {
    return std::max({0.0, cell + 0.15 - x, x - cell - 0.85});
  };
  Stone first, second;
  for (int k = -reach_w; k <= reach_w; ++k)
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i) {
        const Cell cell{std::floor(moved.x) + i, std::floor(moved.y) + j, std::floor(moved.z) + k};
        const double u = beyond(moved.x, cell.u), v = beyond(moved.y, cell.v);
        const double w = scene.grid.solid ? beyond(moved.z, cell.w) : 0;
        if (u * u + v * v + w * w > most * most) continue;
        const Stone stone = make_stone(layout, scene, moved, cell);
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
double eval_vein(const VeinsLayout& layout, const Scene& scene, std::uint64_t seed, Point p) {
  Point q = rotate(p, layout.angle_deg);
  q = {q.x / (layout.spacing_mm * layout.stretch), q.y / layout.spacing_mm,
       q.z / layout.spacing_mm};
  const auto noise = [&](double u, double v, double w) {
    return scene.fractal(hash_u64(seed, 0), u, v, w, layout.octaves);
  };
  constexpr double h = 0.02;
  const double value = noise(q.x, q.y, q.z);
  const double du = (noise(q.x + h, q.y, q.z) - value) / (h * layout.spacing_mm * layout.stretch);
  const double dv = (noise(q.x, q.y + h, q.z) - value) / (h * layout.spacing_mm);
  const double dw =
      scene.grid.solid ? (noise(q.x, q.y, q.z + h) - value) / (h * layout.spacing_mm) : 0;
  const double distance = std::abs(value) / (length(scene, {du, dv, dw}) + 1e-12);
  const double width =
      layout.width_mm * std::exp(0.5 * scene.noise(hash_u64(seed, 1), 2 * q.x, 2 * q.y, 2 * q.z));
  // A normal variable exceeds t for the part `presence` of the plane; 1.7 approximates its scale.
  const double presence = std::clamp(layout.presence, 1e-6, 1 - 1e-6);
  const double fade =
      scene.noise(hash_u64(seed, 2), q.x, q.y, q.z) + std::log(presence / (1 - presence)) / 1.7;
  return std::exp(-4 * std::numbers::ln2 * distance * distance / (width * width)) *
         smoothstep(0.5 + 2 * fade);
}

void fill_weights(const VeinsLayout& layout, const Scene& scene, Point p, double* weights) {
  weights[0] = 1;
  for (int m = 1; m < scene.grid.materials; ++m) {
    const double vein = eval_vein(layout, scene, scene.stream(static_cast<std::uint64_t>(m)), p);
    for (int i = 0; i < m; ++i) weights[i] *= 1 - vein;
    weights[m] = vein;
  }
}

void fill_weights(const LayersLayout& layout, const Scene& scene, Point p, double* weights) {
  const int n = scene.grid.materials;
  const Point q = rotate(p, layout.angle_deg);
  const double u = p.x / layout.wavelength_mm, v = p.y / layout.wavelength_mm;
  const double w = p.z / layout.wavelength_mm;
  double t = q.y + layout.waviness_mm * scene.fractal(scene.stream(0), u, v, w, 4);
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
  const double w = p.z / layout.wavelength_mm;
  double largest = -INFINITY;
  for (int m = 0; m < n; ++m) {
    const double share = layout.shares.empty() ? 1 : layout.shares[static_cast<std::size_t>(m)];
    const auto index = static_cast<std::uint64_t>(m);
    weights[m] = std::log(share) +
                 layout.sharpness * scene.fractal(scene.stream(index), u, v, w, layout.octaves);
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
  const auto images = static_cast<double>(layout.deeper.size() + 1);
  const double place = p.z / (grid.layers * grid.pixel_pitch_mm) * images;
  const auto index = static_cast<std::size_t>(std::clamp(place, 0.0, images - 1));
  const Image& map = index == 0 ? layout.map : layout.deeper[index - 1];
  const double u = p.x / (grid.width * grid.pixel_pitch_mm) * map.width - 0.5;
  const double v = p.y / (grid.height * grid.pixel_pitch_mm) * map.height - 0.5;
  const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
  const double fx = u - x, fy = v - y;
  double grey = (1 - fy) * ((1 - fx) * grey_of(map, x, y) + fx * grey_of(map, x + 1, y)) +
                fy * ((1 - fx) * grey_of(map, x, y + 1) + fx * grey_of(map, x + 1, y + 1));
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

// Shifts the point along the layout's tilt.
Point slant(const LayoutGrid& grid, Point p) {
  return {p.x - grid.slant_x * p.z, p.y - grid.slant_y * p.z, p.z};
}

}  // namespace

std::vector<float> make_weights(const Layout& layout, const LayoutGrid& grid) {
  constexpr int most = 16;
  PARIAN_CHECK_LE(1, grid.materials);
  PARIAN_CHECK_LE(grid.materials, most);
  const bool is_flat = grid.layers == 1;
  const int points = is_flat ? 4 : 2, deep = is_flat ? 1 : 2;  // per pixel and axis
  const auto width = static_cast<std::size_t>(grid.width + 2 * grid.margin);
  const auto height = static_cast<std::size_t>(grid.height + 2 * grid.margin);
  const auto layers = static_cast<std::size_t>(grid.layers);
  const auto materials = static_cast<std::size_t>(grid.materials);
  std::vector<float> planes(materials * layers * width * height);
  const Scene scene{grid};
  const auto coordinate = [&](std::size_t i, int k, int count) {
    return (static_cast<double>(i) + (k + 0.5) / count) * grid.pixel_pitch_mm;
  };
  const double margin_mm = grid.margin * grid.pixel_pitch_mm;
  parallel_for(layers * height, [&](std::size_t row) {
    const std::size_t z = row / height, y = row % height;
    for (std::size_t x = 0; x < width; ++x) {
      std::array<double, most> sum{};
      for (int k = 0; k < deep * points * points; ++k) {
        const Point p{coordinate(x, k % points, points) - margin_mm,
                      coordinate(y, k / points % points, points) - margin_mm,
                      is_flat ? 0 : coordinate(z, k / (points * points), deep)};
        std::array<double, most> weights{};
        std::visit(
            [&](const auto& kind) { fill_weights(kind, scene, slant(grid, p), weights.data()); },
            layout);
        for (std::size_t m = 0; m < materials; ++m) sum[m] += weights[m];
      }
      for (std::size_t m = 0; m < materials; ++m)
        planes[(m * layers * height + row) * width + x] =
            static_cast<float>(sum[m] / (deep * points * points));
    }
  });
  return planes;
}

}  // namespace parian

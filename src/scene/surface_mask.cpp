#include "scene/surface_mask.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "image/color.h"

namespace parian {
namespace {

constexpr double facing_cosine = 0.25881904510252074;  // of 75 degrees

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// 1 up to distance 0, falling to 0 over the feather.
double fall_off(double distance, double feather) {
  if (!(distance > 0)) return 1;
  return distance < feather ? smooth_step(1 - distance / feather) : 0;
}

double dot_double(Vec3 a, Vec3 b) {
  const auto d = [](float v) { return static_cast<double>(v); };
  return d(a.x) * d(b.x) + d(a.y) * d(b.y) + d(a.z) * d(b.z);
}

// Weights of the triangle's second and third vertex at the point: least squares in its plane.
Vec2 find_barycentric(const TriangleMesh& mesh, const SurfacePoint& point) {
  const auto& t = mesh.triangles[point.triangle];
  const Vec3 a = mesh.positions[t[0]];
  const Vec3 u = mesh.positions[t[1]] - a, v = mesh.positions[t[2]] - a, p = point.position - a;
  const double uu = dot_double(u, u), uv = dot_double(u, v), vv = dot_double(v, v);
  const double pu = dot_double(p, u), pv = dot_double(p, v);
  const double det = uu * vv - uv * uv;
  if (!(det > 0)) return {};
  const double s = std::clamp((pu * vv - pv * uv) / det, 0.0, 1.0);
  return {static_cast<float>(s),
          static_cast<float>(std::clamp((pv * uu - pu * uv) / det, 0.0, 1 - s))};
}

// Bilinear at pixel coordinates (centres at integers); `index` maps those outside to pixels.
template <typename Index>
double eval_image(const Image& image, double x, double y, const Index& index) {
  const double x0 = std::floor(x), y0 = std::floor(y);
  const double fx = x - x0, fy = y - y0;
  const auto value = [&](double column, double row) {
    return static_cast<double>(at(image, index(column, image.width), index(row, image.height), 0));
  };
  const double top = (1 - fx) * value(x0, y0) + fx * value(x0 + 1, y0);
  const double bottom = (1 - fx) * value(x0, y0 + 1) + fx * value(x0 + 1, y0 + 1);
  return (1 - fy) * top + fy * bottom;
}

int clamp_index(double i, int size) {
  return static_cast<int>(std::clamp(i, 0.0, size - 1.0));
}
int wrap_index(double i, int size) {
  return static_cast<int>(std::clamp(i - std::floor(i / size) * size, 0.0, size - 1.0));
}

// Values at random on a lattice, blended smoothly between its points.
double eval_noise(std::uint64_t seed, const double (&p)[3]) {
  std::int64_t cell[3];
  double f[3];
  for (int i = 0; i < 3; ++i) {
    const double floor = std::floor(p[i]);
    cell[i] = static_cast<std::int64_t>(floor);
    f[i] = smooth_step(p[i] - floor);
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    std::uint64_t hash = hash_u64(seed);
    double weight = 1;
    for (int i = 0; i < 3; ++i) {
      const int step = (corner >> i) & 1;
      hash = hash_u64(hash, static_cast<std::uint64_t>(cell[i] + step));
      weight *= step != 0 ? f[i] : 1 - f[i];
    }
    sum += weight * hash_to_uniform(hash);
  }
  return sum;
}

struct EvalShape {
  const TriangleMesh& mesh;
  const SurfacePoint& point;

  double operator()(const VertexMask& mask) const {
    const auto& t = mesh.triangles[point.triangle];
    const Vec2 b = find_barycentric(mesh, point);
    const auto weight = [&](std::uint32_t v) {
      return static_cast<double>(mask.weights[mesh.source.empty() ? v : mesh.source[v]]);
    };
    const double first = weight(t[0]);  // equal weights are kept to the bit
    return first + static_cast<double>(b.x) * (weight(t[1]) - first) +
           static_cast<double>(b.y) * (weight(t[2]) - first);
  }
  double operator()(const TextureMask& mask) const {
    return eval_image(mask.image, static_cast<double>(point.texcoord.x) * mask.image.width - 0.5,
                      static_cast<double>(point.texcoord.y) * mask.image.height - 0.5, wrap_index);
  }
  double operator()(const ProjectedMask& mask) const {
    const Vec3 right = normalize(cross(mask.direction, mask.up));
    const Vec3 down = cross(mask.direction, right);
    const Vec3 p = point.position - mask.center;
    const double x = dot_double(p, right), y = dot_double(p, down);
    const double outside =
        std::max(std::abs(x) - mask.width_mm / 2, std::abs(y) - mask.height_mm / 2);
    double weight = fall_off(outside, mask.feather_mm);
    if (mask.facing)
      weight *= smooth_step(-dot_double(point.normal, mask.direction) / facing_cosine);
    if (weight == 0 || mask.image.width == 0) return weight;
    return weight * eval_image(mask.image, (x / mask.width_mm + 0.5) * mask.image.width - 0.5,
                               (y / mask.height_mm + 0.5) * mask.image.height - 0.5, clamp_index);
  }
  double operator()(const GradientMask& mask) const {
    const Vec3 way = mask.to - mask.from;
    return smooth_step(dot_double(point.position - mask.from, way) / dot_double(way, way));
  }
  double operator()(const SphereMask& mask) const {
    const Vec3 p = point.position - mask.center;
    return fall_off(std::sqrt(dot_double(p, p)) - mask.radius_mm, mask.feather_mm);
  }
  double operator()(const SlabMask& mask) const {
    const double d = dot_double(point.position - mask.point, mask.direction);
    const double beyond = mask.thickness_mm > 0 ? d - mask.thickness_mm : 0;
    return fall_off(std::max(-d, beyond), mask.feather_mm);
  }
  double operator()(const NoiseMask& mask) const {
    double sum = 0, weights = 0, weight = 1, scale = 1 / mask.scale_mm;
    for (int octave = 0; octave < mask.octaves; ++octave) {
      const double p[3] = {static_cast<double>(point.position.x) * scale,
                           static_cast<double>(point.position.y) * scale,
                           static_cast<double>(point.position.z) * scale};
      sum += weight * eval_noise(mask.seed + static_cast<std::uint64_t>(octave), p);
      weights += weight;
      weight /= 2;
      scale *= 2;
    }
    return fall_off(mask.threshold - sum / weights, mask.softness);
  }
  double operator()(const StripesMask& mask) const {
    const double d = dot_double(point.position, mask.direction) - mask.offset_mm;
    const double in_period = d - std::floor(d / mask.period_mm) * mask.period_mm;
    const double after = in_period - mask.fraction * mask.period_mm;
    return fall_off(std::min(after, mask.period_mm - in_period), mask.feather_mm);
  }
};

void check_direction(Vec3 v, const char* name) {
  if (!is_finite(v) || !(std::abs(length(v) - 1) < 1e-3f))
    throw Error({{}, name, "a unit vector", fmt::format("[{}, {}, {}]", v.x, v.y, v.z)});
}
void check_place(Vec3 v, const char* name) {
  if (!is_finite(v))
    throw Error({{}, name, "finite numbers", fmt::format("[{}, {}, {}]", v.x, v.y, v.z)});
}

// What descriptions do not say: vectors and data.
struct CheckVectors {
  void operator()(const VertexMask& mask) const {
    for (std::size_t i = 0; i < mask.weights.size(); ++i)
      if (!(mask.weights[i] >= 0 && mask.weights[i] <= 1))
        throw Error({{},
                     fmt::format("weight {}", i),
                     "a value in [0, 1]",
                     fmt::to_string(mask.weights[i])});
  }
  void operator()(const TextureMask& mask) const {
    if (mask.image.width < 1 || mask.image.height < 1) throw Error({{}, "image", "pixels", "none"});
  }
  void operator()(const ProjectedMask& mask) const {
    check_place(mask.center, "center");
    check_direction(mask.direction, "direction");
    check_direction(mask.up, "up");
    if (!(length(cross(mask.direction, mask.up)) > 1e-3f))
      throw Error({{}, "up", "another direction than that in which it is cast", "the same"});
  }
  void operator()(const GradientMask& mask) const {
    check_place(mask.from, "from");
    check_place(mask.to, "to");
    if (mask.from == mask.to) throw Error({{}, "to", "another point than 'from'", "the same"});
  }
  void operator()(const SphereMask& mask) const { check_place(mask.center, "center"); }
  void operator()(const SlabMask& mask) const {
    check_place(mask.point, "point");
    check_direction(mask.direction, "direction");
  }
  void operator()(const NoiseMask&) const {}
  void operator()(const StripesMask& mask) const { check_direction(mask.direction, "direction"); }
};

struct CheckShape {
  template <typename Shape>
  void operator()(const Shape& shape) const {
    check(describe(const_cast<Shape&>(shape)));  // checks only read
    CheckVectors{}(shape);
  }
};

Param length_param(const char* name, const char* help, double& target, bool above_min) {
  return {.name = name,
          .help = help,
          .target = &target,
          .min = 0,
          .max = 1e6,
          .above_min = above_min,
          .unit = "mm"};
}
Param feather_param(double& target) {
  return length_param("feather-mm", "over which the edge falls, beyond it", target, false);
}

}  // namespace

ParamList describe(VertexMask&) {
  return {};
}
ParamList describe(TextureMask&) {
  return {};
}
ParamList describe(ProjectedMask& mask) {
  return {length_param("width-mm", "of the rectangle", mask.width_mm, true),
          length_param("height-mm", "of the rectangle", mask.height_mm, true),
          feather_param(mask.feather_mm),
          {.name = "facing", .help = "only on faces that look at it", .target = &mask.facing}};
}
ParamList describe(GradientMask&) {
  return {};
}
ParamList describe(SphereMask& mask) {
  return {length_param("radius-mm", "within which it is 1", mask.radius_mm, false),
          feather_param(mask.feather_mm)};
}
ParamList describe(SlabMask& mask) {
  return {
      length_param("thickness-mm", "from the point on; 0: without end", mask.thickness_mm, false),
      feather_param(mask.feather_mm)};
}
ParamList describe(NoiseMask& mask) {
  return {{.name = "scale-mm",
           .help = "of the largest cells",
           .target = &mask.scale_mm,
           .min = 0.001,
           .max = 1e6,
           .unit = "mm"},
          {.name = "threshold",
           .help = "above which it is 1",
           .target = &mask.threshold,
           .min = 0,
           .max = 1},
          {.name = "softness",
           .help = "over which it falls below the threshold",
           .target = &mask.softness,
           .min = 0,
           .max = 1},
          {.name = "octaves",
           .help = "each of half the size and weight",
           .target = &mask.octaves,
           .min = 1,
           .max = 8},
          {.name = "seed", .help = "of the noise", .target = &mask.seed}};
}
ParamList describe(StripesMask& mask) {
  return {{.name = "period-mm",
           .help = "from stripe to stripe",
           .target = &mask.period_mm,
           .min = 0.001,
           .max = 1e6,
           .unit = "mm"},
          {.name = "fraction",
           .help = "of the period that a stripe covers",
           .target = &mask.fraction,
           .min = 0,
           .max = 1},
          {.name = "offset-mm",
           .help = "of a stripe's edge from the origin",
           .target = &mask.offset_mm,
           .min = -1e6,
           .max = 1e6,
           .unit = "mm"},
          feather_param(mask.feather_mm)};
}

Image make_mask_image(const Image& image, const std::string& name) {
  const bool has_colours = image.channels >= 3;
  Image mask = make_image(image.width, image.height, 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float value =
          has_colours ? luminance(at(image, x, y, 0), at(image, x, y, 1), at(image, x, y, 2))
                      : at(image, x, y, 0);
      if (!std::isfinite(value))
        throw Error(
            {name, fmt::format("pixel ({}, {})", x, y), "a finite weight", fmt::to_string(value)});
      at(mask, x, y, 0) = std::clamp(value, 0.0f, 1.0f);
    }
  return mask;
}

void check(const SurfaceMask& mask, const TriangleMesh& mesh, const std::string& file,
           const std::string& place) {
  const std::size_t vertices = count_source_vertices(mesh);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const MaskShape& shape = mask[i].shape;
    const std::string here = mask.size() == 1 ? place : fmt::format("{}/{}", place, i);
    try {
      std::visit(CheckShape{}, shape);
    } catch (const Error& error) {
      std::string key = error.parts.place;
      std::replace(key.begin(), key.end(), '-', '_');
      throw Error({file, here + "/" + key, error.parts.expected, error.parts.found});
    }
    if (const auto* painted = std::get_if<VertexMask>(&shape);
        painted != nullptr && painted->weights.size() != vertices)
      throw Error({file, here, fmt::format("{} weights, one per vertex of the mesh", vertices),
                   fmt::to_string(painted->weights.size())});
    if (std::holds_alternative<TextureMask>(shape) && mesh.texcoords.empty())
      throw Error(
          {file, here, "a mesh with texture coordinates, as the mask is an image on them", "none"});
  }
}

double eval_mask(const SurfaceMask& mask, const TriangleMesh& mesh, const SurfacePoint& point) {
  double product = 1;
  for (const MaskTerm& term : mask) {
    const double weight = std::clamp(std::visit(EvalShape{mesh, point}, term.shape), 0.0, 1.0);
    product *= term.invert ? 1 - weight : weight;
    if (product == 0) break;
  }
  return product;
}

}  // namespace parian

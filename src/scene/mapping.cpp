#include "scene/mapping.h"

#include <cmath>
#include <numbers>

namespace parian {
namespace {

// A place on the surface in mm, and the directions in which its coordinates grow.
struct Place {
  double x = 0;
  double y = 0;
  Vec3 along_x;
  Vec3 along_y;
};

// The axis to which the normal is nearest; z before x before y where they tie. Signs are chosen so
// that places agree where |x| = |z| on the upright faces, all around, and where y = +-z in front.
Place project_to_box(const SurfacePoint& point) {
  const Vec3 p = point.position, n = point.normal;
  const float ax = std::abs(n.x), ay = std::abs(n.y), az = std::abs(n.z);
  const auto sign = [](float v) { return std::copysign(1.0f, v); };
  if (az >= ax && az >= ay) {
    const float s = sign(n.z);
    return {s * p.x, -p.y, {s, 0, 0}, {0, -1, 0}};
  }
  if (ax >= ay) {
    const float s = sign(n.x);
    return {s * p.z, -p.y, {0, 0, s}, {0, -1, 0}};
  }
  const float s = sign(n.y);
  return {p.x, -s * p.z, {1, 0, 0}, {0, 0, -s}};
}

// The orthonormal pair in the normal's tangent plane that is nearest to both directions (polar
// decomposition of the 2 x 2 matrix of their components), of their handedness.
void orthonormalize(Vec3 normal, Vec3& along_x, Vec3& along_y) {
  const Frame frame = make_frame(normal);
  const auto in_plane = [&](Vec3 v) {
    const Vec2 t{dot(frame.tangent, v), dot(frame.bitangent, v)};
    const float l = std::sqrt(t.x * t.x + t.y * t.y);
    return l > 0 ? t * (1 / l) : t;
  };
  const Vec2 a = in_plane(along_x), b = in_plane(along_y);
  const float hand = a.x * b.y - a.y * b.x < 0 ? -1.0f : 1.0f;
  float c = a.x + hand * b.y, s = a.y - hand * b.x;
  const float l = std::sqrt(c * c + s * s);
  if (!(l > 0)) {
    c = 1, s = 0;
  } else {
    c /= l, s /= l;
  }
  along_x = frame.tangent * c + frame.bitangent * s;
  along_y = (frame.bitangent * c - frame.tangent * s) * hand;
}

}  // namespace

double mirror_tile(double x, int size, bool& mirrored) {
  const double period = 2.0 * size;
  double t = std::fmod(x + 0.5, period);
  mirrored = false;
  if (!(std::abs(t) < period)) return -0.5;  // not a number
  if (t < 0) t += period;
  mirrored = t >= size;
  if (t == size) return std::nextafter(size - 0.5, 0.0);  // the border belongs to neither
  return (mirrored ? period - t : t) - 0.5;
}

SamplePoint map_to_sample(const Mapping& mapping, const SampleGrid& grid,
                          const SurfacePoint& point) {
  Place place;
  if (mapping.kind == MappingKind::uv) {
    const double size =
        mapping.uv_size_mm > 0 ? mapping.uv_size_mm : grid.width * grid.pixel_pitch_mm;
    place = {point.texcoord.x * size, point.texcoord.y * size, point.dp_du, point.dp_dv};
  } else {
    place = project_to_box(point);
  }
  orthonormalize(point.normal, place.along_x, place.along_y);

  // place = offset + scale R(rotation) p, p in mm of the sample
  const double angle = mapping.rotation_deg * std::numbers::pi / 180;
  const double c = std::cos(angle), s = std::sin(angle);
  const double dx = (place.x - mapping.offset_mm.x) / mapping.scale;
  const double dy = (place.y - mapping.offset_mm.y) / mapping.scale;
  bool mirrored_x = false, mirrored_y = false;
  SamplePoint sample;
  sample.x = mirror_tile((c * dx + s * dy) / grid.pixel_pitch_mm - 0.5, grid.width, mirrored_x);
  sample.y = mirror_tile((c * dy - s * dx) / grid.pixel_pitch_mm - 0.5, grid.height, mirrored_y);
  const auto cf = static_cast<float>(c), sf = static_cast<float>(s);
  sample.along_x = place.along_x * cf + place.along_y * sf;
  sample.along_y = place.along_y * cf - place.along_x * sf;
  if (mirrored_x) sample.along_x = -sample.along_x;
  if (mirrored_y) sample.along_y = -sample.along_y;
  return sample;
}

}  // namespace parian

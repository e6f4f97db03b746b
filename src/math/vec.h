// Vectors of two and three floats, frames and boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace parian {

struct Vec2 {
  float x = 0;
  float y = 0;
  friend bool operator==(const Vec2&, const Vec2&) = default;
};
constexpr Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.y + b.y};
}
constexpr Vec2 operator-(Vec2 a, Vec2 b) {
  return {a.x - b.x, a.y - b.y};
}
constexpr Vec2 operator*(Vec2 a, float s) {
  return {a.x * s, a.y * s};
}
constexpr Vec2 operator*(float s, Vec2 a) {
  return a * s;
}

struct Vec3 {
  float x = 0;
  float y = 0;
  float z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};
constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator-(Vec3 a) {
  return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(Vec3 a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
constexpr Vec3 operator*(float s, Vec3 a) {
  return a * s;
}
constexpr Vec3 operator*(Vec3 a, Vec3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
constexpr Vec3 operator/(Vec3 a, float s) {
  return a * (1 / s);
}
constexpr Vec3& operator+=(Vec3& a, Vec3 b) {
  return a = a + b;
}
constexpr Vec3& operator*=(Vec3& a, float s) {
  return a = a * s;
}

constexpr float dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
inline float distance(Vec3 a, Vec3 b) {
  return length(b - a);
}
// Zero stays zero.
inline Vec3 normalize(Vec3 a) {
  const float l = length(a);
  return l > 0 ? a / l : a;
}
inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
constexpr Vec3 min(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
constexpr Vec3 max(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

// Linear Rec. 709: x red, y green, z blue.
using Rgb = Vec3;

// Orthonormal, right-handed: cross(tangent, bitangent) = normal.
struct Frame {
  Vec3 tangent{1, 0, 0};
  Vec3 bitangent{0, 1, 0};
  Vec3 normal{0, 0, 1};
};
// From a unit normal (Duff et al. 2017: continuous but at the south pole).
inline Frame make_frame(Vec3 normal) {
  const float sign = std::copysign(1.0f, normal.z);
  const float a = -1 / (sign + normal.z);
  const float b = normal.x * normal.y * a;
  return {{1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
          {b, sign + normal.y * normal.y * a, -normal.y},
          normal};
}
constexpr Vec3 to_world(const Frame& frame, Vec3 local) {
  return frame.tangent * local.x + frame.bitangent * local.y + frame.normal * local.z;
}
constexpr Vec3 to_local(const Frame& frame, Vec3 world) {
  return {dot(frame.tangent, world), dot(frame.bitangent, world), dot(frame.normal, world)};
}

// Axis-aligned box; empty until it is extended.
struct Bounds3 {
  Vec3 lower{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
             std::numeric_limits<float>::infinity()};
  Vec3 upper{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
             -std::numeric_limits<float>::infinity()};
};
constexpr void extend(Bounds3& box, Vec3 point) {
  box.lower = min(box.lower, point);
  box.upper = max(box.upper, point);
}
inline Vec3 extent(const Bounds3& box) {
  return box.upper - box.lower;
}
inline Vec3 center(const Bounds3& box) {
  return (box.lower + box.upper) * 0.5f;
}
// 0, 1 or 2 for x, y or z.
constexpr float component(Vec3 a, int axis) {
  return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
inline int longest_axis(const Bounds3& box) {
  const Vec3 size = extent(box);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}
inline float diagonal(const Bounds3& box) {
  return length(extent(box));
}

}  // namespace parian

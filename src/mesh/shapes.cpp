#include "mesh/shapes.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "base/names.h"
#include "mesh/topology_internal.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

std::uint32_t vertex_count(const TriangleMesh& mesh) {
  return static_cast<std::uint32_t>(mesh.positions.size());
}

void add_vertex(TriangleMesh& mesh, Vec3 position, Vec3 normal, Vec2 texcoord) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.texcoords.push_back(texcoord);
}

// Corners counter-clockwise; split along a-c.
void add_quad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
              std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

// Scaled to a longest side of 1 and centred on the origin.
void center_and_scale(TriangleMesh& mesh) {
  fit_to_size(mesh, 1);
  const Vec3 middle = center(bounds(mesh));
  for (Vec3& p : mesh.positions) p = p - middle;
}

// Latitude over v, longitude over u: from 0 to 1 over one half of the sphere and back over the
// other, so that there is no seam.
Vec2 sphere_texcoord(Vec3 p) {
  const double longitude = std::abs(std::atan2(p.x, p.z));
  const double latitude = std::acos(std::clamp<double>(p.y, -1, 1));
  return {static_cast<float>(longitude / pi), static_cast<float>(latitude / pi)};
}

TriangleMesh make_icosahedron() {
  TriangleMesh mesh;
  const double golden = (1 + std::sqrt(5.0)) / 2;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-golden, golden}) {
        const std::array<double, 3> p{0, a, b};
        mesh.positions.push_back(to_unit({p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]}));
      }
    }
  }
  // Faces: three vertices at the edge's length, 1.05, from each other.
  for (std::uint32_t a = 0; a < 12; ++a) {
    for (std::uint32_t b = a + 1; b < 12; ++b) {
      for (std::uint32_t c = b + 1; c < 12; ++c) {
        const Vec3 p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
        if (std::max({distance(p, q), distance(q, r), distance(r, p)}) > 1.1f) continue;
        const bool outward = dot(cross(q - p, r - p), p) > 0;
        mesh.triangles.push_back(outward ? Triangle{a, b, c} : Triangle{a, c, b});
      }
    }
  }
  return mesh;
}

// Four triangles for one, their new vertices on the unit sphere.
void subdivide_sphere(TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, added] = middles.try_emplace(std::minmax(a, b), vertex_count(mesh));
    if (added)
      mesh.positions.push_back(
          to_unit(to_double(mesh.positions[a]) + to_double(mesh.positions[b])));
    return at->second;
  };
  std::vector<Triangle> finer;
  finer.reserve(4 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  mesh.triangles = std::move(finer);
}

// One face of a box, seen from outside: `right` and `down` span it around `middle` (half sides).
void add_face(TriangleMesh& mesh, Vec3 middle, Vec3 right, Vec3 down, int divisions) {
  const std::uint32_t first = vertex_count(mesh);
  const Vec3 normal = normalize(middle);
  const auto n = static_cast<float>(divisions);
  // Corner signs are exact, so that the edges of neighbouring faces meet bit for bit.
  const auto coordinate = [n](int i) { return (2 * static_cast<float>(i) - n) / n; };
  for (int y = 0; y <= divisions; ++y)
    for (int x = 0; x <= divisions; ++x)
      add_vertex(mesh, middle + right * coordinate(x) + down * coordinate(y), normal,
                 {static_cast<float>(x) / n, static_cast<float>(y) / n});
  const auto at = [&](int x, int y) {
    return first + static_cast<std::uint32_t>(y * (divisions + 1) + x);
  };
  for (int y = 0; y < divisions; ++y)
    for (int x = 0; x < divisions; ++x)
      add_quad(mesh, at(x, y + 1), at(x + 1, y + 1), at(x + 1, y), at(x, y));
}

// ---- the knot: a (2, 3) torus knot, its tube thick and thin in turn, with staggered knobs

struct KnotSection {
  Vec3d middle;
  Vec3d normal;
  Vec3d binormal;
};

Vec3d knot_curve(double t) {
  const double ring = 2.4 + std::cos(3 * t);
  return {ring * std::cos(2 * t), ring * std::sin(2 * t), 0.9 * std::sin(3 * t)};
}

// The frame turns with the direction from the torus's core, which the curve never meets: it closes.
KnotSection knot_section(double t) {
  const double step = 1e-5;
  const Vec3d middle = knot_curve(t);
  const Vec3d tangent = knot_curve(t + step) - knot_curve(t - step);
  const Vec3d core{2.4 * std::cos(2 * t), 2.4 * std::sin(2 * t), 0};
  Vec3d binormal = cross(tangent, middle - core);
  binormal = binormal * (1 / length(binormal));
  Vec3d normal = cross(binormal, tangent);
  return {middle, normal * (1 / length(normal)), binormal};
}

double knot_radius(double t, double angle) {
  const double tube = 0.34 + 0.14 * std::cos(3 * t + 0.6) + 0.05 * std::cos(5 * t);
  // Knobs in rows around the tube, every other row turned by half a knob.
  const double wave = std::cos(33 * t) * std::cos(3 * angle);
  const double knob = std::pow(std::max(0.0, wave), 3);
  return tube * (1 + 0.45 * knob);
}

// ---- the fin: a curtain hung from a curved rod, its folds deeper and its hem scalloped below

Vec3d fin_sheet(double s, double t) {
  const double c = 2 * s - 1;  // -1 to 1 across
  const double depth = 0.03 + 0.13 * t * t * (3 - 2 * t);
  const double fold =
      std::sin(2 * pi * (3.5 * s + 0.12 * t)) + 0.35 * std::sin(2 * pi * (2 * s - 0.4 * t) + 1);
  const double width = 0.5 + 0.12 * t * t;
  const double hem = 0.06 * std::cos(2 * pi * 3.5 * s) - 0.12 * c * c;
  return {c * width, 0.55 - 0.08 * c * c - (1.05 + hem) * t, depth * fold + 0.16 * t * c * c};
}

// Distance of a grid line from the sheet's border, 0 to 1 / 2, finer towards the border where the
// sheet's rounded edge is.
double fin_parameter(int i, int n) {
  const double x = static_cast<double>(i) / n;
  return x - 0.75 * std::sin(2 * pi * x) / (2 * pi);
}

double fin_half_thickness(double s, double t) {
  const double rim = std::min({s, 1 - s, t, 1 - t}) / 0.02;
  const double q = 1 - std::min(1.0, rim);
  return 0.011 * std::sqrt(std::max(0.0, 1 - q * q));
}

Vec3d fin_normal(double s, double t) {
  const double step = 1e-5;
  const Vec3d along = fin_sheet(s + step, t) - fin_sheet(s - step, t);
  const Vec3d down = fin_sheet(s, t + step) - fin_sheet(s, t - step);
  const Vec3d normal = cross(down, along);
  return normal * (1 / length(normal));
}

// side +1: the front, facing +z where the sheet is flat; -1: the back.
void add_fin_side(TriangleMesh& mesh, int columns, int rows, int side) {
  const std::uint32_t first = vertex_count(mesh);
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double s = fin_parameter(i, columns);
      const double t = fin_parameter(j, rows);
      const bool border = i == 0 || i == columns || j == 0 || j == rows;
      const double offset = border ? 0 : side * fin_half_thickness(s, t);
      const Vec3 p = to_float(fin_sheet(s, t) + fin_normal(s, t) * offset);
      add_vertex(mesh, p, {}, {static_cast<float>(s), static_cast<float>(t)});
    }
  }
  const auto at = [&](int i, int j) {
    return first + static_cast<std::uint32_t>(j * (columns + 1) + i);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const std::array<std::uint32_t, 4> q{at(i, j + 1), at(i + 1, j + 1), at(i + 1, j), at(i, j)};
      // Diagonals point at the centre: a corner cut off would be shared by front and back.
      const bool turn = (2 * i < columns) == (2 * j < rows);
      const std::size_t k = turn ? 1 : 0;
      if (side > 0) {
        add_quad(mesh, q[k], q[k + 1], q[k + 2], q[(k + 3) % 4]);
      } else {
        add_quad(mesh, q[k], q[(k + 3) % 4], q[k + 2], q[k + 1]);
      }
    }
  }
}

}  // namespace

TriangleMesh make_sphere(int subdivisions) {
  PARIAN_CHECK_LE(0, subdivisions);
  PARIAN_CHECK_LE(subdivisions, 10);
  TriangleMesh mesh = make_icosahedron();
  for (int level = 0; level < subdivisions; ++level) subdivide_sphere(mesh);
  mesh.normals = mesh.positions;
  for (const Vec3& p : mesh.positions) mesh.texcoords.push_back(sphere_texcoord(p));
  return mesh;
}

TriangleMesh make_box(Vec3 size, int divisions) {
  PARIAN_CHECK_LE(1, divisions);
  PARIAN_CHECK(size.x > 0 && size.y > 0 && size.z > 0);
  const Vec3 x{size.x / 2, 0, 0}, y{0, size.y / 2, 0}, z{0, 0, size.z / 2};
  TriangleMesh mesh;
  add_face(mesh, z, x, -y, divisions);
  add_face(mesh, -z, -x, -y, divisions);
  add_face(mesh, x, -z, -y, divisions);
  add_face(mesh, -x, z, -y, divisions);
  add_face(mesh, y, x, z, divisions);
  add_face(mesh, -y, x, -z, divisions);
  return mesh;
}

TriangleMesh make_plane(double size, int divisions) {
  PARIAN_CHECK_LE(1, divisions);
  PARIAN_CHECK_LT(0.0, size);
  const auto half = static_cast<float>(size / 2);
  TriangleMesh mesh;
  add_face(mesh, {0, half, 0}, {half, 0, 0}, {0, 0, half}, divisions);
  for (Vec3& p : mesh.positions) p.y = 0;
  return mesh;
}

TriangleMesh make_knot(int detail) {
  PARIAN_CHECK_LE(1, detail);
  const int along = 528 * detail;
  const int around = 42 * detail;
  TriangleMesh mesh;
  for (int i = 0; i <= along; ++i) {
    // The last section is the first again, bit for bit, with u = 1.
    const double t = 2 * pi * (i % along) / along;
    const KnotSection section = knot_section(t);
    for (int j = 0; j <= around; ++j) {
      const double angle = 2 * pi * (j % around) / around;
      const double r = knot_radius(t, angle);
      const Vec3d p = section.middle + section.normal * (r * std::cos(angle)) +
                      section.binormal * (r * std::sin(angle));
      add_vertex(mesh, to_float(p), {},
                 {static_cast<float>(i) / static_cast<float>(along),
                  static_cast<float>(j) / static_cast<float>(around)});
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (around + 1) + j); };
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < around; ++j)
      add_quad(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  center_and_scale(mesh);
  compute_normals(mesh);
  return mesh;
}

TriangleMesh make_fin(int detail) {
  PARIAN_CHECK_LE(1, detail);
  TriangleMesh mesh;
  add_fin_side(mesh, 128 * detail, 96 * detail, 1);
  add_fin_side(mesh, 128 * detail, 96 * detail, -1);
  center_and_scale(mesh);
  compute_normals(mesh);
  return mesh;
}

const std::vector<std::string>& shape_names() {
  static const std::vector<std::string> names{"sphere", "box", "slab", "knot", "fin"};
  return names;
}

TriangleMesh make_shape(std::string_view name) {
  if (name == "sphere") return make_sphere(5);
  if (name == "box") return make_box({1, 1, 1}, 48);
  if (name == "slab") return make_box({1, 1, 0.1f}, 48);
  if (name == "knot") return make_knot();
  if (name == "fin") return make_fin();
  const std::string nearest = nearest_name(name, shape_names());
  throw Error({.place = "shape",
               .expected = list_names(shape_names()),
               .found = nearest.empty() ? fmt::format("'{}'", name)
                                        : fmt::format("'{}' (did you mean '{}'?)", name, nearest)});
}

}  // namespace parian

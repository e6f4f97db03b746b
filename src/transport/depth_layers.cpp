#include "transport/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "transport/depth_kernels.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t none = 0xffffffffu;
// Steeper entries are followed no further within a texel: they transmit little.
constexpr float max_slope = 8;
// Texel centres this close to an edge belong to both of its triangles: no gaps.
constexpr float edge_tolerance = 1e-3f;
// A map is made in bands of so many rows, which stay in the cache.
constexpr int band_rows = 32;

// A triangle in the map's space: places in texels, depth as a plane, weights of its corners.
struct Projected {
  Vec3 corner[3];
  float area = 0;  // twice, signed: > 0 where it faces the light
};

Projected project(const TriangleMesh& mesh, const std::vector<Vec3>& places, std::size_t triangle) {
  Projected projected;
  for (std::size_t i = 0; i < 3; ++i) projected.corner[i] = places[mesh.triangles[triangle][i]];
  const Vec3 a = projected.corner[1] - projected.corner[0],
             b = projected.corner[2] - projected.corner[0];
  projected.area = a.x * b.y - a.y * b.x;
  return projected;
}

Vec2 slope_of(const Projected& t) {
  const Vec3 a = t.corner[1] - t.corner[0], b = t.corner[2] - t.corner[0];
  return {(a.z * b.y - b.z * a.y) / t.area, (b.z * a.x - a.z * b.x) / t.area};
}

// Texel columns or rows of [begin, end) whose centres lie in [low, high].
struct Span {
  int first = 0, last = 0;
};
Span find_span(float a, float b, float c, int begin, int end) {
  const float low = std::min({a, b, c}) - edge_tolerance,
              high = std::max({a, b, c}) + edge_tolerance;
  return {std::max(begin, static_cast<int>(std::ceil(low - 0.5f))),
          std::min(end - 1, static_cast<int>(std::floor(high - 0.5f)))};
}

// x start + step y bounds a row of a triangle, from the line from p to q; x and y are texels from
// `origin`. The triangle lies to the left of the line, edge_tolerance more belongs to it.
struct Edge {
  float start = 0, step = 0;
  bool is_lower = false, is_flat = false;  // a flat one bounds y: start + step y >= 0
};
Edge make_edge(Vec3 p, Vec3 q, Vec2 origin) {
  const float dx = q.x - p.x, dy = q.y - p.y;
  const float inside = dx * (origin.y - p.y) - dy * (origin.x - p.x) +
                       edge_tolerance * (std::abs(dx) + std::abs(dy));
  // inside + dx y - dy x >= 0
  if (std::abs(dy) <= 1e-6f * std::abs(dx)) return {inside, dx, false, true};
  return {inside / dy, dx / dy, dy < 0, false};
}

// Columns of a row within an edge.
void clip(const Edge& edge, float y, float& low, float& high) {
  const float x = edge.start + edge.step * y;
  if (edge.is_flat)
    high = x >= 0 ? high : -1;
  else if (edge.is_lower)
    low = std::max(low, x);
  else
    high = std::min(high, x);
}

// Rows [begin, end) of a map.
struct Band {
  int width = 0, begin = 0, end = 0;
  // Nearest to the light; of surfaces that look away from it the depth alone.
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;
  std::vector<float> exit;  // the nearest back face behind it

  std::size_t start_of(int row) const {
    return static_cast<std::size_t>(row - begin) * static_cast<std::size_t>(width);
  }
};

// Calls body(texel of the band, depth) at each texel whose centre the triangle covers.
template <typename Body>
void cover(const Band& band, const Projected& t, const Body& body) {
  const Vec3 a = t.corner[0], b = t.corner[t.area < 0 ? 2 : 1], c = t.corner[t.area < 0 ? 1 : 2];
  const Span columns = find_span(a.x, b.x, c.x, 0, band.width),
             rows = find_span(a.y, b.y, c.y, band.begin, band.end);
  if (columns.first > columns.last || rows.first > rows.last) return;
  const Vec2 slope = slope_of(t), origin{static_cast<float>(columns.first) + 0.5f,
                                         static_cast<float>(rows.first) + 0.5f};
  const Edge edges[3] = {make_edge(a, b, origin), make_edge(b, c, origin), make_edge(c, a, origin)};
  const float start = a.z + slope.x * (origin.x - a.x) + slope.y * (origin.y - a.y);
  const float nearest = std::min({a.z, b.z, c.z}), farthest = std::max({a.z, b.z, c.z});
  const int width = columns.last - columns.first, height = rows.last - rows.first;
  std::size_t row = band.start_of(rows.first) + static_cast<std::size_t>(columns.first);
  for (int j = 0; j <= height; ++j, row += static_cast<std::size_t>(band.width)) {
    const auto y = static_cast<float>(j);
    const float depth = start + slope.y * y;
    float low = 0, high = static_cast<float>(width);
    for (const Edge& edge : edges) clip(edge, y, low, high);
    if (low > high) continue;
    const int last = static_cast<int>(high);
    for (int i = static_cast<int>(std::ceil(low)); i <= last; ++i)
      body(row + static_cast<std::size_t>(i),
           std::clamp(depth + slope.x * static_cast<float>(i), nearest, farthest));
  }
}

// Sets all of a map but its texels.
void set_frame(const TriangleMesh& mesh, Vec3 direction, int resolution, DepthLayers& layers) {
  const Frame frame = make_frame(direction);
  Bounds3 box;
  for (const Vec3& position : mesh.positions) extend(box, to_local(frame, position));
  const Vec3 size = extent(box);
  // One texel more on each side, so that paths along the outline stay in the map.
  layers.texel_mm = std::max({size.x, size.y, 1e-20f}) / static_cast<float>(resolution - 2);
  const float scale = 1 / layers.texel_mm;
  layers.width = std::min(resolution, static_cast<int>(std::ceil(size.x * scale)) + 2);
  layers.height = std::min(resolution, static_cast<int>(std::ceil(size.y * scale)) + 2);
  layers.axis_x = frame.tangent * scale;
  layers.axis_y = frame.bitangent * scale;
  layers.axis_z = -direction;
  layers.offset = {1 - box.lower.x * scale, 1 - box.lower.y * scale, box.upper.z};
}

// Triangles by the bands that they, or a row beside the band, cover: those of band b are
// triangle[start[b]] to triangle[start[b + 1]].
struct BandLists {
  std::vector<std::uint32_t> start, triangle;
};
BandLists sort_into_bands(const TriangleMesh& mesh, const std::vector<Vec3>& places, int height) {
  const int bands = (height + band_rows - 1) / band_rows;
  BandLists lists;
  lists.start.assign(static_cast<std::size_t>(bands) + 2, 0);
  const auto for_bands = [&](std::size_t i, const auto& body) {
    const auto& corners = mesh.triangles[i];
    const Span rows =
        find_span(places[corners[0]].y, places[corners[1]].y, places[corners[2]].y, 0, height);
    if (rows.first > rows.last) return;
    const int last = std::min(bands - 1, (rows.last + 1) / band_rows);
    for (int b = std::max(0, rows.first - 1) / band_rows; b <= last; ++b)
      body(static_cast<std::size_t>(b));
  };
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i)
    for_bands(i, [&](std::size_t b) { ++lists.start[b + 2]; });
  for (std::size_t b = 2; b < lists.start.size(); ++b) lists.start[b] += lists.start[b - 1];
  lists.triangle.resize(lists.start.back());
  for (std::size_t i = 0; i < count; ++i)
    for_bands(i, [&](std::size_t b) {
      lists.triangle[lists.start[b + 1]++] = static_cast<std::uint32_t>(i);
    });
  return lists;
}

// A view of what the steps share.
struct View {
  const TriangleMesh& mesh;
  const std::vector<Vec3>& places;
  Vec3 direction;
  float eta = 1;
  float steepest = 0;
};

void find_surfaces(const View& view, const std::uint32_t* triangles, std::size_t count,
                   Band& band) {
  const std::size_t size = band.start_of(band.end);
  band.depth.assign(size, infinity);
  band.triangle.assign(size, none);
  band.exit.assign(size, infinity);
  std::vector<Projected> back;
  back.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Projected t = project(view.mesh, view.places, triangles[i]);
    if (t.area == 0) continue;
    const std::uint32_t name = t.area > 0 ? triangles[i] : none;
    if (name == none) back.push_back(t);
    cover(band, t, [&](std::size_t texel, float depth) {
      if (!(depth < band.depth[texel])) return;
      band.depth[texel] = depth;
      band.triangle[texel] = name;
    });
  }
  for (const Projected& t : back)
    cover(band, t, [&](std::size_t texel, float depth) {
      if (depth > band.depth[texel] && depth < band.exit[texel]) band.exit[texel] = depth;
    });
}

struct Texel {
  int column = 0, row = 0;
};
std::size_t index_of(const Band& band, Texel texel) {
  return band.start_of(texel.row) + static_cast<std::size_t>(texel.column);
}

// Whose surface a texel shows: its own, or where its centre lies outside the outline that of a
// neighbour, for some of the object may lie within the texel.
Texel find_shown(const Band& band, Texel texel) {
  if (band.depth[index_of(band, texel)] < infinity) return texel;
  for (const Texel step : {Texel{-1, 0}, Texel{1, 0}, Texel{0, -1}, Texel{0, 1}}) {
    const Texel other{texel.column + step.column, texel.row + step.row};
    if (other.column >= 0 && other.row >= band.begin && other.column < band.width &&
        other.row < band.end && band.triangle[index_of(band, other)] != none)
      return other;
  }
  return texel;
}

// The slope of a triangle, and its corners' weights and normals, ready to be asked at many texels.
struct Facet {
  std::uint32_t triangle = none;
  Vec2 slope;
  Vec3 origin;          // corner 0
  Vec2 u_step, v_step;  // weights of corners 1 and 2 per texel
  Vec3 normal[3];
};
Facet make_facet(const View& view, std::uint32_t triangle) {
  const Projected t = project(view.mesh, view.places, triangle);
  const Vec3 a = t.corner[1] - t.corner[0], b = t.corner[2] - t.corner[0];
  const Vec2 slope = slope_of(t);
  Facet facet{.triangle = triangle,
              .slope = {std::clamp(slope.x, -view.steepest, view.steepest),
                        std::clamp(slope.y, -view.steepest, view.steepest)},
              .origin = t.corner[0],
              .u_step = {b.y / t.area, -b.x / t.area},
              .v_step = {-a.y / t.area, a.x / t.area}};
  for (std::size_t i = 0; i < 3; ++i)
    facet.normal[i] = view.mesh.normals[view.mesh.triangles[triangle][i]];
  return facet;
}

// Interpolated over the triangle at a texel's centre; of any length.
Vec3 normal_at(const Facet& facet, Texel texel) {
  const float x = static_cast<float>(texel.column) + 0.5f - facet.origin.x,
              y = static_cast<float>(texel.row) + 0.5f - facet.origin.y;
  const float u = std::clamp(facet.u_step.x * x + facet.u_step.y * y, 0.0f, 1.0f),
              v = std::clamp(facet.v_step.x * x + facet.v_step.y * y, 0.0f, 1.0f);
  return facet.normal[0] * std::max(0.0f, 1 - u - v) + facet.normal[1] * u + facet.normal[2] * v;
}

// The entries of a row: first the depths and the normals, then all refractions together.
void shade_row(const View& view, const Band& band, int row, EntryRow& entries, DepthTexel* texels) {
  Facet facet;
  entries.count = 0;
  for (int column = 0; column < band.width; ++column) {
    const Texel texel{column, row}, shown = find_shown(band, texel);
    const std::size_t i = index_of(band, shown);
    DepthTexel& entry = texels[column];
    if (band.triangle[i] == none) {
      entry = {.exit = -infinity};
      continue;
    }
    if (facet.triangle != band.triangle[i]) facet = make_facet(view, band.triangle[i]);
    append(entries, normal_at(facet, shown), column);
    entry.slope_x = facet.slope.x;
    entry.slope_y = facet.slope.y;
    entry.entry = band.depth[i] + entry.slope_x * static_cast<float>(texel.column - shown.column) +
                  entry.slope_y * static_cast<float>(texel.row - shown.row);
    entry.exit = band.exit[i];
  }
  refract_entries(entries, view.direction, view.eta, texels);
}

}  // namespace

Refraction refract_entry(Vec3 normal, Vec3 to_light, float eta) {
  const float cosine = std::min(dot(normal, to_light), 1.0f);
  if (!(cosine > 0)) return {};
  const float inside = std::sqrt(std::max(0.0f, 1 - (1 - cosine * cosine) / (eta * eta)));
  if (!(inside > 0)) return {};
  return {fresnel_transmission(eta, cosine), cosine / inside,
          to_light / eta + normal * (inside - cosine / eta)};
}

DepthLayers make_depth_layers(const TriangleMesh& mesh, Vec3 direction, int resolution, float eta,
                              DepthLayers reused) {
  PARIAN_CHECK_LE(8, resolution);
  DepthLayers layers = std::move(reused);
  set_frame(mesh, direction, resolution, layers);
  std::vector<Vec3> places;
  places.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions)
    places.push_back(Vec3{dot(layers.axis_x, p), dot(layers.axis_y, p), dot(layers.axis_z, p)} +
                     layers.offset);
  const View view{mesh, places, direction, eta, max_slope * layers.texel_mm};
  const BandLists lists = sort_into_bands(mesh, places, layers.height);
  const auto width = static_cast<std::size_t>(layers.width);
  layers.texels.resize(width * static_cast<std::size_t>(layers.height));
  Band band{.width = layers.width};
  EntryRow entries = make_entry_row(width);
  for (int first = 0, b = 0; first < layers.height; first += band_rows, ++b) {
    const int last = std::min(first + band_rows, layers.height);
    // With a row on each side, whose surfaces outlines may continue.
    band.begin = std::max(0, first - 1);
    band.end = std::min(last + 1, layers.height);
    const std::uint32_t* start = lists.start.data() + b;
    find_surfaces(view, lists.triangle.data() + start[0], start[1] - start[0], band);
    for (int row = first; row < last; ++row)
      shade_row(view, band, row, entries,
                layers.texels.data() + static_cast<std::size_t>(row) * width);
  }
  return layers;
}

}  // namespace parian

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/primary_internal.h"

namespace parian {
namespace {

constexpr float footprints = 4;       // how far apart hits may lie that share a target
constexpr float least_cosine = 0.8f;  // between their normals

struct SeenPoint {
  Vec3 position;
  Vec3 normal;
};

// Hits around a first one.
struct Group {
  SeenPoint first;
  Vec3 sum;
  std::vector<std::size_t> members;
};

struct Row {
  std::vector<std::size_t> counts;  // hits of each pixel
  std::vector<PrimaryHit> hits;     // targets count within the row
  std::vector<MeshPlace> targets;
};

Group& find_group(std::vector<Group>& groups, const SeenPoint& point, float footprint) {
  std::size_t nearest = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const SeenPoint& first = groups[g].first;
    const float apart = distance(first.position, point.position);
    if (apart < footprints * footprint && dot(first.normal, point.normal) > least_cosine)
      return groups[g];
    if (apart < distance(groups[nearest].first.position, point.position)) nearest = g;
  }
  if (groups.size() == max_targets_per_pixel) return groups[nearest];
  return groups.emplace_back(Group{point, {}, {}});
}

// Sets the hits' targets.
void choose_targets(const std::vector<SeenPoint>& points, const std::vector<float>& footprint,
                    PrimaryHit* hits, Row& row) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Group& group = find_group(groups, points[i], footprint[i]);
    group.sum += points[i].position;
    group.members.push_back(i);
  }
  for (const Group& group : groups) {
    const Vec3 mean = group.sum / static_cast<float>(group.members.size());
    const auto nearest =
        *std::min_element(group.members.begin(), group.members.end(), [&](auto a, auto b) {
          return distance(points[a].position, mean) < distance(points[b].position, mean);
        });
    for (const std::size_t i : group.members)
      hits[i].target = static_cast<std::uint32_t>(row.targets.size());
    row.targets.push_back({hits[nearest].triangle, hits[nearest].barycentric});
  }
}

void trace_pixel(const TriangleMesh& mesh, const RayTracer& tracer, const PrimaryView& view, int x,
                 int y, Row& row) {
  const std::size_t first = row.hits.size();
  std::vector<SeenPoint> points;
  std::vector<float> footprint;
  const auto pixel = static_cast<float>(2 * view.frame.half_height / view.frame.height);
  for (int s = 0; s < view.antialias * view.antialias; ++s) {
    const CameraRay ray = make_sub_ray(view.frame, view.antialias, x, y, s);
    const auto hit = tracer.intersect({ray.origin, ray.direction});
    if (!hit) continue;
    row.hits.push_back(
        {hit->triangle, hit->barycentric, 0, static_cast<std::uint16_t>(s), hit->from_inside});
    const SurfacePoint point = get_surface_point(mesh, hit->triangle, hit->barycentric);
    points.push_back({point.position, point.normal});
    footprint.push_back(hit->t * pixel);
  }
  row.counts.push_back(row.hits.size() - first);
  choose_targets(points, footprint, row.hits.data() + first, row);
}

// Rows behind each other, in order.
void append(PrimaryView& view, const Row& row) {
  const auto first_target = static_cast<std::uint32_t>(view.targets.size());
  for (const std::size_t count : row.counts) view.begin.push_back(view.begin.back() + count);
  for (PrimaryHit hit : row.hits) {
    hit.target += first_target;
    view.from_inside += hit.from_inside;
    view.hits.push_back(hit);
  }
  view.targets.insert(view.targets.end(), row.targets.begin(), row.targets.end());
}

}  // namespace

CameraRay make_sub_ray(const CameraFrame& frame, int antialias, int x, int y, int sub_ray) {
  const int i = sub_ray % antialias, j = sub_ray / antialias;
  const double n = antialias;
  // Canonical arrangement (Kensler 2013): one in each cell, each row and each column of n^2.
  return make_camera_ray(frame, x + (i + (j + 0.5) / n) / n, y + (j + (i + 0.5) / n) / n);
}

PrimaryView trace_primary(const TriangleMesh& mesh, const RayTracer& tracer, const Camera& camera,
                          int antialias, const Progress& progress) {
  PrimaryView view;
  view.frame = make_camera_frame(camera);
  view.antialias = antialias;
  view.begin.reserve(
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height) + 1);
  view.begin.push_back(0);
  constexpr int batch = 32;  // rows between two looks at the progress
  std::vector<Row> rows(batch);
  for (int first = 0; first < camera.height; first += batch) {
    advance_progress(progress, "looking", static_cast<double>(first) / camera.height);
    const int count = std::min(batch, camera.height - first);
    parallel_for(static_cast<std::size_t>(count), [&](std::size_t i) {
      rows[i] = {};
      for (int x = 0; x < camera.width; ++x)
        trace_pixel(mesh, tracer, view, x, first + static_cast<int>(i), rows[i]);
    });
    for (int i = 0; i < count; ++i) append(view, rows[static_cast<std::size_t>(i)]);
  }
  return view;
}

}  // namespace parian

#include "gl/layered_textures.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "base/parallel.h"
#include "scene/mapping.h"
#include "transport/layered_field.h"

namespace parian {
namespace {

constexpr std::size_t sample_columns = 2048;  // the largest texture that every device has

// What the pixels of a picture see.
struct SeenPoints {
  int width = 0, height = 0;
  std::vector<SurfacePoint> points;
  std::vector<int> index;  // [y][x] into the points; -1: nothing
};

std::optional<SurfacePoint> find_point(const TriangleMesh& mesh, const RayTracer& tracer,
                                       const CameraFrame& frame, int antialias, int x, int y) {
  const int n = antialias * antialias;
  for (int i = 0; i < n; ++i) {  // from the middle one on
    const int s = (i + n / 2) % n, row = s / antialias;
    const CameraRay ray =
        make_camera_ray(frame, x * antialias + s % antialias + 0.5, y * antialias + row + 0.5);
    if (const auto hit = tracer.intersect({.origin = ray.origin, .direction = ray.direction}))
      return get_surface_point(mesh, hit->triangle, hit->barycentric);
  }
  return std::nullopt;
}

SeenPoints trace_pixels(const TriangleMesh& mesh, const RayTracer& tracer, const CameraFrame& frame,
                        int antialias, const Progress& progress) {
  SeenPoints seen;
  seen.width = frame.width / antialias;
  seen.height = frame.height / antialias;
  const auto width = static_cast<std::size_t>(seen.width);
  const auto height = static_cast<std::size_t>(seen.height);
  seen.index.assign(width * height, -1);
  std::vector<std::vector<SurfacePoint>> rows(height);
  advance_progress(progress, "layers", 0);
  parallel_for(height, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x)
      if (const auto point = find_point(mesh, tracer, frame, antialias, static_cast<int>(x),
                                        static_cast<int>(y))) {
        seen.index[y * width + x] = static_cast<int>(rows[y].size());
        rows[y].push_back(*point);
      }
  });
  for (std::size_t y = 0; y < height; ++y) {
    const auto before = static_cast<int>(seen.points.size());
    for (std::size_t x = 0; x < width; ++x)
      if (int& at = seen.index[y * width + x]; at >= 0) at += before;
    seen.points.insert(seen.points.end(), rows[y].begin(), rows[y].end());
  }
  return seen;
}

// Pixels at an edge that rays just miss, and which are drawn all the same.
void widen(SeenPoints& seen) {
  const std::vector<int> from = seen.index;
  for (int y = 0; y < seen.height; ++y)
    for (int x = 0; x < seen.width; ++x) {
      int& at = seen.index[static_cast<std::size_t>(y * seen.width + x)];
      for (int i = 0; i < 9 && at < 0; ++i) {
        const int nx = x + i % 3 - 1, ny = y + i / 3 - 1;
        if (nx >= 0 && ny >= 0 && nx < seen.width && ny < seen.height)
          at = from[static_cast<std::size_t>(ny * seen.width + nx)];
      }
    }
}

// The field's profile of point i, wherever it lies in it.
using EvalPoint = std::function<void(std::size_t i, float* half_log, float* support_mm)>;

EvalPoint make_eval(const Scene& scene, const std::vector<SurfacePoint>& points,
                    ProfileField& field) {
  const auto get = [&](std::size_t i) { return points[i]; };
  if (auto layered = make_layered_field(scene, points.size(), get)) {
    field = std::move(*layered);
    return [eval = field.eval](std::size_t i, float* half_log, float* support_mm) {
      const Vec2 place = layered_place(i);
      eval(static_cast<double>(place.x), static_cast<double>(place.y), half_log, support_mm);
    };
  }
  field = make_profile_field(std::get<Material>(scene.material));
  const SampleGrid grid{field.width, field.height, field.pixel_pitch_mm};
  std::vector<SamplePoint> places(points.size());
  parallel_for_blocks(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      places[i] = map_to_sample(scene.mapping, grid, points[i]);
  });
  return [eval = field.eval, places = std::move(places)](std::size_t i, float* half_log,
                                                         float* support_mm) {
    eval(places[i].x, places[i].y, half_log, support_mm);
  };
}

}  // namespace

Vec2 sample_place(std::size_t index) {
  const std::size_t row = index / sample_columns;
  return {static_cast<float>(index % sample_columns), static_cast<float>(row)};
}

std::optional<ProfileField> make_sample_field(const Scene& scene,
                                              const std::vector<SurfacePoint>& samples) {
  const std::size_t count = samples.size();
  auto field = make_layered_field(scene, count, [&](std::size_t i) { return samples[i]; });
  if (!field) return field;
  field->width = static_cast<int>(std::min(count, sample_columns));
  field->height = static_cast<int>((count + sample_columns - 1) / sample_columns);
  field->eval = [eval = field->eval, count](double x, double y, float* half_log,
                                            float* support_mm) {
    const std::size_t i =
        static_cast<std::size_t>(y) * sample_columns + static_cast<std::size_t>(x);
    const Vec2 place = layered_place(std::min(i, count - 1));
    eval(static_cast<double>(place.x), static_cast<double>(place.y), half_log, support_mm);
  };
  return field;
}

ProfileField make_pixel_field(const Scene& scene, const RayTracer& tracer,
                              const SplatCamera& camera, int antialias, const Progress& progress) {
  SeenPoints seen = trace_pixels(scene.mesh, tracer, camera.frame, antialias, progress);
  widen(seen);
  ProfileField field;
  const EvalPoint eval = make_eval(scene, seen.points, field);
  const std::size_t row = field.row();
  field.width = seen.width;
  field.height = seen.height;
  field.eval = [eval, index = std::move(seen.index), row, width = seen.width](
                   double x, double y, float* half_log, float* support_mm) {
    const int i = index[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x)];
    if (i >= 0) return eval(static_cast<std::size_t>(i), half_log, support_mm);
    std::fill_n(half_log, row, 0.0f);
    std::fill_n(support_mm, 3, 0.0f);
  };
  return field;
}

}  // namespace parian

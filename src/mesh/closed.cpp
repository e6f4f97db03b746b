#include "mesh/closed.h"

#include <fmt/format.h>

#include <atomic>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr double most_escapes = 0.01;

// Whether a ray inwards leaves without meeting the inside of a face. Faces met from outside belong
// to other parts of the object that overlap: the ray goes on.
bool does_escape(const SurfacePoint& point, const RayTracer& tracer) {
  Ray ray{point.position - point.geometric_normal * tracer.epsilon_mm(), -point.geometric_normal};
  for (int crossings = 0; crossings < 64; ++crossings) {
    const auto hit = tracer.intersect(ray);
    if (!hit) return true;
    if (hit->from_inside) return false;
    ray.t_min = hit->t + tracer.epsilon_mm();
  }
  return false;
}

std::uint64_t hash_place(Vec3 p) {
  const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v + 0.0f)}; };
  return hash_u64(hash_u64(bits(p.x) << 32u | bits(p.y)), bits(p.z));
}

}  // namespace

bool is_watertight(const TriangleMesh& mesh) {
  std::vector<std::uint64_t> places(mesh.positions.size());
  parallel_for_blocks(places.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places[i] = hash_place(mesh.positions[i]);
  });
  // A random number for each edge from one end to the other, less that of the way back.
  std::atomic<std::uint64_t> boundary = 0;
  parallel_for_blocks(mesh.triangles.size(), 16384, [&](std::size_t begin, std::size_t end) {
    std::uint64_t sum = 0;
    for (std::size_t t = begin; t < end; ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint64_t from = places[mesh.triangles[t][i]];
        const std::uint64_t to = places[mesh.triangles[t][(i + 1) % 3]];
        sum += hash_u64(from, to) - hash_u64(to, from);
      }
    boundary += sum;
  });
  return boundary == 0 && enclosed_volume(mesh) > 0;
}

double measure_escapes(const SurfaceSamples& samples, const RayTracer& tracer) {
  const std::size_t count = samples.points.size();
  if (count == 0) return 0;
  const double escaped = parallel_sum(count, 1024, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += does_escape(samples.points[i], tracer);
    return sum;
  });
  return escaped / static_cast<double>(count);
}

double check_closed(const SurfaceSamples& samples, const RayTracer& tracer,
                    const std::string& mesh_name, std::vector<std::string>& warnings) {
  const double fraction = measure_escapes(samples, tracer);
  if (!(fraction > 0)) return fraction;
  const auto escaped = std::llround(fraction * static_cast<double>(samples.points.size()));
  const std::string found = fmt::format("{} of {} rays into the mesh escape ({:.3g} %)", escaped,
                                        samples.points.size(), 100 * fraction);
  if (fraction > most_escapes)
    throw Error({mesh_name, "faces", "a closed surface", found + ": it has holes"});
  warnings.push_back(found + ": it has holes");
  return fraction;
}

}  // namespace parian

#include "mesh/ray_tracer.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <new>

#include "base/error.h"
#include "base/parallel.h"

namespace parian {
namespace {

[[noreturn]] void throw_embree_error(RTCError code, std::size_t triangles) {
  const bool memory = code == RTC_ERROR_OUT_OF_MEMORY;
  throw Error(
      {.place = "ray tracing",
       .expected = memory ? fmt::format("memory for the tree of {} triangles", triangles)
                          : "to build a tree of triangles",
       .found = memory ? "too little" : fmt::format("Embree error {}", static_cast<int>(code))},
      ErrorKind::resource);
}

RTCRay make_ray(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = ray.t_min;
  r.tfar = ray.t_max;
  r.mask = ~0u;
  return r;
}

}  // namespace

struct RayTracer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  float epsilon = 0;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  void check(std::size_t triangles) const {
    const RTCError code = rtcGetDeviceError(device);
    if (code != RTC_ERROR_NONE) throw_embree_error(code, triangles);
  }
  void add(const TriangleMesh& mesh) const;
};

void RayTracer::Impl::add(const TriangleMesh& mesh) const {
  const std::size_t count = mesh.triangles.size();
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3), mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), count);
  if (vertices != nullptr && indices != nullptr && count > 0) {
    std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3));
    std::memcpy(indices, mesh.triangles.data(), count * 3 * sizeof(std::uint32_t));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
  }
  rtcReleaseGeometry(geometry);
  check(count);
}

RayTracer::RayTracer(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice(nullptr);
  if (impl_->device == nullptr)
    throw_embree_error(rtcGetDeviceError(nullptr), mesh.triangles.size());
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_MEDIUM);
  impl_->add(mesh);
  {
    // One thread: where a ray meets an edge, the tree's order decides which triangle it hits.
    const ThreadLimit limit(1);
    rtcCommitScene(impl_->scene);
  }
  impl_->check(mesh.triangles.size());
  const Bounds3 box = bounds(mesh);
  float largest = 0;
  for (const Vec3 corner : {box.lower, box.upper})
    for (const float value : {corner.x, corner.y, corner.z})
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  impl_->epsilon = std::max(mesh.positions.empty() ? 0 : 1e-5f * diagonal(box), 2e-6f * largest);
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

std::optional<Hit> RayTracer::intersect(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = make_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Vec3 normal{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
  return Hit{
      query.ray.tfar, query.hit.primID, {query.hit.u, query.hit.v}, dot(normal, ray.direction) > 0};
}

bool RayTracer::is_occluded(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay query = make_ray(ray);
  rtcOccluded1(impl_->scene, &context, &query);
  return query.tfar < 0;  // Embree sets it to -inf on a hit
}

float RayTracer::epsilon_mm() const {
  return impl_->epsilon;
}

}  // namespace parian

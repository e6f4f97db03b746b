// An environment's reflection where the object hides the environment from itself: against rays, and
// against what must hold exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "mesh/ray_tracer.h"
#include "mesh/test_meshes.h"
#include "render/specular_internal.h"
#include "tests/splat/compare_pictures.h"
#include "tests/splat/scenes.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

using namespace splat_scenes;

// As the CPU renderer has it (render/shade.cpp).
Reflector make_reflector(const SurfacePoint& point, Vec3 view, double roughness) {
  Reflector seen{point.position, point.normal, point.geometric_normal, view,
                 specular_alpha(roughness)};
  const float wanted = std::clamp(dot(seen.geometric_normal, view), 1e-4f, 0.1f);
  const float cosine = dot(seen.normal, view);
  if (cosine < wanted)
    seen.normal = normalize(view * wanted + normalize(seen.normal - view * cosine) *
                                                std::sqrt(1 - wanted * wanted));
  return seen;
}

// What one ray a pixel sees by reflection.
Image trace_reflection(const Scene& scene, const RayTracer& tracer) {
  const SpecularShader shader(scene.lights, tracer, eta_of(scene.material));
  const CameraFrame frame = make_camera_frame(scene.camera);
  Image image = make_image(scene.camera.width, scene.camera.height, 3);
  parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < image.width; ++x) {
      const CameraRay ray = make_camera_ray(frame, x + 0.5, y + 0.5);
      const auto hit = tracer.intersect({.origin = ray.origin, .direction = ray.direction});
      if (!hit) continue;
      const SurfacePoint point = get_surface_point(scene.mesh, hit->triangle, hit->barycentric);
      constexpr std::uint32_t count = 64;
      const PixelSequence sequence{hash_u64(row, static_cast<std::uint64_t>(x)), count};
      const Rgb radiance =
          eval_specular(shader, make_reflector(point, -ray.direction, scene.specular.roughness),
                        sequence, 0, count);
      for (int c = 0; c < 3; ++c) at(image, x, y, c) = component(radiance, c);
    }
  });
  return image;
}

Image combine(Image a, const Image& b, float factor) {
  for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] += factor * b.values[i];
  return a;
}

SplatParams make_reflection_params() {
  SplatParams params = make_params();
  params.reflection_rays = 64;  // as many as a pixel of the defaults has in all
  return params;
}

void expect_like_rays(Scene scene, double roughness, const std::string& name) {
  scene.specular.enabled = true;
  scene.specular.roughness = roughness;
  const OffscreenContext context;
  SplatRenderer renderer(context.limits(), scene, make_reflection_params());
  renderer.draw();
  const Image image = renderer.read();
  const Image reference = combine(render_reference(scene, samples, rays),
                                  trace_reflection(scene, RayTracer(scene.mesh)), 1);
  expect_close(reference, image, renderer.coverage(), "parian-reflection-" + name);
}

TEST(Reflection, OfASkyIsHiddenByAKnot) {
  expect_like_rays(make_scene(make_knot(2), Material(make_chequered_map()), {make_sky()}), 0.3,
                   "knot");
}

TEST(Reflection, OfASkyIsHiddenByAFoldedSheet) {
  expect_like_rays(make_scene(make_fin(2), Material(make_marble()), {make_sky()}), 0.1, "fin");
}

Light make_white_sky() {
  EnvironmentLight light;
  light.image = make_image(8, 4, 3);
  std::fill(light.image.values.begin(), light.image.values.end(), 1.0f);
  return light;
}

// A picture's part that is reflected.
Image draw_reflection(Scene scene) {
  const OffscreenContext context;
  SplatParams params = make_reflection_params();
  params.samples = 1000;
  Image images[2];
  for (const bool is_enabled : {false, true}) {
    scene.specular.enabled = is_enabled;
    SplatRenderer renderer(context.limits(), scene, params);
    renderer.draw();
    images[is_enabled ? 1 : 0] = renderer.read();
  }
  return combine(images[1], images[0], -1);
}

// The part of white surroundings that is reflected where nothing is in the way.
float reflect_white(const Reflector& seen, float eta, std::uint64_t key) {
  constexpr std::uint32_t count = 128;
  float sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 light =
        sample_ggx(seen.alpha, seen.normal, seen.view, sample_2d({key, count}, i, 0));
    const float f = eval_ggx(seen.alpha, eta, seen.normal, seen.view, light);
    if (f > 0 && dot(seen.geometric_normal, light) > 0)
      sum += f / pdf_ggx(seen.alpha, seen.normal, seen.view, light);
  }
  return sum / static_cast<float>(count);
}

// Nothing is hidden by a convex object. One ray of a pixel's 64 that is lost would show.
TEST(Reflection, OfAWhiteSkyIsWholeOnConvexObjects) {
  for (const bool is_round : {true, false}) {
    Scene scene = make_scene(is_round ? make_sphere(5) : make_box({3, 2, 1}),
                             Material(make_marble()), {make_white_sky()});
    scene.specular.roughness = 0.05;
    const Image image = draw_reflection(scene);
    const RayTracer tracer(scene.mesh);
    const CameraFrame frame = make_camera_frame(scene.camera);
    const auto eta = static_cast<float>(eta_of(scene.material));
    std::size_t seen = 0, lost = 0;
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const CameraRay ray = make_camera_ray(frame, x + 0.5, y + 0.5);
        const auto hit = tracer.intersect({.origin = ray.origin, .direction = ray.direction});
        if (!hit || at(image, x, y, 0) == 0) continue;
        const SurfacePoint point = get_surface_point(scene.mesh, hit->triangle, hit->barycentric);
        if (dot(point.geometric_normal, -ray.direction) < 0.2f) continue;  // steep Fresnel terms
        const float whole = reflect_white(make_reflector(point, -ray.direction, 0.05), eta, seen);
        const double ratio = static_cast<double>(at(image, x, y, 0) / whole);
        sum += ratio;
        lost += ratio < 0.99 ? 1 : 0;
        ++seen;
      }
    EXPECT_GT(seen, 2000u);
    EXPECT_NEAR(sum / static_cast<double>(seen), 1, 5e-4);
    EXPECT_LE(lost, seen / 500);  // rays in the far ends of the lobe
  }
}

// A floor before a wall of height H, seen at 45 degrees: a mirror there shows the wall up to H away
// from it, and the sky beyond. Maps stand for directions up to 11 degrees around theirs.
TEST(Reflection, OfAWallOnTheFloorEndsWhereItsTopIs) {
  TriangleMesh mesh = make_box({40, 2, 40}, 8);
  append_mesh(mesh, make_box({40, 12, 2}, 8), {0, 5, -19});
  Scene scene = make_scene(mesh, Material(make_marble()), {make_white_sky()});
  scene.specular.roughness = 0.05;
  const Bounds3 box = bounds(scene.mesh);
  const float size = (box.upper.x - box.lower.x) / 40;
  const float floor_y = box.lower.y + 2 * size, wall_z = box.lower.z + 2 * size, height = 10 * size;
  scene.camera.target = {0, floor_y, 0};
  scene.camera.position = scene.camera.target + Vec3{0, 1000, 1000} * size;
  scene.camera.fov_deg = 2;
  const Image image = draw_reflection(scene);
  const RayTracer tracer(scene.mesh);
  const CameraFrame frame = make_camera_frame(scene.camera);
  const double eta = eta_of(scene.material);
  const float whole = 1 - fresnel_transmission(static_cast<float>(eta), std::sqrt(0.5f));
  int hidden = 0, open = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const CameraRay ray = make_camera_ray(frame, x + 0.5, y + 0.5);
      const auto hit = tracer.intersect({.origin = ray.origin, .direction = ray.direction});
      if (!hit) continue;
      const Vec3 point = ray.origin + ray.direction * hit->t;
      if (std::abs(point.y - floor_y) > 1e-3f * size || std::abs(point.x) > 5 * size) continue;
      const float away = (point.z - wall_z) / height;
      if (away > 0.1f && away < 0.6f) {
        EXPECT_LE(at(image, x, y, 0), 0.02f * whole) << away;
        ++hidden;
      } else if (away > 1.6f) {
        EXPECT_NEAR(at(image, x, y, 0), whole, 0.02f * whole) << away;
        ++open;
      }
    }
  EXPECT_GT(hidden, 100);
  EXPECT_GT(open, 100);
}

// What is hidden stays hidden when the sky turns. Reflections are kept from picture to picture, but
// not beyond lights, view or index.
TEST(Reflection, FollowsLightsCameraAndMaterial) {
  Scene scene = make_scene(make_knot(1), Material(make_marble()), {make_sky()});
  scene.specular.enabled = true;
  const OffscreenContext context;
  SplatParams params = make_params();
  params.samples = 1000;
  SplatRenderer renderer(context.limits(), scene, params);
  renderer.draw();
  Image before = renderer.read();
  const auto expect_like_fresh = [&] {
    renderer.draw();
    const Image image = renderer.read();
    SplatRenderer fresh(context.limits(), scene, params);
    fresh.draw();
    EXPECT_EQ(image.values, fresh.read().values);
    EXPECT_NE(image.values, before.values);
    before = image;
  };
  std::get<EnvironmentLight>(scene.lights[0]).rotation_deg = 130;
  renderer.set_lights(scene.lights);
  expect_like_fresh();
  scene.camera.position = scene.camera.target + Vec3{30, 90, 60};
  renderer.set_camera(scene.camera);
  expect_like_fresh();
  scene.exposure = 1.5;
  renderer.set_exposure(scene.exposure);
  expect_like_fresh();
  for (const double eta : {1.5, 1.3}) {
    Dipole marble = make_marble();
    marble.eta = eta;
    marble.channels[0].sigma_a *= 3;
    scene.material = Material(marble);
    renderer.set_material(marble);
    expect_like_fresh();
  }
}

}  // namespace
}  // namespace parian

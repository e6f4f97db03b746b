// Homogeneous materials from precomputed transport on the graphics device, against the same on the
// CPU.
#include "gl/live_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gl/splat_renderer.h"
#include "mesh/shapes.h"
#include "render/transport_renderer.h"
#include "scene/camera.h"
#include "scene/environment.h"
#include "tests/splat/compare_pictures.h"
#include "transport/precompute.h"

namespace parian {
namespace {

Dipole make_material(double scale = 1, bool has_single = true) {
  Dipole material;
  material.channels = {{0.01, 1.0 * scale, 0.2}, {0.02, 2.0 * scale, -0.2}, {0.1, 0.5, 0}};
  material.eta = 1.4;
  material.single_scattering = has_single;
  return material;
}

Scene make_scene(bool has_single = true) {
  Scene scene;
  scene.mesh = make_knot(2);
  clean_mesh(scene.mesh, "test mesh");
  fit_to_size(scene.mesh, 30);
  scene.mesh_name = "test mesh";
  scene.material = Material(make_material(1, has_single));
  EnvironmentLight sky;
  sky.image = make_sky_image(32, 16);
  scene.lights = {sky, DirectionalLight{normalize(Vec3{1, 2, 1}), {1, 0.8f, 0.6f}}};
  scene.specular.enabled = false;
  scene.camera.width = 160;
  scene.camera.height = 120;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

HomogeneousTransport make_transport(const Scene& scene) {
  PrecomputeParams params;
  params.samples = 4000;
  params.rays = 32;
  params.single_params.directions = 16;
  params.single_params.path_samples = 16;
  params.single_params.resolution = 256;
  return precompute_transport(scene, params);
}

LiveParams quick_params(LiveUpdate update = LiveUpdate::device) {
  LiveParams params;
  params.antialias = 1;
  params.update = update;
  return params;
}

// The largest difference over the largest radiance.
double compare_vertices(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0, most = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    worst = std::max(worst, static_cast<double>(length(a[i] - b[i])));
    most = std::max(most, static_cast<double>(length(b[i])));
  }
  EXPECT_GT(most, 0);
  return worst / most;
}

std::vector<Rgb> eval_on_cpu(const Scene& scene, const HomogeneousTransport& transport,
                             const Dipole& material, const std::vector<Rgb>& scale) {
  const TransportView view =
      make_transport_view(scene.mesh.positions, scene.mesh.normals, scene.camera.position,
                          transport.eta, /*has_fresnel=*/false);
  std::vector<Rgb> radiance;
  eval_transport(transport, TransportProjection(transport).fit(material), scale, view, radiance);
  return radiance;
}

// Both read the same halves and sum them in 32 bits. Coefficients of both signs cancel, so that
// rounding is a share of their sum and not of the radiance.
constexpr double rounding = 2e-4;

TEST(Live, VerticesAreThoseOfTheCpu) {
  for (const bool has_single : {false, true}) {
    Scene scene = make_scene(has_single);
    const HomogeneousTransport transport = make_transport(scene);
    const OffscreenContext context;
    LiveRenderer renderer(context.limits(), scene, transport, quick_params());
    const std::vector<Rgb> scale{{0.5f, 1, 2}, {3, 1, 0}};
    renderer.set_light_scale(scale);
    for (const double factor : {1.0, 0.3, 4.0}) {
      const Dipole material = make_material(factor, has_single);
      renderer.set_material(material);
      renderer.draw();
      EXPECT_LE(compare_vertices(renderer.read_vertices(),
                                 eval_on_cpu(scene, transport, material, scale)),
                rounding)
          << factor;
    }
    scene.camera.position = scene.camera.target + Vec3{0, 60, 30};
    renderer.set_camera(scene.camera);
    renderer.draw();
    EXPECT_LE(compare_vertices(renderer.read_vertices(),
                               eval_on_cpu(scene, transport, make_material(4, has_single), scale)),
              rounding);
  }
}

TEST(Live, UpdatesOnTheCpuAreThoseOnTheDevice) {
  Scene scene = make_scene();
  const HomogeneousTransport transport = make_transport(scene);
  const OffscreenContext context;
  LiveRenderer on_device(context.limits(), scene, transport, quick_params());
  LiveRenderer on_cpu(context.limits(), scene, transport, quick_params(LiveUpdate::cpu));
  Camera other = scene.camera;
  other.position = scene.camera.target + Vec3{0, 60, 30};
  for (LiveRenderer* renderer : {&on_device, &on_cpu}) {
    renderer->set_light(0, scene.lights[0], transport.lights[0]);
    renderer->set_light_scale({{0.5f, 1, 2}, {3, 1, 0}});
    renderer->set_material(make_material(0.3));
    renderer->set_camera(other);
    renderer->draw();
  }
  EXPECT_LE(compare_vertices(on_cpu.read_vertices(), on_device.read_vertices()), rounding);
  const Image expected = on_device.read(), image = on_cpu.read();
  const RelativeErrors errors = relative_errors(expected, image, on_cpu.coverage());
  EXPECT_GT(errors.pixels, 1000u);
  EXPECT_LE(errors.p99, 1e-3);
  EXPECT_LT(on_cpu.report().texture_bytes, on_device.report().texture_bytes);
}

// By the device's name: those that are software leave the sums to the CPU.
TEST(Live, SoftwareDevicesUpdateOnTheCpu) {
  const Scene scene = make_scene(/*has_single=*/false);
  const HomogeneousTransport transport = make_transport(scene);
  const OffscreenContext context;
  const auto bytes = [&](const char* name, LiveUpdate update) {
    GlLimits limits = context.limits();
    limits.renderer = name;
    return LiveRenderer(limits, scene, transport, quick_params(update)).report().texture_bytes;
  };
  const std::size_t on_device = bytes("llvmpipe (LLVM 15.0.6, 256 bits)", LiveUpdate::device);
  const std::size_t on_cpu = bytes("NVIDIA H200/PCIe/SSE2", LiveUpdate::cpu);
  EXPECT_LT(on_cpu, on_device);
  EXPECT_EQ(bytes("NVIDIA H200/PCIe/SSE2", LiveUpdate::automatic), on_device);
  for (const char* software :
       {"llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe", "Software Rasterizer swrast"})
    EXPECT_EQ(bytes(software, LiveUpdate::automatic), on_cpu) << software;
}

TEST(Live, PicturesAreThoseOfTheCpu) {
  const Scene scene = make_scene();
  const HomogeneousTransport transport = make_transport(scene);
  RenderParams params;
  params.antialias = 1;
  const TransportRenderer reference(scene, transport, params);
  const OffscreenContext context;
  LiveRenderer renderer(context.limits(), scene, transport, quick_params());
  for (const double factor : {1.0, 0.3}) {
    renderer.set_material(make_material(factor));
    renderer.draw();
    const Image image = renderer.read();
    const Image expected = reference.render(make_material(factor)).image;
    expect_close(expected, image, renderer.coverage(), "parian-live");
  }
}

// What is reflected, with the object in its own way, is that of splatting (reflection_test.cpp).
TEST(Live, ReflectsAsSplattingDoes) {
  Scene scene = make_scene(/*has_single=*/false);
  scene.lights.pop_back();
  const HomogeneousTransport transport = make_transport(scene);
  const OffscreenContext context;
  SplatParams splat;
  splat.samples = 1000;
  splat.antialias = 1;
  Image reflections[2];
  for (const bool is_enabled : {true, false}) {
    scene.specular.enabled = is_enabled;
    LiveRenderer live(context.limits(), scene, transport, quick_params());
    SplatRenderer splatting(context.limits(), scene, splat);
    live.draw();
    splatting.draw();
    const Image images[2] = {live.read(), splatting.read()};
    for (int i = 0; i < 2; ++i) {
      if (is_enabled) reflections[i] = images[i];
      for (std::size_t k = 0; k < images[i].values.size() && !is_enabled; ++k)
        reflections[i].values[k] -= images[i].values[k];
    }
  }
  float most = 0;
  for (std::size_t k = 0; k < reflections[0].values.size(); ++k) {
    EXPECT_NEAR(reflections[0].values[k], reflections[1].values[k], 1e-5f) << k;
    most = std::max(most, reflections[0].values[k]);
  }
  EXPECT_GT(most, 0.1f);
}

class LiveChanges : public testing::TestWithParam<LiveUpdate> {};
INSTANTIATE_TEST_SUITE_P(Live, LiveChanges, testing::Values(LiveUpdate::device, LiveUpdate::cpu));

TEST_P(LiveChanges, LeaveNothingBehind) {
  Scene scene = make_scene();
  scene.specular.enabled = true;
  const HomogeneousTransport transport = make_transport(scene);
  const OffscreenContext context;
  LiveRenderer renderer(context.limits(), scene, transport, quick_params(GetParam()));
  renderer.draw();
  const Image first = renderer.read();
  Camera other = scene.camera;
  other.width = 80;
  other.height = 90;
  other.position = scene.camera.target + Vec3{0, 60, 30};
  renderer.set_camera(other);
  renderer.set_material(make_material(3));
  renderer.set_light_scale({{2, 2, 2}, {0, 0, 0}});
  renderer.draw();
  EXPECT_NE(renderer.read().values, first.values);
  renderer.set_camera(scene.camera);
  renderer.set_material(make_material());
  renderer.set_light_scale({{1, 1, 1}, {1, 1, 1}});
  renderer.set_light(1, scene.lights[1], transport.lights[1]);
  renderer.draw();
  EXPECT_EQ(renderer.read().values, first.values);
}

}  // namespace
}  // namespace parian

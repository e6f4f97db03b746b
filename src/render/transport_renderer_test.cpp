#include "render/transport_renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "render/test_scenes.h"
#include "transport/precompute.h"

namespace parian {
namespace {

using namespace testing_scenes;

Dipole make_material() {
  Dipole material;
  material.channels = {{0.01, 1.0, 0.2}, {0.02, 2.0, -0.2}, {0.1, 0.5, 0}};
  return material;
}

Scene make_lit_scene(TriangleMesh mesh) {
  Scene scene = make_scene(std::move(mesh), 20, Material(make_material()));
  scene.lights = {white_environment(0.5f),
                  DirectionalLight{normalize(Vec3{1, 2, 1}), {1, 0.8f, 0.6f}}};
  return scene;
}

PrecomputeParams quick_precompute() {
  PrecomputeParams params;
  params.samples = 4000;
  params.rays = 32;
  params.single_params.directions = 16;
  params.single_params.path_samples = 16;
  params.single_params.resolution = 256;
  return params;
}

// Mean of |a - b| over the mean of b.
double difference(const Image& a, const Image& b) {
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    sum += std::abs(static_cast<double>(a.values[i]) - static_cast<double>(b.values[i]));
    total += static_cast<double>(b.values[i]);
  }
  return sum / total;
}

TEST(TransportRenderer, ShowsWhatTheRendererShows) {
  Scene scene = make_lit_scene(make_knot());
  const HomogeneousTransport transport = precompute_transport(scene, quick_precompute());
  const TransportRenderer renderer(scene, transport, quick_params());
  RenderParams params = quick_params();
  params.shading = Shading::vertex;
  for (const double scale : {0.3, 2.0}) {
    Dipole material = make_material();
    for (DipoleCoefficients& medium : material.channels) medium.sigma_s_prime *= scale;
    scene.material = Material(material);
    const Image expected = render(scene, params).image;
    EXPECT_LT(difference(renderer.render(material).image, expected), 0.02) << scale;
  }
}

TEST(TransportRenderer, SingleScatteringAddsLight) {
  Scene scene = make_lit_scene(make_sphere(3));
  scene.lights.erase(scene.lights.begin());  // the directional one, which both treat alike
  const HomogeneousTransport transport = precompute_transport(scene, quick_precompute());
  const TransportRenderer renderer(scene, transport, quick_params());
  Dipole material = make_material();
  const Image without = renderer.render(material).image;
  material.single_scattering = true;
  const Image with = renderer.render(material).image;
  scene.material = Material(material);
  RenderParams params = quick_params();
  params.shading = Shading::vertex;
  EXPECT_LT(difference(with, render(scene, params).image), 0.03);
  EXPECT_GT(difference(with, without), 0.05);
}

TEST(TransportRenderer, StoppedAndResumedIsUninterrupted) {
  const Scene scene = make_lit_scene(make_sphere(3));
  const PrecomputeParams params = quick_precompute();
  const HomogeneousTransport whole = precompute_transport(scene, params);
  const RayTracer tracer(scene.mesh);
  HomogeneousTransport part;
  {
    Precompute work(scene, tracer, params);
    work.advance();
    const Progress cancelled{.report = {}, .is_cancelled = [] { return true; }};
    EXPECT_THROW(work.advance(cancelled), Error);
    EXPECT_EQ(work.lights_done(), 1u);
    part = work.transport();
  }
  const ThreadLimit limit(1);
  Precompute work(scene, tracer, params, part);
  while (!work.is_done()) work.advance();
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(work.transport().lights[i].multiple.half, whole.lights[i].multiple.half);
    EXPECT_EQ(work.transport().lights[i].single.half, whole.lights[i].single.half);
  }
}

TEST(TransportRenderer, FingerprintsTellMeshesLightsAndParametersApart) {
  const Scene scene = make_lit_scene(make_sphere(3));
  const PrecomputeParams params = quick_precompute();
  const TransportFingerprint own = fingerprint_of(scene, params);
  EXPECT_EQ(own, fingerprint_of(make_lit_scene(make_sphere(3)), params));
  Scene other = scene;
  other.mesh.positions[3].x += 1e-4f;
  EXPECT_NE(fingerprint_of(other, params).mesh, own.mesh);
  other = scene;
  std::get<EnvironmentLight>(other.lights[0]).rotation_deg = 1;
  EXPECT_NE(fingerprint_of(other, params).lights[0], own.lights[0]);
  EXPECT_EQ(fingerprint_of(other, params).lights[1], own.lights[1]);
  PrecomputeParams more = params;
  more.samples += 1;
  EXPECT_NE(fingerprint_of(scene, more).parameters, own.parameters);
}

// Light that comes through a thin sheet from behind; what is scattered once depends on g.
TEST(TransportRenderer, ForwardScatteringBrightensTheBackLit) {
  Scene scene = make_scene(make_box({20, 20, 2}, 8), 20, Material(make_material()));
  scene.camera.position = {0, 0, 60};
  scene.camera.target = {0, 0, 0};
  const auto brightness = [&](Vec3 light, double g) {
    Scene lit = scene;
    lit.lights = {DirectionalLight{normalize(light), {1, 1, 1}}};
    const HomogeneousTransport transport = precompute_transport(lit, quick_precompute());
    const TransportRenderer renderer(lit, transport, quick_params());
    Dipole material;
    material.single_scattering = true;
    // sigma_s' = sigma_s (1 - g) would change too: what is compared has the same.
    material.channels = {{0.05, 0.3, g}};
    double sum = 0;
    for (const float value : renderer.render(material).image.values)
      sum += static_cast<double>(value);
    return sum;
  };
  EXPECT_GT(brightness({0, 0, -1}, 0.3), brightness({0, 0, -1}, -0.3));
}

}  // namespace
}  // namespace parian

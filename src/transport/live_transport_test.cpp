#include "transport/live_transport.h"

#include <gtest/gtest.h>

#include <chrono>

#include "base/error.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

EnvironmentLight make_sky(float rotation_deg) {
  EnvironmentLight sky;
  sky.image = make_image(16, 8, 3);
  for (std::size_t i = 0; i < sky.image.values.size(); ++i)
    sky.image.values[i] = static_cast<float>(i % 48) / 48;
  sky.rotation_deg = rotation_deg;
  return sky;
}

Scene make_scene() {
  Scene scene;
  scene.mesh = make_shape("sphere");
  scene.mesh_name = "sphere";
  scene.material = Material(Dipole{.channels = {{0.02, 1}}});
  scene.lights = {DirectionalLight{}, make_sky(0)};
  return scene;
}

PrecomputeParams make_params() {
  PrecomputeParams params;
  params.samples = 500;
  params.rays = 16;
  params.single_params.directions = 16;
  params.single_params.resolution = 64;
  return params;
}

// Polls until nothing is left to do; how often something changed.
int wait(LiveTransport& live, HomogeneousTransport& transport) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  int changes = 0;
  while (live.is_busy()) {
    if (live.poll(transport)) ++changes;
    if (std::chrono::steady_clock::now() > end) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return changes;
}

TEST(LiveTransport, TurnsTheEnvironmentInTheBackground) {
  Scene scene = make_scene();
  const RayTracer tracer(scene.mesh);
  const HomogeneousTransport first = precompute_transport(scene, make_params());
  HomogeneousTransport transport = first;
  {
    LiveTransport live(scene, tracer, make_params());
    EXPECT_FALSE(live.is_busy());
    for (const float rotation : {10.0f, 20.0f, 90.0f}) live.request(1, make_sky(rotation));
    EXPECT_TRUE(live.is_busy());
    EXPECT_EQ(wait(live, transport), 1);  // only the last
  }
  EXPECT_EQ(transport.lights[0].multiple.half, first.lights[0].multiple.half);
  EXPECT_NE(transport.lights[1].multiple.half, first.lights[1].multiple.half);
  scene.lights[1] = make_sky(90);
  const HomogeneousTransport turned = precompute_transport(scene, make_params());
  EXPECT_EQ(transport.lights[1].multiple.half, turned.lights[1].multiple.half);
  EXPECT_EQ(transport.lights[1].single.half, turned.lights[1].single.half);
}

TEST(LiveTransport, TakesRequestsForSeveralLights) {
  Scene scene = make_scene();
  const RayTracer tracer(scene.mesh);
  HomogeneousTransport transport = precompute_transport(scene, make_params());
  DirectionalLight low;
  low.direction = {1, 0, 0};
  LiveTransport live(scene, tracer, make_params());
  live.request(0, low);
  live.request(1, make_sky(45));
  wait(live, transport);
  scene.lights = {low, make_sky(45)};
  const HomogeneousTransport expected = precompute_transport(scene, make_params());
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(transport.lights[i].multiple.half, expected.lights[i].multiple.half) << i;
}

TEST(LiveTransport, GivesUpWhenItIsNoLongerNeeded) {
  const Scene scene = make_scene();
  const RayTracer tracer(scene.mesh);
  PrecomputeParams params = make_params();
  params.samples = 100000;
  const auto start = std::chrono::steady_clock::now();
  { LiveTransport(scene, tracer, params).request(1, make_sky(30)); }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

}  // namespace
}  // namespace parian

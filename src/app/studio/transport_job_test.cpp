#include "app/studio/transport_job.h"

#include <gtest/gtest.h>

#include "app/studio/test_studio_internal.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

TransportKey make_key() {
  Scene scene;
  scene.mesh = make_sphere(2);
  fit_to_size(scene.mesh, 10);
  TransportKey key{make_stage(std::move(scene)), {}, 1.3};
  Image sky = make_image(8, 4, 3, 0.5f);
  at(sky, 2, 1, 0) = 3;
  key.lighting = {take_light(EnvironmentLight{.image = std::move(sky)}),
                  {.place = direction_of(45, 40), .power = {1, 0.5f, 0}},
                  {.kind = LightKind::point, .place = {0, 30, 10}, .power = {900, 900, 900}}};
  return key;
}

TEST(TransportJob, BrightnessIsAFactorAndPlacesAreNot) {
  const TransportKey key = make_key();
  const ReadyTransport ready{.key = key, .transport = nullptr};
  TransportKey wanted = key;
  wanted.lighting[1].power *= 2;
  wanted.lighting[0].power.y /= 4;
  const auto scales = find_light_scales(ready, wanted);
  ASSERT_TRUE(scales);
  EXPECT_EQ(*scales, (std::vector<Rgb>{{1, 0.25f, 1}, {2, 2, 1}, {1, 1, 1}}));
  const auto differs = [&](auto change) {
    TransportKey other = key;
    change(other);
    return !find_light_scales(ready, other);
  };
  EXPECT_TRUE(differs([](TransportKey& k) { turn_light(k.lighting[1], 1, 0, {}); }));
  EXPECT_TRUE(differs([](TransportKey& k) { k.lighting[2].place.y += 1; }));
  EXPECT_TRUE(differs([](TransportKey& k) { k.lighting[0].rotation_deg += 1; }));
  EXPECT_TRUE(differs([](TransportKey& k) { k.lighting[1].power.z = 1; }));  // was dark
  EXPECT_TRUE(differs([](TransportKey& k) { k.lighting.pop_back(); }));
  EXPECT_TRUE(differs([](TransportKey& k) { std::swap(k.lighting[0], k.lighting[1]); }));
  EXPECT_TRUE(differs([](TransportKey& k) { k.eta = 1.4; }));
  EXPECT_TRUE(differs([](TransportKey& k) { k.stage = make_key().stage; }));
}

PrecomputeParams make_params() {
  PrecomputeParams params;
  params.samples = 1000;
  params.rays = 4;
  params.single_params.path_samples = 8;
  params.single_params.directions = 16;
  params.single_params.resolution = 64;
  return params;
}

TEST(TransportJob, OneLightAnewIsAsIfAllWere) {
  const TransportKey key = make_key();
  const auto first = make_ready_transport(key, make_params(), nullptr, {});
  TransportKey turned = key;
  turn_light(turned.lighting[1], 30, 0, {});
  turned.lighting[0].power *= 3;  // kept as it was: a factor
  turned.lighting.erase(turned.lighting.begin() + 2);
  std::swap(turned.lighting[0], turned.lighting[1]);
  const auto kept = make_ready_transport(turned, make_params(), first.get(), {});
  const auto anew = make_ready_transport(turned, make_params(), nullptr, {});
  ASSERT_EQ(kept->transport->lights.size(), 2u);
  EXPECT_EQ(kept->transport->lights[0].multiple.half, anew->transport->lights[0].multiple.half);
  EXPECT_EQ(kept->transport->lights[0].single.half, anew->transport->lights[0].single.half);
  EXPECT_EQ(kept->transport->lights[1].multiple.half, first->transport->lights[0].multiple.half);
  const auto scales = find_light_scales(*kept, turned);
  ASSERT_TRUE(scales);
  EXPECT_NEAR((*scales)[1].x, 3, 1e-6);
  EXPECT_EQ((*scales)[0].x, 1.0f);
}

TEST(TransportJob, CancelledByTheUserItStaysOff) {
  const StateFolder folder;
  Studio studio;
  start_studio(studio, {folder.path, "/no/such/folder"});
  make_small(studio);
  ASSERT_TRUE(studio.is_homogeneous);
  studio.last_change_s = -10;
  update_transport(studio);
  ASSERT_TRUE(studio.jobs.is_running("transport"));
  studio.jobs.cancel("transport");
  update_transport(studio);
  EXPECT_FALSE(studio.use_transport);
  // Changes cancel it too, and it begins again when nothing moves.
  studio.use_transport = true;
  update_transport(studio);
  ASSERT_TRUE(studio.jobs.is_running("transport"));
  turn_light(studio.lighting[0], 5, 0, {});
  update_transport(studio);
  EXPECT_FALSE(studio.jobs.is_running("transport"));
  EXPECT_TRUE(studio.use_transport);
  update_transport(studio);
  EXPECT_TRUE(studio.jobs.is_running("transport"));
}

}  // namespace
}  // namespace parian

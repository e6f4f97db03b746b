#include "app/studio/lighting.h"

#include <gtest/gtest.h>

#include <utility>

#include "app/studio/stage.h"
#include "scene/camera.h"

namespace parian {
namespace {

TEST(Lighting, TurningKeepsTheDistance) {
  const Vec3 middle{1, 20, -3};
  StageLight point{.kind = LightKind::point, .place = {40, 50, 60}};
  const LightAngles before = angles_of(point, middle);
  turn_light(point, 70, -200, middle);
  const LightAngles after = angles_of(point, middle);
  EXPECT_NEAR(after.azimuth_deg, before.azimuth_deg + 70, 1e-3);
  EXPECT_NEAR(after.elevation_deg, -89, 1e-3);
  EXPECT_NEAR(after.distance_mm, before.distance_mm, 1e-3);
  EXPECT_NEAR(length(point.place - middle), before.distance_mm, 1e-3);

  StageLight lamp{.place = normalize(Vec3{1, 2, 3})};
  for (int i = 0; i < 1000; ++i) turn_light(lamp, 0.36, 0, middle);  // all around
  EXPECT_NEAR(length(lamp.place - normalize(Vec3{1, 2, 3})), 0, 1e-3);
  EXPECT_EQ(angles_of({.place = {0, 0, 1}}, middle).azimuth_deg, 0);
  EXPECT_NEAR(angles_of({.place = {1, 0, 0}}, middle).azimuth_deg, 90, 1e-9);
  EXPECT_NEAR(length(direction_to(point, middle)), 1, 1e-6);

  StageLight sky = make_sky_light("clear");
  turn_light(sky, 200, 50, middle);
  EXPECT_EQ(sky.rotation_deg, -160);
}

TEST(Lighting, LightsAreTakenOverInTheirOrder) {
  EnvironmentLight environment{
      .image = make_image(4, 2, 3, 0.5f), .rotation_deg = 30, .scale = {1, 2, 3}, .file = "e.hdr"};
  const std::vector<Light> lights{DirectionalLight{{0, 0, 1}, {1, 2, 3}}, environment,
                                  PointLight{{1, 2, 3}, {4, 5, 6}, false},
                                  DirectionalLight{{1, 0, 0}, {3, 2, 1}}};
  const Lighting lighting = take_lights(lights);
  const std::vector<Light> all = make_lights(lighting, Disabled::keep);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(std::get<DirectionalLight>(all[0]).irradiance, (Rgb{1, 2, 3}));
  const auto& sky = std::get<EnvironmentLight>(all[1]);
  EXPECT_EQ(sky.image.values, environment.image.values);
  EXPECT_EQ(sky.rotation_deg, 30);
  EXPECT_EQ(sky.scale, (Rgb{1, 2, 3}));
  EXPECT_EQ(sky.file, "e.hdr");
  EXPECT_EQ(std::get<PointLight>(all[2]).position, (Vec3{1, 2, 3}));
  EXPECT_FALSE(std::get<PointLight>(all[2]).enabled);
  EXPECT_EQ(make_lights(lighting).size(), 3u);
  EXPECT_EQ(only_enabled(lighting).size(), 3u);
}

TEST(Lighting, DraggingFindsALightOfItsSort) {
  const auto lamp = [](bool enabled) { return StageLight{.enabled = enabled}; };
  const StageLight sky = make_sky_light("studio");
  const Lighting lighting{sky, lamp(false), lamp(true), lamp(false)};
  EXPECT_EQ(find_light(lighting, 3, false), 3u);  // the chosen one, though it is off
  EXPECT_EQ(find_light(lighting, 0, false), 2u);  // else the first that is on
  EXPECT_EQ(find_light(lighting, 9, false), 2u);
  EXPECT_EQ(find_light(lighting, 3, true), 0u);
  EXPECT_EQ(find_light({lamp(true)}, 0, true), 1u);  // none
}

// Any camera that looks at its target is an orbit, rolled ones and those from above, too.
TEST(Stage, OrbitsShowWhatTheirCameraShows) {
  for (const auto& [position, up] : {std::pair<Vec3, Vec3>{{10, 20, 30}, {0, 1, 0}},
                                     {{10, 20, 30}, {1, 1, -0.5f}},
                                     {{0, 50, 0}, {0, 0, -1}},
                                     {{0, 50, 0}, {1, 0, 0}},
                                     {{0, -50, 0}, {0, 1, 0}},
                                     {{-10, -20, 5}, {0, -1, 0}}}) {
    Camera camera;
    camera.position = position;
    camera.target = position.x == 0 ? Vec3{} : Vec3{1, 2, 3};
    camera.up = up;
    const CameraFrame wanted = make_camera_frame(camera);
    const CameraFrame found = make_camera_frame(make_camera(make_orbit(camera), 960, 720));
    EXPECT_LT(length(found.position - wanted.position), 1e-4f);
    EXPECT_LT(length(found.forward - wanted.forward), 1e-5f);
    EXPECT_LT(length(found.up - wanted.up), 1e-4f) << position.x << " " << up.x << " " << up.y;
  }
}

}  // namespace
}  // namespace parian

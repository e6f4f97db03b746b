#include "app/studio/property_picture.h"

#include <gtest/gtest.h>

#include "app/studio/studio_files.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

struct Ball {
  std::shared_ptr<const Stage> stage = make_plain_stage(make_sphere(4), {.shape = "sphere"});
  Camera camera = make_camera(frame_stage(*stage, 33, 33), 33, 33);
  Dipole pale{.channels = {{0.01, 2, 0}, {0.02, 1.5, 0}, {0.05, 1, 0}}};
  Dipole dark{.channels = {{0.5, 1, 0}, {0.7, 1.5, 0}, {0.9, 2, 0}}};

  StageLayers make_layer(double opacity, double albedo, double range) const {
    SurfaceLayer layer{.opacity = opacity, .albedo = albedo, .range = range};
    layer.material = std::make_shared<const Material>(dark);
    return {std::make_shared<const SurfaceLayer>(std::move(layer))};
  }
  // Where the surface faces the camera.
  Rgb middle(const StageLayers& layers, bool is_albedo) const {
    const Image image = draw_property(*stage, pale, layers, camera, is_albedo);
    return {at(image, 16, 16, 0), at(image, 16, 16, 1), at(image, 16, 16, 2)};
  }
};

TEST(PropertyPicture, AlbedoIsThatOfTheDipoleAndItsLayers) {
  const Ball ball;
  for (const double opacity : {0.0, 0.25, 1.0}) {
    const Rgb found = ball.middle(ball.make_layer(opacity, 0.8, 0.5), true);
    const auto expected = [&](std::size_t c) {
      const double below = dipole_albedo(ball.pale.channels[c], ball.pale.eta),
                   above = dipole_albedo(ball.dark.channels[c], ball.dark.eta);
      return below + 0.8 * opacity * (above - below);
    };
    EXPECT_NEAR(static_cast<double>(found.x), expected(0), 0.01) << opacity;
    EXPECT_NEAR(static_cast<double>(found.y), expected(1), 0.01) << opacity;
    EXPECT_NEAR(static_cast<double>(found.z), expected(2), 0.01) << opacity;
  }
}

TEST(PropertyPicture, RangeFallsWithALayerOfASmallerOne) {
  const Ball ball;
  const Rgb bare = ball.middle({}, false);
  EXPECT_EQ(ball.middle(ball.make_layer(1, 1, 0), false), bare);  // takes over no range
  EXPECT_EQ(ball.middle(ball.make_layer(0, 1, 1), false), bare);
  EXPECT_FALSE(ball.middle(ball.make_layer(1, 1, 1), false) == bare);
}

}  // namespace
}  // namespace parian

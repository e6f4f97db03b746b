#include "app/studio/refiner.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "mesh/shapes.h"
#include "render/render.h"

namespace parian {
namespace {

RefinementParams make_params() {
  RefinementParams params;
  params.render.samples = 2000;
  params.render.rays = 8;
  params.render.antialias = 1;
  params.tile = 8;
  return params;
}

RefineRequest make_request() {
  Scene scene;
  scene.mesh = make_sphere(3);
  fit_to_size(scene.mesh, 10);
  RefineRequest request{.under = nullptr,
                        .stage = make_stage(std::move(scene)),
                        .material = std::make_shared<const Material>(Dipole{
                            .channels = {DipoleCoefficients{.sigma_a = 0.01, .sigma_s_prime = 2}}}),
                        .layers = {},
                        .lighting = {{.place = direction_of(45, 40), .power = {2.5f, 2.5f, 2.5f}}},
                        .camera = {},
                        .exposure = 0};
  request.camera = make_camera(frame_stage(*request.stage, 32, 24), 32, 24);
  const std::vector<std::uint8_t> grey(std::size_t{4} * 32 * 24, 77);
  request.under =
      std::make_shared<const Picture>(Picture{.id = 5, .width = 32, .height = 24, .rgba = grey});
  return request;
}

std::vector<std::uint8_t> draw_brute(const RefineRequest& request) {
  RenderParams params = make_params().render;
  params.method = GatherMethod::brute;
  params.shading = Shading::pixel;
  Scene scene = make_scene(*request.stage, *request.material, request.layers, request.lighting,
                           request.camera);
  scene.exposure = request.exposure;
  return encode_picture(render(scene, params).image);
}

TEST(Refiner, EndsWithEverySampleSummed) {
  const RefineRequest request = make_request();
  Refiner refiner(make_params());
  EXPECT_EQ(refiner.latest(), nullptr);
  refiner.run(request, {});
  ASSERT_NE(refiner.latest(), nullptr);
  EXPECT_EQ(refiner.latest()->id, 5u);
  EXPECT_GT(refiner.latest()->passes_done, 1);
  EXPECT_EQ(refiner.latest()->half_width, 0);
  EXPECT_EQ(refiner.latest()->rgba, draw_brute(request));
}

TEST(Refiner, StopsAndGoesOn) {
  const RefineRequest request = make_request();
  Refiner refiner(make_params());
  bool in_passes = false;
  const Progress stopping{
      [&](std::string_view, double done) { in_passes = in_passes || done > 0.1; },
      [&] { return in_passes; }};
  EXPECT_THROW(refiner.run(request, stopping), Error);
  refiner.run(request, {});
  EXPECT_EQ(refiner.latest()->rgba, draw_brute(request));
}

TEST(Refiner, ChangesLeaveNothingBehind) {
  RefineRequest request = make_request();
  Refiner refiner(make_params());
  refiner.run(request, {});
  const auto check = [&](auto change) {
    change(request);
    Picture under = *request.under;
    ++under.id;
    request.under = std::make_shared<const Picture>(under);
    refiner.run(request, {});
    EXPECT_EQ(refiner.latest()->id, under.id);
    EXPECT_EQ(refiner.latest()->rgba, draw_brute(request));
  };
  check([](RefineRequest& r) { r.exposure = 1; });
  check([](RefineRequest& r) { r.lighting[0].place = direction_of(-60, 40); });
  check([](RefineRequest& r) { r.camera.position = r.camera.position * 1.5f; });
  check([](RefineRequest& r) {
    Dipole darker = std::get<Dipole>(*r.material);
    darker.channels[0].sigma_a = 1;
    r.material = std::make_shared<const Material>(darker);
  });
  const auto set_layer = [](RefineRequest& r, double opacity) {
    SurfaceLayer layer{.opacity = opacity};
    layer.material = std::make_shared<const Material>(Dipole{.channels = {{0.5, 3, 0}}});
    layer.mask = {{GradientMask{r.stage->box.lower, r.stage->box.upper}}};
    r.layers = {std::make_shared<const SurfaceLayer>(std::move(layer))};
  };
  check([&](RefineRequest& r) { set_layer(r, 1); });
  check([&](RefineRequest& r) { set_layer(r, 0.5); });
  check([](RefineRequest& r) { r.layers.clear(); });
  check([](RefineRequest& r) { r.stage = make_request().stage; });
}

TEST(Refiner, FailuresLeaveNothingBehind) {
  const RefineRequest good = make_request();
  Refiner refiner(make_params());
  refiner.run(good, {});
  RefineRequest bad = good;
  bad.lighting[0].place = direction_of(-60, 40);
  SurfaceLayer layer;
  layer.material = std::make_shared<const Material>(Dipole{.channels = {{0.5, 3, 0}}, .eta = 1.7});
  bad.layers = {std::make_shared<const SurfaceLayer>(std::move(layer))};
  for (const auto& stage : {good.stage, make_request().stage}) {
    bad.stage = stage;
    EXPECT_THROW(refiner.run(bad, {}), Error);
    refiner.run(good, {});
    EXPECT_EQ(refiner.latest()->rgba, draw_brute(good));
  }
}

// What is not refined yet is what was there.
TEST(Refiner, ShowsWhatIsUnderIt) {
  RefineRequest request = make_request();
  RefinementParams params = make_params();
  params.tile = 16;
  Refiner refiner(params);
  bool had_tile = false;
  const Progress stopping{[&](std::string_view, double done) { had_tile = done > 0; },
                          [&] { return had_tile; }};
  EXPECT_THROW(refiner.run(request, stopping), Error);
  // Taken up again it shows the tile that is there at once, and is stopped.
  EXPECT_THROW(refiner.run(request, {{}, [] { return true; }}), Error);
  ASSERT_NE(refiner.latest(), nullptr);
  EXPECT_EQ(refiner.latest()->passes_done, 0);
  const std::vector<std::uint8_t>& rgba = refiner.latest()->rgba;
  EXPECT_EQ(rgba[rgba.size() - 4], 77);
  EXPECT_NE(rgba, request.under->rgba);
}

}  // namespace
}  // namespace parian

#include "render/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/parallel.h"
#include "mesh/ray_tracer.h"
#include "mesh/shapes.h"
#include "render/test_scenes.h"
#include "scene/camera.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

using namespace testing_scenes;

Rgb pixel(const Image& image, int x, int y) {
  return {at(image, x, y, 0), at(image, x, y, 1), at(image, x, y, 2)};
}

// Mean over pixels that are wholly covered, by the green channel.
double mean_inside(const Image& image) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (at(image, x, y, 1) > 0) {
        sum += static_cast<double>(at(image, x, y, 1));
        ++count;
      }
  return sum / std::max(count, 1);
}

double relative_difference(const Image& a, const Image& b) {
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    difference += std::abs(static_cast<double>(a.values[i] - b.values[i]));
    sum += static_cast<double>(a.values[i]);
  }
  return difference / sum;
}

// A box seen from above: its top is a plane far larger than the scattering range.
Scene make_plane_scene(SurfaceMaterial material) {
  Scene scene = make_scene(make_box({40, 10, 40}), 40, std::move(material), 5, 5);
  const Bounds3 box = bounds(scene.mesh);
  scene.camera.position = {0, box.upper.y + 50, 0};
  scene.camera.target = {0, box.upper.y, 0};
  scene.camera.up = {0, 0, -1};
  scene.camera.fov_deg = 4;
  return scene;
}

TEST(render, narrow_profiles_are_lambertian) {
  Scene scene = make_scene(make_sphere(4), 20, Material(make_uniform_map(1e-3, 0.6)));
  const Vec3 towards = normalize({0.5f, 0.7f, 0.6f});
  scene.lights = {DirectionalLight{towards, {1, 2, 3}}};
  RenderParams params = quick_params();
  params.samples = 20000;
  const Image image = render(scene, params).image;
  const RayTracer tracer(scene.mesh);
  int compared = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const CameraRay ray = make_camera_ray(scene.camera, x + 0.5, y + 0.5);
      const auto hit = tracer.intersect({ray.origin, ray.direction});
      if (!hit) {
        EXPECT_EQ(pixel(image, x, y), Rgb{});
        continue;
      }
      const float cosine =
          dot(get_surface_point(scene.mesh, hit->triangle, hit->barycentric).normal, towards);
      if (cosine < 0.1f) continue;
      ++compared;
      EXPECT_NEAR(at(image, x, y, 0), 0.6f * cosine / pi, 0.006f) << x << " " << y;
      EXPECT_NEAR(at(image, x, y, 2), 3 * 0.6f * cosine / pi, 0.018f) << x << " " << y;
    }
  EXPECT_GT(compared, 200);
}

TEST(render, plane_furnace) {
  for (const double length : {0.01, 0.3, 1.0}) {
    Scene scene = make_plane_scene(Material(make_uniform_map(length, 0.7)));
    scene.camera.fov_deg = 25;
    scene.camera.width = scene.camera.height = 16;
    scene.lights = {white_environment()};
    for (const GatherMethod method : {GatherMethod::brute, GatherMethod::tree}) {
      RenderParams params = quick_params();
      params.samples = 20000;
      params.method = method;
      const Image image = render(scene, params).image;
      // The mean is free of the noise of samples that are half a millimetre apart.
      EXPECT_NEAR(mean_inside(image), 0.7, 0.007) << length;
      double square = 0;
      for (const float value : image.values) {
        EXPECT_NEAR(value, 0.7f, 0.1f) << length;
        square += std::pow(static_cast<double>(value) / 0.7 - 1, 2);
      }
      EXPECT_LT(std::sqrt(square / static_cast<double>(image.values.size())), 0.035) << length;
    }
  }
}

TEST(render, excluded_boundary_transmits_twice) {
  Scene included = make_plane_scene(Material(make_uniform_map(0.5, 0.7)));
  Scene excluded = make_plane_scene(Material(make_uniform_map(0.5, 0.7, Boundary::excluded)));
  const Vec3 towards = normalize({1, 0.8f, 0});
  for (Scene* scene : {&included, &excluded}) {
    scene->lights = {DirectionalLight{towards, {1, 1, 1}}};
    scene->camera.position = scene->camera.target + Vec3{0, 30, 40};
  }
  const float expected =
      fresnel_transmission(1.3f, towards.y) * fresnel_transmission(1.3f, 30.0f / 50.0f);
  const float found = at(render(excluded, quick_params()).image, 2, 2, 0) /
                      at(render(included, quick_params()).image, 2, 2, 0);
  EXPECT_NEAR(found, expected, 0.002f);
  EXPECT_LT(expected, 0.95f);
}

TEST(render, tessellation_does_not_matter) {
  std::vector<double> means;
  for (const int subdivisions : {3, 4, 5, 6}) {
    Scene scene = make_scene(make_sphere(subdivisions), 20, Material(make_uniform_map(0.7, 0.8)));
    scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
    RenderParams params = quick_params();
    params.samples = 8000;
    means.push_back(mean_inside(render(scene, params).image));
  }
  for (const double mean : means) EXPECT_NEAR(mean / means.back(), 1, 0.01);
}

TEST(render, orientation_of_the_faces_does_not_matter) {
  TriangleMesh mesh = make_knot();
  mesh.texcoords.clear();
  const auto render_mesh = [](TriangleMesh made) {
    clean_mesh(made, "knot");
    Scene scene = make_scene(std::move(made), 30, Material(make_uniform_map(0.7, 0.8)));
    scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
    RenderParams params = quick_params();
    params.samples = 20000;
    return render(scene, params).image;
  };
  const Image reference = render_mesh(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (t % 3 != 0) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  for (Vec3& normal : mesh.normals) normal = -normal;
  const Image flipped = render_mesh(mesh);
  EXPECT_NEAR(mean_inside(flipped) / mean_inside(reference), 1, 0.005);
  EXPECT_LT(relative_difference(reference, flipped), 0.02);
}

TEST(render, thin_slab_shines_when_lit_from_behind) {
  const auto front = [](float thickness) {
    Scene scene =
        make_scene(make_box({20, 20, thickness}), 20, Material(make_uniform_map(0.6, 0.8)), 9, 9);
    scene.camera.position = scene.camera.target + Vec3{0, 0, 60};
    scene.camera.fov_deg = 10;
    scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}};
    RenderParams params = quick_params();
    params.samples = 20000;
    return at(render(scene, params).image, 4, 4, 0);
  };
  // All of the back within reach: M = 2 pi int_t^inf P r dr = 0.8 (1 + t/l) e^{-t/l}, roughly.
  const float thin = front(0.6f), thick = front(12);
  EXPECT_NEAR(thin * pi, 0.8f * 2 * std::exp(-1.0f), 0.03f);
  EXPECT_LT(thick, 1e-3f * thin);
}

TEST(render, is_linear_in_light) {
  Scene scene = make_scene(make_knot(), 30, Material(make_striped_map(0.7)));
  scene.specular.enabled = true;
  const Light a = DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 0.5f, 0.2f}};
  const Light b = PointLight{{30, 40, 10}, {900, 700, 2000}};
  const auto render_lights = [&](std::vector<Light> lights) {
    scene.lights = std::move(lights);
    return render(scene, quick_params()).image;
  };
  Image sum = render_lights({a});
  const Image second = render_lights({b});
  for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += second.values[i];
  EXPECT_LT(relative_difference(render_lights({a, b}), sum), 1e-5);
}

TEST(render, rotation_of_everything_changes_nothing) {
  const Dipole dipole{{{0.02, 2}, {0.05, 1.5}, {0.2, 1}}, 1.3};
  Scene scene = make_scene(make_knot(), 30, Material(dipole));
  scene.specular.enabled = true;
  scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
  RenderParams params = quick_params();
  params.samples = 20000;
  const Image reference = render(scene, params).image;
  const Frame frame = make_frame(normalize({0.3f, -0.5f, 0.7f}));
  const auto turn = [&](Vec3& v) { v = to_world(frame, v); };
  for (Vec3& p : scene.mesh.positions) turn(p);
  for (Vec3& n : scene.mesh.normals) turn(n);
  turn(scene.camera.position);
  turn(scene.camera.target);
  turn(scene.camera.up);
  turn(std::get<DirectionalLight>(scene.lights[0]).direction);
  // Rounding picks other samples.
  const Image turned = render(scene, params).image;
  EXPECT_NEAR(mean_inside(turned) / mean_inside(reference), 1, 0.005);
  EXPECT_LT(relative_difference(reference, turned), 0.04);
}

TEST(render, unit_of_length_does_not_matter) {
  Scene scene = make_scene(make_knot(), 30, Material(make_striped_map(0.7)));
  scene.specular.enabled = true;
  scene.lights = {PointLight{{30, 40, 50}, {2000, 2000, 2000}}};
  const Image reference = render(scene, quick_params()).image;
  for (Vec3& p : scene.mesh.positions) p *= 8;
  scene.camera.position *= 8;
  scene.camera.target *= 8;
  auto& light = std::get<PointLight>(scene.lights[0]);
  light.position *= 8;
  light.intensity *= 64;
  auto& map = std::get<ProfileMap>(std::get<Material>(scene.material));
  map.pixel_pitch_mm *= 8;
  for (double& knot : map.knots_mm) knot *= 8;
  for (float& value : map.log_profile) value -= 2 * std::log(8.0f);
  EXPECT_LT(relative_difference(reference, render(scene, quick_params()).image), 1e-3);
}

TEST(render, threads_do_not_change_a_bit) {
  Scene scene = make_scene(make_knot(), 30, Material(make_striped_map(0.7)));
  scene.specular.enabled = true;
  scene.lights = {white_environment(), DirectionalLight{}};
  RenderParams params = quick_params();
  params.antialias = 2;
  const auto render_with = [&](int threads) {
    const ThreadLimit limit(threads);
    return render(scene, params).image.values;
  };
  for (const GatherMethod method : {GatherMethod::brute, GatherMethod::tree}) {
    params.method = method;
    EXPECT_EQ(render_with(1), render_with(2));
  }
  scene.material = read_table(*make_slices(std::get<Material>(scene.material),
                                           natural_header(std::get<Material>(scene.material))));
  EXPECT_EQ(render_with(1), render_with(2));
}

TEST(render, has_no_speckles) {
  for (const char* shape : {"knot", "fin", "box"}) {
    Scene scene = make_scene(make_shape(shape), 30,
                             Material(Dipole{{{0.02, 2}, {0.05, 1.5}, {0.2, 1}}}), 80, 60);
    scene.specular.enabled = true;
    scene.lights = {white_environment()};
    RenderParams params = quick_params();
    params.method = GatherMethod::tree;
    params.samples = 20000;
    const Image image = render(scene, params).image;
    const RayTracer tracer(scene.mesh);
    const double mean = mean_inside(image);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const CameraRay ray = make_camera_ray(scene.camera, x + 0.5, y + 0.5);
        const bool is_inside = tracer.intersect({ray.origin, ray.direction}).has_value();
        const Rgb value = pixel(image, x, y);
        ASSERT_TRUE(is_finite(value));
        if (is_inside) {
          EXPECT_GT(static_cast<double>(value.y), 0.12 * mean) << shape << " " << x << " " << y;
          EXPECT_LT(static_cast<double>(value.y), 3 * mean) << shape << " " << x << " " << y;
        } else {
          EXPECT_EQ(value, Rgb{});
        }
      }
  }
}

TEST(render, table_and_the_model_that_it_is_made_from_agree) {
  Scene scene = make_scene(make_knot(), 30, Material(make_uniform_map(0.7, 0.8)));
  scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
  RenderParams params = quick_params();
  params.samples = 20000;
  // A finer pitch, as the table is linear between its pixels, and a grid wider than its window.
  auto& map = std::get<ProfileMap>(std::get<Material>(scene.material));
  ProfileMap fine = make_profile_map(40, 40, 1, 0.25, map.knots_mm);
  for (int k = 0; k <= 8; ++k)
    std::fill_n(knot_plane(fine, 0, k), fine.pixels(), knot_plane(map, 0, k)[0]);
  fine.boundary = Boundary::included;
  const Image model = render(scene, params).image;
  const Material material = fine;
  scene.material = read_table(*make_slices(material, natural_header(material)));
  const RenderResult result = render(scene, params);
  EXPECT_EQ(result.report.gather, "table");
  EXPECT_NEAR(mean_inside(result.image) / mean_inside(model), 1, 0.01);
  EXPECT_LT(relative_difference(model, result.image), 0.02);
}

TEST(render, vertices_shade_like_pixels_on_a_fine_mesh) {
  Scene scene = make_scene(make_sphere(5), 20, Material(make_uniform_map(1, 0.8)));
  scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
  RenderParams params = quick_params();
  const Image pixels = render(scene, params).image;
  params.shading = Shading::vertex;
  const RenderResult vertices = render(scene, params);
  EXPECT_EQ(vertices.report.targets, scene.mesh.positions.size());
  EXPECT_LT(relative_difference(pixels, vertices.image), 0.01);
}

TEST(render, tree_follows_brute_force) {
  Scene scene = make_scene(make_knot(), 30, Material(make_striped_map(0.7)));
  scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
  RenderParams params = quick_params();
  const Image brute = render(scene, params).image;
  params.method = GatherMethod::tree;
  params.quality = 0.01;
  const RenderResult tree = render(scene, params);
  EXPECT_LT(relative_difference(brute, tree.image), 0.01);
  EXPECT_EQ(tree.report.gather, "tree");
  EXPECT_GT(tree.report.certified, 0u);
  EXPECT_GT(tree.report.max_half_width, 0);
}

TEST(render, background_and_exposure) {
  Scene scene = make_scene(make_sphere(3), 20, Material(make_uniform_map(0.7, 0.8)), 8, 6);
  scene.lights = {white_environment(2)};
  scene.background = {0.1f, 0.2f, 0.3f};
  scene.exposure = 1;
  const RenderParams params = quick_params();
  EXPECT_EQ(pixel(render(scene, params).image, 0, 0), (Rgb{0.1f, 0.2f, 0.3f}));
  const float middle = at(render(scene, params).image, 4, 3, 0);
  scene.show_environment = true;
  EXPECT_EQ(pixel(render(scene, params).image, 0, 0), (Rgb{4, 4, 4}));
  scene.exposure = 0;
  EXPECT_FLOAT_EQ(at(render(scene, params).image, 4, 3, 0), middle / 2);
}

}  // namespace
}  // namespace parian

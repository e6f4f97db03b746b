#include "transport/layered_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "base/test_errors.h"
#include "material/properties.h"
#include "mesh/ray_tracer.h"
#include "mesh/surface_samples.h"
#include "render/test_scenes.h"
#include "transport/gather.h"
#include "transport/row_blend.h"

namespace parian {
namespace {

using namespace testing_scenes;

Dipole make_wax(double absorption = 0.02) {
  return {{{absorption, 1.5}, {2 * absorption, 1.2}, {5 * absorption, 1.0}}, 1.3};
}

SurfaceLayer make_layer(Material material, SurfaceMask mask = {}) {
  SurfaceLayer layer;
  layer.material = std::move(material);
  layer.mask = std::move(mask);
  return layer;
}
MaskTerm half_gradient(float size) {
  return {GradientMask{{0, 0, 0}, {0, size, 0}}};
}

Scene make_sphere_scene(Material material, int width = 16) {
  Scene scene = make_scene(make_sphere(3), 20, std::move(material), width, width * 3 / 4);
  scene.lights = {DirectionalLight{normalize({0.5f, 0.7f, 0.6f}), {1, 1, 1}}};
  return scene;
}

RenderParams few_params() {
  RenderParams params = quick_params();
  params.samples = 1500;
  return params;
}

double largest_change(const Image& a, const Image& b) {
  double largest = 0, top = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    largest = std::max(largest, static_cast<double>(std::abs(a.values[i] - b.values[i])));
    top = std::max(top, static_cast<double>(a.values[i]));
  }
  return largest / top;
}

// The profile of channel c of a row, as the model has it.
Profile to_profile(const std::vector<float>& knots, const ProfileRow& row, std::size_t c) {
  Profile profile;
  profile.support_mm = static_cast<double>(row.support_mm[c]);
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const auto r = static_cast<double>(knots[k]);
    const double y = 2 * static_cast<double>(row.half_log[3 * k + c]);
    if (r >= profile.support_mm && k > 0) {
      const double before = profile.knots_mm.back();
      const double t = (profile.support_mm - before) / (r - before);
      profile.log_value.push_back((1 - t) * profile.log_value.back() + t * y);
      profile.knots_mm.push_back(profile.support_mm);
      break;
    }
    profile.knots_mm.push_back(r);
    profile.log_value.push_back(y);
  }
  return profile;
}

ProfileRow eval_row(const ProfileField& field, double x, double y) {
  ProfileRow row;
  row.half_log.resize(field.row());
  field.eval(x, y, row.half_log.data(), row.support_mm.data());
  return row;
}
ProfileRow eval_point(const ProfileField& field, std::size_t i) {
  const Vec2 place = layered_place(i);
  return eval_row(field, static_cast<double>(place.x), static_cast<double>(place.y));
}

ProfileField make_field(const Scene& scene, const SurfaceSamples& samples) {
  auto field = make_layered_field(scene, samples.points.size(),
                                  [&](std::size_t i) { return samples.points[i]; });
  EXPECT_TRUE(field.has_value());
  return std::move(*field);
}

TEST(LayeredField, MasksOfZeroLeaveEveryBit) {
  for (const Material& base : {Material(make_striped_map(1)), Material(make_wax())}) {
    Scene scene = make_sphere_scene(base);
    Material other = make_uniform_map(2, 0.3, boundary_of(base));
    RenderParams params = few_params();
    params.method = GatherMethod::tree;
    const Image plain = render(scene, params).image;
    scene.layers = {make_layer(other, {{SphereMask{{500, 0, 0}, 1, 0}}}), make_layer(other)};
    scene.layers[1].opacity = 0;
    EXPECT_EQ(render(scene, params).image.values, plain.values);
    scene.layers[1].opacity = 0.5;
    EXPECT_NE(render(scene, params).image.values, plain.values);
  }
}

TEST(LayeredField, MasksOfOneCoverAll) {
  Scene scene = make_sphere_scene(make_striped_map(1));
  scene.mapping.rotation_deg = 30;
  Scene covered = make_sphere_scene(make_uniform_map(2, 0.3));
  covered.layers = {make_layer(make_uniform_map(0.5, 0.9), {half_gradient(20)}),
                    make_layer(std::get<Material>(scene.material))};
  covered.layers[1].mapping = scene.mapping;
  EXPECT_EQ(render(covered, few_params()).image.values, render(scene, few_params()).image.values);
}

TEST(LayeredField, AMaterialOverItselfIsItself) {
  for (const Material& base : {Material(make_striped_map(1)), Material(make_wax())}) {
    Scene scene = make_sphere_scene(base);
    const Image plain = render(scene, few_params()).image;
    scene.layers = {make_layer(base, {half_gradient(20)}), make_layer(base)};
    scene.layers[1].opacity = 0.4;
    scene.layers[1].shape = 0.3;
    EXPECT_LT(largest_change(render(scene, few_params()).image, plain), 1e-5);
  }
}

TEST(LayeredField, ScatteringIsSymmetric) {
  Scene scene = make_sphere_scene(make_striped_map(1));
  scene.layers = {make_layer(make_uniform_map(2.5, 0.3), {half_gradient(20)}),
                  make_layer(make_uniform_map(0.4, 0.9), {{SphereMask{{0, 20, 0}, 8, 3}}})};
  const SurfaceSamples samples = make_surface_samples(scene.mesh, 1500, 1);
  const ProfileField field = make_field(scene, samples);
  GatherSources sources[2];
  Rng rng = make_rng(7);
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Vec2 place = layered_place(i);
    const GatherPoint point{samples.points[i].position, samples.points[i].normal, place.x, place.y};
    GatherSources& side = sources[i % 2];
    const auto flux = static_cast<float>(sample_uniform(rng));
    side.points.push_back(point);
    side.flux.push_back({flux, flux, flux});
    side.area_mm2 = samples.area_mm2;
  }
  double sums[2][3] = {};
  for (int way = 0; way < 2; ++way) {
    const GatherSources& to = sources[1 - way];
    const std::vector<Rgb> found = gather_brute(field, sources[way], to.points, 0);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Rgb product = found[i] * to.flux[i];
      sums[way][0] += static_cast<double>(product.x);
      sums[way][1] += static_cast<double>(product.y);
      sums[way][2] += static_cast<double>(product.z);
    }
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sums[1][c] / sums[0][c], 1, 1e-6);
}

TEST(LayeredField, EachSideOfASeamIsItsOwnMaterial) {
  const ProfileMap below = make_striped_map(0.3), above = make_uniform_map(0.4, 0.3);
  Scene scene = make_sphere_scene(below, 40);
  const Image lower = render(scene, few_params()).image;
  const Image upper = render(make_sphere_scene(above, 40), few_params()).image;
  // Meets the object in its equator, y = 10.
  scene.layers = {make_layer(above, {{SphereMask{{0, 20, 0}, 10 * std::numbers::sqrt2, 0.2}}})};
  const Image both = render(scene, few_params()).image;
  const RayTracer tracer(scene.mesh);
  int seen[2] = {};
  for (int x = 0; x < both.width; ++x)
    for (int y = 0; y < both.height; ++y) {
      const CameraRay ray = make_camera_ray(scene.camera, x + 0.5, y + 0.5);
      const auto hit = tracer.intersect({ray.origin, ray.direction});
      if (!hit) continue;
      const float height =
          get_surface_point(scene.mesh, hit->triangle, hit->barycentric).position.y;
      if (std::abs(height - 10) < 4) continue;  // beyond both supports
      ++seen[height > 10];
      const float expected = at(height > 10 ? upper : lower, x, y, 1);
      EXPECT_NEAR(at(both, x, y, 1), expected, 1e-3f * expected) << x << ' ' << y;
    }
  EXPECT_GT(seen[0], 20);
  EXPECT_GT(seen[1], 20);
}

TEST(LayeredField, TreesAgreeWithBruteForce) {
  Scene scene = make_sphere_scene(make_striped_map(1));
  scene.layers = {make_layer(make_uniform_map(2.5, 0.3), {half_gradient(20)}),
                  make_layer(make_uniform_map(0.4, 0.9), {{SphereMask{{0, 20, 0}, 8, 3}}})};
  const Image brute = render(scene, few_params()).image;
  RenderParams params = few_params();
  params.method = GatherMethod::tree;
  EXPECT_LT(largest_change(render(scene, params).image, brute), 1e-3);
  params.tolerance = 0.02;
  const RenderResult certified = render(scene, params);
  EXPECT_EQ(certified.report.certified, certified.report.targets);
  EXPECT_LE(certified.report.max_half_width, 0.02);
  EXPECT_LT(largest_change(certified.image, brute), 0.02);
}

TEST(LayeredField, PropertiesAreTakenOneByOne) {
  const ProfileMap base = make_striped_map(1);
  Scene scene = make_sphere_scene(base);
  scene.layers = {make_layer(make_uniform_map(2.5, 0.3), {half_gradient(20)})};
  SurfaceLayer& layer = scene.layers[0];
  const SurfaceSamples samples = make_surface_samples(scene.mesh, 200, 1);
  for (const int property : {0, 1, 2}) {
    layer.albedo = property == 0;
    layer.range = property == 1;
    layer.shape = property == 2;
    const ProfileField field = make_field(scene, samples);
    const RowKnots knots = make_row_knots(field.knots_mm);
    RowScratch scratch;
    Scene bare = scene;
    bare.layers[0].opacity = 1e-9;
    const ProfileField before = make_field(bare, samples);
    ASSERT_EQ(before.knots_mm, field.knots_mm);
    for (std::size_t i = 0; i < samples.points.size(); ++i) {
      const double w = eval_mask(layer.mask, scene.mesh, samples.points[i]);
      const RowProperties a = measure_row(knots, eval_point(before, i), scratch);
      const RowProperties found = measure_row(knots, eval_point(field, i), scratch);
      for (std::size_t c = 0; c < 3; ++c) {
        const double albedo = 0.3 / (2 * std::numbers::pi);
        const double wanted = property == 0 ? (1 - w) * a.integral[c] + w * albedo : a.integral[c];
        EXPECT_NEAR(found.integral[c] / wanted, 1, 1e-4);
        const double range = -2.5 * std::log(support_threshold);
        const double reach = property == 1 ? (1 - w) * a.range_mm[c] + w * range : a.range_mm[c];
        if (property != 2) {
          EXPECT_NEAR(found.range_mm[c] / reach, 1, 1e-2);
        }
      }
    }
  }
}

TEST(RowBlend, AgreesWithBlendedProfiles) {
  Rng rng = make_rng(11);
  std::vector<float> grid{0};
  for (int k = 1; k <= 127; ++k)
    grid.push_back(30.0f * std::pow(static_cast<float>(k) / 127, 1.5f));
  const RowKnots knots = make_row_knots(grid);
  RowScratch scratch;
  for (int trial = 0; trial < 20; ++trial) {
    ProfileRow rows[2];
    for (ProfileRow& row : rows) {  // sums of two exponentials, falling
      const double near = 0.3 + sample_uniform(rng), far = near + 2 * sample_uniform(rng);
      const double part = sample_uniform(rng), gain = std::exp(4 * sample_uniform(rng) - 6);
      for (const float r : grid) {
        const double value = gain * ((1 - part) * std::exp(-static_cast<double>(r) / near) +
                                     part * std::exp(-static_cast<double>(r) / far));
        for (int c = 0; c < 3; ++c)
          row.half_log.push_back(static_cast<float>(0.5 * std::log(value)));
      }
      row.support_mm = {30, 30, 30};
      const RowProperties found = measure_row(knots, row, scratch);
      for (float& support : row.support_mm) support = static_cast<float>(found.range_mm[0]);
      const Profile profile = to_profile(grid, row, 1);
      EXPECT_NEAR(found.range_mm[1] / profile_range(profile), 1, 1e-4);
      EXPECT_NEAR(measure_row(knots, row, scratch).integral[1] / profile_integral(profile), 1,
                  2e-6);
    }
    const PropertyWeights weights{sample_uniform(rng), sample_uniform(rng), sample_uniform(rng)};
    const Profile a = to_profile(grid, rows[0], 0), b = to_profile(grid, rows[1], 0);
    const Profile wanted = blend_profiles(a, b, weights);
    blend_rows(knots, rows[0], rows[1], weights, true, scratch);
    const Profile found = to_profile(grid, rows[0], 0);
    EXPECT_NEAR(profile_integral(found) / profile_integral(wanted), 1, 2e-5);
    for (double t = 0; t < 0.8; t += 0.05) {
      const double r = t * wanted.support_mm;
      EXPECT_NEAR(eval_log_profile(found, r), eval_log_profile(wanted, r), 0.03) << r;
    }
    for (std::size_t i = 3; i < rows[0].half_log.size(); ++i)
      EXPECT_LE(rows[0].half_log[i], rows[0].half_log[i - 3]);
  }
}

TEST(CommonKnots, AreAsManyAsAllowedAndKeepTheEnds) {
  const ProfileField map = make_profile_field(make_striped_map(1));
  const ProfileField wax = make_profile_field(make_wax());
  const ProfileField thin = make_profile_field(make_wax(1));
  EXPECT_EQ(make_common_knots({&map, &map}, false), map.knots_mm);
  const std::vector<float> refined = make_common_knots({&map, &map}, true);
  EXPECT_EQ(refined.size(), layered_knots);
  for (const float knot : map.knots_mm)
    EXPECT_TRUE(std::binary_search(refined.begin(), refined.end(), knot));
  const std::vector<float> common = make_common_knots({&wax, &thin}, false);
  EXPECT_EQ(common.size(), layered_knots);
  EXPECT_TRUE(std::is_sorted(common.begin(), common.end()));
  EXPECT_EQ(common.front(), 0);
  EXPECT_EQ(common.back(), std::max(wax.knots_mm.back(), thin.knots_mm.back()));
}

// What is lost by thinning: between all of two fields' knots.
TEST(CommonKnots, KeepProfilesWhereTheyCount) {
  const ProfileField fields[] = {make_profile_field(make_wax(0.001)),
                                 make_profile_field(make_wax(1)),
                                 make_profile_field(make_wax(0.03))};
  const std::vector<float> common = make_common_knots({&fields[0], &fields[1], &fields[2]}, false);
  EXPECT_EQ(common.size(), layered_knots);
  for (const ProfileField& field : fields) {
    const ProfileRow row = eval_row(field, 0, 0);
    for (std::size_t c = 0; c < 3; ++c) {
      const Profile own = to_profile(field.knots_mm, row, c);
      for (std::size_t k = 0; k + 1 < common.size(); ++k) {
        const auto a = static_cast<double>(common[k]), b = static_cast<double>(common[k + 1]);
        if (b >= own.support_mm) break;
        for (double t = 0.1; t < 1; t += 0.1) {
          const double chord = (1 - t) * eval_log_profile(own, a) + t * eval_log_profile(own, b);
          EXPECT_NEAR(chord, eval_log_profile(own, (1 - t) * a + t * b), 4e-3);
        }
      }
    }
  }
}

TEST(LayeredField, Errors) {
  Scene scene = make_sphere_scene(make_striped_map(1));
  scene.layers = {make_layer(make_wax())};
  scene.layers[0].material_name = "wax";
  scene.material_name = "stripes";
  EXPECT_EQ(error_of([&] { render(scene, few_params()); }),
            "test mesh: /layers/0/material: expected the boundary 'included' of 'stripes', "
            "which lies below, found 'excluded' of 'wax'");
  scene.layers[0] = make_layer(make_uniform_map(1, 0.5));
  scene.layers[0].range = std::nan("");
  EXPECT_THROW(render(scene, few_params()), Error);
}

}  // namespace
}  // namespace parian

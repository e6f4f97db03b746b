// A blend and its expanded map are one material, whoever looks at it: renderers, flat relighting,
// comparison.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "io/blend/blend_file.h"
#include "judge/compare.h"
#include "judge/relight.h"
#include "material/bssrdf_table.h"
#include "render/test_scenes.h"

namespace parian {
namespace {

using namespace testing_scenes;

// Two bases a pixel out of twelve, the tails of some of which are flat.
ProfileBlend make_blend() {
  ProfileBlend blend;
  blend.width = 9;
  blend.height = 8;
  blend.pixel_pitch_mm = 0.7;
  blend.boundary = Boundary::included;
  for (int k = 0; k < 5; ++k) blend.knots_mm.push_back(0.7 * k);
  Rng rng = make_rng(4);
  for (int row = 0; row < 12 * 3; ++row) {
    auto value = static_cast<float>(-1 - sample_uniform(rng));
    for (int k = 0; k < 5; ++k) {
      blend.base_log_profile.push_back(value);
      if (k < 3 || row % 4 != 0) value -= static_cast<float>(0.2 + sample_uniform(rng));
    }
  }
  for (std::size_t i = 0; i < 2 * blend.pixels(); ++i)
    blend.index.push_back(static_cast<std::uint16_t>(sample_u32(rng) % 12));
  for (std::size_t i = 0; i < blend.pixels(); ++i)
    blend.weight.push_back(static_cast<float>(sample_uniform(rng)));
  for (std::size_t i = 0; i < 3 * blend.pixels(); ++i)
    blend.gain.push_back(static_cast<float>(0.5 + sample_uniform(rng)));
  return blend;
}

double largest_difference(const Image& a, const Image& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(a.values[i] - b.values[i])));
  return largest;
}

double largest(const Image& image) {
  return static_cast<double>(*std::max_element(image.values.begin(), image.values.end()));
}

TEST(Blends, RenderAsTheirMaps) {
  Scene scene = make_scene(make_knot(), 30, Material(make_blend()));
  scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
  Scene expanded = scene;
  expanded.material = Material(make_profile_map(make_blend()));
  RenderParams params = quick_params();
  for (const GatherMethod method : {GatherMethod::brute, GatherMethod::tree}) {
    params.method = method;
    const Image a = render(scene, params).image, b = render(expanded, params).image;
    EXPECT_GT(largest(b), 0.01);
    EXPECT_LT(largest_difference(a, b), 1e-5 * largest(b));
  }
}

TEST(Blends, AnotherBlendIsAnotherPicture) {
  Scene scene = make_scene(make_knot(), 30, Material(make_blend()));
  scene.lights = {DirectionalLight{normalize({0.3f, 0.6f, 1}), {1, 1, 1}}};
  const Image a = render(scene, quick_params()).image;
  ProfileBlend other = make_blend();
  std::reverse(other.index.begin(), other.index.end());
  scene.material = Material(other);
  EXPECT_GT(largest_difference(a, render(scene, quick_params()).image), 1e-2 * largest(a));
}

TEST(Blends, AreRelitAndComparedAsTheirMaps) {
  const Material blend = make_blend(), map = make_profile_map(make_blend());
  const TableHeader header = natural_header(blend);
  const Image light = make_flat_light(FlatLight::disc, header.width, header.height, 3);
  const auto a = make_slices(blend, header), b = make_slices(map, header);
  const Image lit = relight(*b, {light}).front();
  EXPECT_LT(largest_difference(relight(*a, {light}).front(), lit), 1e-5 * largest(lit));
  TableHeader like = header;
  like.offsets = half_disc_offsets(4);  // within all supports: tables hold positive values
  const BssrdfTable table = read_table(*make_slices(map, like));
  const auto measured = make_slices(table, "t.h5");
  EXPECT_LT(compare(*measured, *make_slices(blend, like)).relative_error.max, 1e-5);
}

TEST(Blends, FilesOfBothEncodingsRenderAlike) {
  ProfileBlend blend = make_blend();
  snap_to_grid(blend, {0.004, 63});
  Scene scene = make_scene(make_sphere(3), 20, Material(blend), 20, 16);
  scene.lights = {white_environment()};
  const Image expected = render(scene, quick_params()).image;
  for (const BlendEncoding encoding : {BlendEncoding::paper, BlendEncoding::packed}) {
    scene.material = Material(decode_blend(encode_blend(blend, encoding), "b.kbm"));
    EXPECT_LT(largest_difference(render(scene, quick_params()).image, expected),
              1e-5 * largest(expected));
  }
}

}  // namespace
}  // namespace parian

#include "scene/surface_mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"
#include "base/test_errors.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

SurfacePoint at_place(Vec3 position, Vec3 normal = {0, 1, 0}) {
  SurfacePoint point;
  point.position = position;
  point.normal = normal;
  return point;
}
double eval(const MaskShape& shape, Vec3 position, Vec3 normal = {0, 1, 0}) {
  return eval_mask({{shape}}, {}, at_place(position, normal));
}
std::string error_of(const SurfaceMask& mask, const TriangleMesh& mesh = {}) {
  return parian::error_of([&] { check(mask, mesh, "s.json", "/layers/0/mask"); });
}

TEST(SurfaceMask, GradientIsSmoothBetweenItsPoints) {
  const GradientMask mask{{0, 10, 0}, {0, 30, 0}};
  EXPECT_EQ(eval(mask, {5, 9, 2}), 0);
  EXPECT_EQ(eval(mask, {5, 31, 2}), 1);
  EXPECT_NEAR(eval(mask, {-7, 20, 1}), 0.5, 1e-12);
  EXPECT_NEAR(eval(mask, {-7, 15, 1}), 3.0 / 16 - 2.0 / 64, 1e-12);
}

TEST(SurfaceMask, SphereAndSlabFallBeyondTheirEdges) {
  const SphereMask sphere{{1, 2, 3}, 5, 2};
  EXPECT_EQ(eval(sphere, {1, 6.9f, 3}), 1);
  EXPECT_NEAR(eval(sphere, {1, 8, 3}), 0.5, 1e-6);
  EXPECT_EQ(eval(sphere, {1, 9.1f, 3}), 0);
  EXPECT_EQ(eval(SphereMask{{}, 5, 0}, {5.01f, 0, 0}), 0);
  const SlabMask slab{{0, 10, 0}, {0, 1, 0}, 4, 1};
  EXPECT_EQ(eval(slab, {9, 10, 9}), 1);
  EXPECT_EQ(eval(slab, {9, 14, 9}), 1);
  EXPECT_NEAR(eval(slab, {9, 14.5f, 9}), 0.5, 1e-6);
  EXPECT_NEAR(eval(slab, {9, 9.5f, 9}), 0.5, 1e-6);
  EXPECT_EQ(eval(slab, {9, 15.1f, 9}), 0);
  EXPECT_EQ(eval(SlabMask{{0, 10, 0}, {0, 1, 0}, 0, 0}, {0, 1e6f, 0}), 1);
}

TEST(SurfaceMask, StripesRepeat) {
  const StripesMask mask{{1, 0, 0}, 10, 0.3, 1, 1};
  for (const float base : {-30.0f, 0.0f, 70.0f}) {
    EXPECT_EQ(eval(mask, {base + 2, 5, 5}), 1);
    EXPECT_EQ(eval(mask, {base + 3.9f, 5, 5}), 1);
    EXPECT_NEAR(eval(mask, {base + 4.5f, 5, 5}), 0.5, 1e-5);
    EXPECT_NEAR(eval(mask, {base + 0.5f, 5, 5}), 0.5, 1e-5);
    EXPECT_EQ(eval(mask, {base + 7, 5, 5}), 0);
  }
}

TEST(SurfaceMask, ProjectedImageIsUpright) {
  ProjectedMask mask;  // cast towards -z, seen from +z: x right, y up
  mask.image = make_image(2, 2, 1);
  at(mask.image, 0, 0, 0) = 1;  // top left
  mask.center = {0, 20, 0};
  mask.width_mm = mask.height_mm = 8;
  EXPECT_EQ(eval(mask, {-3, 23, 5}, {0, 0, 1}), 1);
  EXPECT_EQ(eval(mask, {3, 23, 5}, {0, 0, 1}), 0);
  EXPECT_EQ(eval(mask, {-3, 17, 5}, {0, 0, 1}), 0);
  EXPECT_NEAR(eval(mask, {0, 23, 5}, {0, 0, 1}), 0.5, 1e-6);
  EXPECT_EQ(eval(mask, {-3, 23, 5}, {0, 0, -1}), 0);  // looks away
  EXPECT_EQ(eval(mask, {-5, 23, 5}, {0, 0, 1}), 0);   // beside it
  mask.facing = false;
  EXPECT_EQ(eval(mask, {-3, 23, 5}, {0, 0, -1}), 1);
}

TEST(SurfaceMask, TextureRepeatsAndInterpolates) {
  TextureMask mask{make_image(4, 2, 1)};
  at(mask.image, 1, 0, 0) = 1;
  const auto eval_at = [&](float u, float v) {
    SurfacePoint point;
    point.texcoord = {u, v};
    return eval_mask({{mask}}, {}, point);
  };
  EXPECT_NEAR(eval_at(0.375f, 0.25f), 1, 1e-6);
  EXPECT_NEAR(eval_at(0.25f, 0.25f), 0.5, 1e-6);
  EXPECT_NEAR(eval_at(0.375f, 0.5f), 0.5, 1e-6);
  EXPECT_NEAR(eval_at(-2.625f, 3.25f), 1, 1e-5);
  EXPECT_NEAR(eval_at(0.375f, 0), 0.5, 1e-6);  // half of the row on the other side
}

TEST(SurfaceMask, VertexWeightsAreThoseOfTheFile) {
  TriangleMesh mesh;
  mesh.positions = {{9, 9, 9}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 0}, {4, 4, 0}};
  mesh.triangles = {{1, 2, 3}, {2, 5, 3}};
  clean_mesh(mesh, "m");  // the first and the fifth belong to no face
  ASSERT_EQ(mesh.positions.size(), 4);
  EXPECT_EQ(mesh.source, (std::vector<std::uint32_t>{1, 2, 3, 5}));
  EXPECT_EQ(mesh.source_vertices, 6);
  const SurfaceMask mask{{VertexMask{{0.9f, 0.1f, 0.5f, 1.0f, 0.9f, 0.0f}}}};
  check(mask, mesh, "s.json", "/layers/0/mask");
  Rng rng = make_rng(3);
  for (int i = 0; i < 20; ++i) {
    const auto s = static_cast<float>(sample_uniform(rng));
    const auto t = static_cast<float>(sample_uniform(rng)) * (1 - s);
    const SurfacePoint point = get_surface_point(mesh, 0, {s, t});
    EXPECT_NEAR(eval_mask(mask, mesh, point), 0.1f * (1 - s - t) + 0.5f * s + t, 1e-5f);
  }
}

TEST(SurfaceMask, NoiseIsSeededAndCoversWhatItsThresholdSays) {
  NoiseMask mask;
  mask.softness = 0;
  mask.octaves = 1;
  Rng rng = make_rng(5);
  int covered = 0, changed = 0;
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) {
    const auto draw = [&] { return static_cast<float>(200 * sample_uniform(rng) - 100); };
    const Vec3 place{draw(), draw(), draw()};
    const double weight = eval(mask, place);
    EXPECT_TRUE(weight == 0 || weight == 1);
    covered += weight == 1;
    NoiseMask other = mask;
    other.seed = 2;
    changed += eval(other, place) != weight;
  }
  EXPECT_NEAR(covered, 0.5 * count, 333);
  EXPECT_NEAR(changed, 0.5 * count, 333);
  mask.softness = 0.5;
  for (int i = 0; i < 100; ++i) {  // continuous across the lattice
    const float x = 10.0f * static_cast<float>(i - 50);
    EXPECT_NEAR(eval(mask, {x - 1e-3f, 3, 4}), eval(mask, {x + 1e-3f, 3, 4}), 2e-3);
  }
}

TEST(SurfaceMask, TermsMultiplyAndInvert) {
  const MaskTerm left{SlabMask{{0, 0, 0}, {-1, 0, 0}, 0, 0}};
  const MaskTerm half{GradientMask{{0, -1, 0}, {0, 1, 0}}};
  EXPECT_NEAR(eval_mask({left, half}, {}, at_place({-1, 0, 0})), 0.5, 1e-12);
  EXPECT_EQ(eval_mask({left, half}, {}, at_place({1, 0, 0})), 0);
  EXPECT_EQ(eval_mask({{left.shape, true}}, {}, at_place({1, 0, 0})), 1);
  EXPECT_NEAR(eval_mask({left, {half.shape, true}}, {}, at_place({-1, 0.5f, 0})),
              1 - (3 * 0.5625 - 2 * 0.421875), 1e-12);
  EXPECT_EQ(eval_mask({}, {}, at_place({})), 1);
}

TEST(SurfaceMask, ImagesAreGreyAndFinite) {
  Image image = make_image(2, 1, 3, 0.5f);
  at(image, 0, 0, 1) = 3;
  const Image mask = make_mask_image(image, "m.png");
  EXPECT_EQ(mask.channels, 1);
  EXPECT_EQ(at(mask, 0, 0, 0), 1);
  EXPECT_NEAR(at(mask, 1, 0, 0), 0.5f, 1e-6f);
  at(image, 1, 0, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(parian::error_of([&] { make_mask_image(image, "m.png"); }),
            "m.png: pixel (1, 0): expected a finite weight, found nan");
}

TEST(SurfaceMask, Errors) {
  const TriangleMesh box = make_box({2, 1, 0.5f}, 1);
  TriangleMesh plain = box;
  plain.texcoords.clear();
  SphereMask sphere;
  sphere.radius_mm = std::nan("");
  EXPECT_EQ(error_of({{sphere}}),
            "s.json: /layers/0/mask/radius_mm: expected a value in [0, 1000000], found nan");
  EXPECT_EQ(error_of({{NoiseMask{}}, {GradientMask{{1, 1, 1}, {1, 1, 1}}}}),
            "s.json: /layers/0/mask/1/to: expected another point than 'from', found the same");
  EXPECT_EQ(error_of({{SlabMask{{}, {0, 2, 0}}}}),
            "s.json: /layers/0/mask/direction: expected a unit vector, found [0, 2, 0]");
  ProjectedMask projected;
  projected.up = {0, 0, 1};
  EXPECT_EQ(error_of({{projected}}),
            "s.json: /layers/0/mask/up: expected another direction than that in which it is cast, "
            "found the same");
  EXPECT_EQ(error_of({{VertexMask{{1, 0}}}}, plain),
            "s.json: /layers/0/mask: expected 24 weights, one per vertex of the mesh, found 2");
  EXPECT_EQ(error_of({{TextureMask{make_image(1, 1, 1)}}}, plain),
            "s.json: /layers/0/mask: expected a mesh with texture coordinates, as the mask is an "
            "image on them, found none");
  EXPECT_EQ(error_of({{TextureMask{make_image(1, 1, 1)}}}, box), "no error");
}

}  // namespace
}  // namespace parian

#include "edit/recipe.h"

#include <gtest/gtest.h>

#include <numeric>

#include "base/error.h"
#include "edit/session.h"
#include "edit/test_documents_internal.h"
#include "edit/test_states_internal.h"

namespace parian {
namespace {

struct Selecting {
  EditState state = make_random_state(1, 20, 16);  // 10 x 8 mm
  SelectionCache cache;
  RecipeResources resources;

  Mask select(const Document& node) {
    return read_selection(node, resources).make({state, state, cache, {}});
  }
  std::string error_of(const Document& node) {
    try {
      select(node);
    } catch (const Error& error) {
      return error.parts.expected + " | " + error.parts.found;
    }
    return {};
  }
};

double sum(const Mask& mask) {
  return std::accumulate(mask.weight.begin(), mask.weight.end(), 0.0);
}

TEST(Selection, ShapesAreInMillimetresOrRelative) {
  Selecting s;
  const Document mm = object({{"type", "rectangle"}, {"min", point(1, 2)}, {"max", point(6, 4)}});
  const Document relative = object({{"type", "rectangle"},
                                    {"min", point(0.1, 0.25)},
                                    {"max", point(0.6, 0.5)},
                                    {"unit", "relative"}});
  EXPECT_NEAR(sum(s.select(mm)), 10 * 4, 1e-4);
  EXPECT_EQ(s.select(mm).weight, s.select(relative).weight);
}

TEST(Selection, SetsAndModifiersCombine) {
  Selecting s;
  const Document left = object({{"type", "rectangle"}, {"min", point(0, 0)}, {"max", point(5, 8)}});
  const Document top = object({{"type", "rectangle"}, {"min", point(0, 0)}, {"max", point(10, 4)}});
  const auto of = [&](const char* type) {
    return object({{"type", type}, {"of", Document::Array{left, top}}});
  };
  EXPECT_EQ(sum(s.select(of("union"))), 240);
  EXPECT_EQ(sum(s.select(of("intersection"))), 80);
  EXPECT_EQ(sum(s.select(of("difference"))), 80);
  Document inverted = of("union");
  set(inverted, "invert", true);
  EXPECT_EQ(sum(s.select(inverted)), 80);
  Document grown = left;
  set(grown, "grow", 0.5);
  EXPECT_NEAR(sum(s.select(grown)), 160 + 16, 1e-3);
  set(grown, "grow", -0.5);
  EXPECT_NEAR(sum(s.select(grown)), 160 - 16, 1e-3);
  Document soft = left;
  set(soft, "feather", 1.0);
  EXPECT_NEAR(sum(s.select(soft)), 160, 1e-2);
}

TEST(Selection, ThresholdsSeeTheMapAsItWasOrIs) {
  Selecting s;
  EditState input = s.state;
  EditReport report;
  set_range(input, range_plane(s.state), Plane(s.state.values(), 50.0), report);
  Document node = object({{"type", "threshold"}, {"property", "range"}, {"low", 40.0}});
  const auto select = [&] {
    return sum(read_selection(node, s.resources).make({s.state, input, s.cache, {}}));
  };
  EXPECT_LT(select(), 160);
  set(node, "state", "current");
  EXPECT_EQ(select(), 320);
}

TEST(Selection, SimilarPixelsAreThoseOfTheSameMaterial) {
  Selecting s;
  const EditState one = make_random_state(5, 1, 1), two = make_random_state(6, 1, 1);
  std::vector<std::uint32_t> index(320);
  ProfileMap map = make_random_map(5, 20, 16, 3);
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 7; ++k)
      for (std::size_t i = 0; i < 320; ++i)
        knot_plane(map, c, k)[i] =
            (i % 20 < 8 ? one : two).shapes->log_profile[static_cast<std::size_t>(c * 7 + k)];
  map.gain.clear();
  map.dilation.clear();
  s.state = make_edit_state(map);
  for (const char* distance : {"profile", "log_profile", "properties", "perceptual"}) {
    const Mask mask = s.select(
        object({{"type", "similar"}, {"at", point(1, 1)}, {"distance", distance}, {"sigma", 0.1}}));
    for (std::size_t i = 0; i < 320; ++i)
      EXPECT_NEAR(mask.weight[i], i % 20 < 8 ? 1 : 0, 1e-3) << distance;
  }
}

TEST(Selection, SaysWhatIsWrong) {
  Selecting s;
  EXPECT_EQ(s.error_of(object({{"type", "rectangle"}, {"min", point(3, 3)}, {"max", point(1, 5)}})),
            "a corner to the right of and below 'min' | an array of 2");
  EXPECT_EQ(s.error_of(object({{"type", "threshold"}, {"property", "albdo"}})),
            "'albedo', 'range', 'mean_radius', 'lightness', 'chroma' or 'hue_deg' | 'albdo' (did "
            "you mean 'albedo'?)");
  EXPECT_EQ(s.error_of(object({{"type", "similar"}, {"at", point(11, 3)}})),
            "a place in [0, 10] x [0, 8], the map | (11, 3)");
  EXPECT_EQ(s.error_of(object({{"type", "propagate"}, {"strokes", Document::Array{}}})),
            "at least one stroke | none");
  EXPECT_EQ(s.error_of(object({{"type", "propagate"},
                               {"strokes", Document::Array{object({{"points", points({{2, 2}})},
                                                                   {"positive", false}})}}})),
            "at least one positive stroke | none");
  EXPECT_EQ(
      s.error_of(object({{"type", "propagate"},
                         {"strokes", Document::Array{object({{"points", points({{12, 2}})}})}}})),
      "a stroke that meets the map of 10 x 8 mm | one outside");
  EXPECT_EQ(s.error_of(object({{"type", "union"}, {"of", Document::Array{}}})),
            "at least one selection | none");
  EXPECT_EQ(s.error_of(object({{"type", "all"}, {"fether", 2.0}})),
            "a known key | 'fether' (did you mean 'feather'?)");
}

TEST(Recipe, EveryOperationHasReadableDefaults) {
  for (const OperationKind& kind : operation_kinds()) {
    EXPECT_FALSE(kind.summary.empty());
    const OperationKind::Params params = kind.params();
    check(params.list);
    for (const Param& param : params.list)
      EXPECT_NE(std::find(kind.keys.begin(), kind.keys.end(), json_key(param)), kind.keys.end())
          << kind.name << " " << param.name;
  }
}

TEST(Recipe, UnchangedLayersAreRecognised) {
  RecipeResources resources;
  const auto layer = [](double scale) {
    return object({{"operation", "adjust"}, {"albedo_scale", scale}});
  };
  const Recipe first = read_recipe(recipe_of({layer(1), layer(2)}), resources);
  const Recipe second = read_recipe(recipe_of({layer(3), layer(2)}), resources, &first);
  EXPECT_NE(second.layers[0], first.layers[0]);
  EXPECT_EQ(second.layers[1], first.layers[1]);
  EXPECT_TRUE(is_same_value(write_recipe(first), recipe_of({layer(1), layer(2)})));
  EXPECT_FALSE(is_same_value(write_recipe(first), write_recipe(second)));
}

TEST(Recipe, StrokesWithParametersOfTheirOwnInterpolate) {
  Selecting s;
  const Document layer = object(
      {{"operation", "interpolate"},
       {"distance", "properties"},
       {"strokes", Document::Array{object({{"points", points({{1, 1}})}, {"albedo_scale", 2.0}}),
                                   object({{"points", points({{8, 6}})}, {"albedo_scale", 0.5}}),
                                   object({{"points", points({{5, 4}})}, {"positive", false}})}}});
  EditSession session = make_edit_session(make_random_map(1, 20, 16, 3), {});
  set_recipe(session, recipe_of({layer}));
  const EditState state = evaluate(session);
  const Plane before = albedo_plane(s.state), after = albedo_plane(state);
  const auto ratio = [&](std::size_t x, std::size_t y) {
    return after[y * 20 + x] / before[y * 20 + x];
  };
  EXPECT_NEAR(ratio(2, 2), 2, 0.05);
  EXPECT_NEAR(ratio(16, 12), 0.5, 0.05);
  EXPECT_NEAR(ratio(10, 8), 1, 0.05);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_GE(after[i] / before[i], 0.5 - 1e-6);
    EXPECT_LE(after[i] / before[i], 2 + 1e-6);
  }
}

}  // namespace
}  // namespace parian

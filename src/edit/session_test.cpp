#include "edit/session.h"

#include <gtest/gtest.h>

#include <cstring>

#include "base/test_errors.h"
#include "edit/test_documents_internal.h"
#include "edit/test_states_internal.h"

namespace parian {
namespace {

bool same_bits(const EditState& a, const EditState& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  return same(a.shapes->log_profile, b.shapes->log_profile) && same(*a.gain, *b.gain) &&
         same(*a.dilation, *b.dilation);
}

Document adjust(double scale, const char* name = "adjust") {
  return object({{"operation", "adjust"}, {"name", name}, {"albedo_scale", scale}});
}

Document shape(double falloff) {
  return object({{"operation", "shape"}, {"falloff", falloff}});
}

EditSession make_session() {
  return make_edit_session(make_random_map(1, 12, 8, 3), {});
}

TEST(Session, UndoAndRedoReturnTheSameBits) {
  EditSession session = make_session();
  EXPECT_FALSE(undo(session));
  const EditState start = evaluate(session);
  set_recipe(session, recipe_of({adjust(2)}));
  const EditState first = evaluate(session);
  set_recipe(session, recipe_of({adjust(2), shape(1.5)}));
  const EditState second = evaluate(session);
  ASSERT_TRUE(undo(session));
  EXPECT_TRUE(is_same_state(evaluate(session), first));  // not computed anew
  ASSERT_TRUE(undo(session));
  EXPECT_TRUE(same_bits(evaluate(session), start));
  EXPECT_FALSE(undo(session));
  ASSERT_TRUE(redo(session));
  ASSERT_TRUE(redo(session));
  EXPECT_FALSE(redo(session));
  EXPECT_TRUE(is_same_state(evaluate(session), second));
  session.results.clear();  // as if there had been no room for them
  EXPECT_TRUE(same_bits(evaluate(session), second));
  ASSERT_TRUE(undo(session));
  set_recipe(session, recipe_of({adjust(3)}));
  EXPECT_FALSE(redo(session));
}

TEST(Session, MergedChangesUndoAsOne) {
  EditSession session = make_session();
  set_recipe(session, recipe_of({adjust(1.5)}));
  const EditState before = evaluate(session);
  set_recipe(session, recipe_of({adjust(1.6)}));
  set_recipe(session, recipe_of({adjust(1.7)}), /*merge=*/true);
  set_recipe(session, recipe_of({adjust(1.8)}), /*merge=*/true);
  ASSERT_TRUE(undo(session));
  EXPECT_TRUE(same_bits(evaluate(session), before));
}

TEST(Session, OnlyWhatDependsOnAChangeIsComputed) {
  EditSession session = make_session();
  set_recipe(session, recipe_of({adjust(2, "a"), adjust(3, "b"), adjust(4, "c")}));
  evaluate(session);
  EXPECT_EQ(session.results.size(), 3u);
  set_recipe(session, with_layer(session, 1, adjust(5, "b")));
  evaluate(session);
  EXPECT_EQ(session.results.size(), 5u);  // b and c, not a
  set_recipe(session, without_layer(session, 2));
  evaluate(session);
  EXPECT_EQ(session.results.size(), 5u);
  set_recipe(session, with_moved_layer(session, 0, 1));
  EXPECT_EQ(session.recipe.layers[0]->name, "b");
  set_recipe(session, with_new_layer(session, 0, shape(2)));
  EXPECT_EQ(session.recipe.layers.size(), 3u);
}

TEST(Session, MasksAreMadeOnce) {
  EditSession session = make_session();
  const auto layer = [](double scale) {
    return object(
        {{"operation", "adjust"},
         {"albedo_scale", scale},
         {"selection", object({{"type", "threshold"}, {"property", "range"}, {"low", 0.1}})}});
  };
  set_recipe(session, recipe_of({shape(2), layer(1)}));
  evaluate(session);
  set_recipe(session, recipe_of({shape(3), layer(2)}));
  evaluate(session);
  EXPECT_EQ(session.selections->masks.size(), 1u);
}

TEST(Session, ResultsAreForgottenWhenThereIsNoRoom) {
  EditSession session = make_session();
  session.max_bytes = 1;
  for (int i = 1; i < 6; ++i) {
    set_recipe(session, recipe_of({shape(0.5 + 0.1 * i), adjust(2)}));
    evaluate(session);
    EXPECT_LE(session.results.size(), 2u);
  }
}

TEST(Session, LayersThatAreOffOrInvisibleDoNothing) {
  EditSession session = make_session();
  const EditState start = evaluate(session);
  Document off = adjust(2), invisible = adjust(2);
  set(off, "enabled", false);
  set(invisible, "opacity", 0.0);
  set_recipe(session, recipe_of({off, invisible}));
  EXPECT_TRUE(same_bits(evaluate(session), start));
}

TEST(Session, OpacityInterpolates) {
  EditSession session = make_session();
  Document half = adjust(3);
  set(half, "opacity", 0.5);
  set_recipe(session, recipe_of({half}));
  const EditState halfway = evaluate(session);
  set_recipe(session, recipe_of({adjust(2)}));
  EXPECT_TRUE(same_bits(evaluate(session), halfway));
}

TEST(Session, ARecipeRunTwiceGivesTheSameBits) {
  const std::vector<Document> layers{
      adjust(1.2),
      object({{"operation", "adjust"},
              {"range_scale", 0.7},
              {"selection",
               object({{"type", "propagate"},
                       {"strokes", Document::Array{object({{"points", points({{1, 1}, {2, 2}})},
                                                           {"radius", 0.6}}),
                                                   object({{"points", points({{5, 3}})},
                                                           {"positive", false},
                                                           {"radius", 0.6}})}}})}}),
      shape(1.4), object({{"operation", "rotate"}, {"degrees", 20}}),
      object({{"operation", "filter"}, {"kind", "bilateral"}, {"sigma_mm", 0.7}})};
  EditSession a = make_session(), b = make_session();
  set_recipe(a, recipe_of(layers));
  set_recipe(b, recipe_of(layers));
  EXPECT_TRUE(same_bits(evaluate(a), evaluate(b)));
  // read back from what it writes
  EditSession c = make_session();
  set_recipe(c, write_recipe(a.recipe));
  EXPECT_TRUE(same_bits(evaluate(c), evaluate(a)));
}

TEST(Session, AFailingLayerLeavesEverythingAsItWas) {
  EditSession session = make_session();
  set_recipe(session, recipe_of({adjust(2)}));
  const EditState before = evaluate(session);
  const Document outside =
      object({{"operation", "adjust"},
              {"name", "far"},
              {"selection",
               object({{"type", "ellipse"}, {"center", point(90, 90)}, {"radii", point(1, 1)}})}});
  set_recipe(session, recipe_of({adjust(2), outside}));
  EXPECT_EQ(error_of([&] { evaluate(session); }),
            "layer 2 ('far'): expected a shape that meets the map of 6 x 4 mm, found one "
            "outside");
  EXPECT_TRUE(is_same_state(evaluate(session, {}, 1), before));
  ASSERT_TRUE(undo(session));
  EXPECT_TRUE(is_same_state(evaluate(session), before));
}

TEST(Session, CancelledWorkLeavesEverythingAsItWas) {
  EditSession session = make_session();
  set_recipe(session, recipe_of({adjust(2)}));
  EXPECT_THROW(evaluate(session, {.is_cancelled = [] { return true; }}), Error);
  EXPECT_TRUE(session.results.empty());
  evaluate(session);
  EXPECT_EQ(session.results.size(), 1u);
}

}  // namespace
}  // namespace parian

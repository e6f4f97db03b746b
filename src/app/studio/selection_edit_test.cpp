#include "app/studio/selection_edit.h"

#include <gtest/gtest.h>

#include <numbers>

#include "app/studio/selection_places.h"
#include "app/studio/test_studio_internal.h"
#include "edit/recipe.h"
#include "io/image/image_file.h"

namespace parian {
namespace {

// What the editor selects of the small map, 6 x 5 mm.
struct SelectionEdit : testing::Test {
  StateFolder folder;
  EditState state = make_edit_state(make_map());
  MapSize size = size_of(state);
  RecipeLoaders loaders{.load_image = [](const std::string& path) { return load_image(path); }};
  std::unique_ptr<Editor> editor = std::make_unique<Editor>(make_map(), loaders);
  std::optional<std::string> error;

  PartStart start() {
    return {
        .state = state, .at_mm = {2.25, 1.75}, .brush_mm = 0.75, .file = folder.path + "/mask.exr"};
  }
  void SetUp() override {
    std::filesystem::create_directories(folder.path);
    Image mask = make_image(12, 10, 1);
    for (std::size_t i = 0; i < 40; ++i) mask.values[i] = 1;
    save_image(folder.path + "/mask.exr", mask);
  }
  std::vector<float> select(const Document& selection) {
    Document layer = make_adjust(2);
    set(layer, "selection", selection);
    editor->post("select",
                 editor->snapshot()->layers.empty() ? insert_layer(0, layer) : set_layer(0, layer));
    editor->wait();
    error = editor->take_error();
    if (error || editor->snapshot()->layers.empty()) return {};
    const auto mask = editor->snapshot()->layers[0].mask;
    return mask != nullptr ? mask->weight : std::vector<float>(state.pixels(), 1.0f);
  }
  static double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double most = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      most = std::max(most, static_cast<double>(std::abs(a[i] - b[i])));
    return most;
  }
};

Document make_line(const std::string& type, const std::vector<Place>& points) {
  Document part{Document::Object{}};
  set(part, "type", type);
  Document::Array array;
  for (const Place& place : points) array.emplace_back(Document::Array{place[0], place[1]});
  set(part, "points", std::move(array));
  return part;
}

std::vector<Place> make_circle(Place center, double radius, int points) {
  std::vector<Place> line;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    line.push_back({center[0] + radius * std::cos(angle), center[1] + radius * std::sin(angle)});
  }
  return line;
}

TEST_F(SelectionEdit, EveryKindBecomesEveryOther) {
  for (const SelectionKind& from : selection_kinds()) {
    Document part = make_part(from.name, start());
    set(part, "feather", 0.25);
    const std::vector<float> selected = select(part);
    EXPECT_EQ(error, std::nullopt) << from.name;
    for (const SelectionKind& to : selection_kinds()) {
      const Document changed = change_part(part, to.name, start());
      EXPECT_EQ(part_type(changed), to.name);
      select(changed);
      EXPECT_EQ(error, std::nullopt) << from.name << " to " << to.name;
      // Sets hold what was there, all others keep the modifiers.
      const bool wraps = is_set(to.name) && !is_set(from.name);
      EXPECT_EQ(find(changed, "feather") == nullptr, wraps);
      if (wraps) {
        EXPECT_LT(largest_difference(select(changed), selected), 1e-6) << from.name;
      }
    }
  }
}

TEST_F(SelectionEdit, UnitsDoNotChangeWhatIsSelected) {
  for (const SelectionKind& kind : selection_kinds()) {
    Document part = make_part(kind.name, start());
    set(part, "feather", 0.4);
    set(part, "grow", 0.5);
    const std::vector<float> before = select(part);
    convert_unit(part, true, size);
    EXPECT_TRUE(is_relative(part));
    EXPECT_LT(largest_difference(select(part), before), 1e-4) << kind.name;
    convert_unit(part, false, size);
    EXPECT_EQ(find(part, "unit"), nullptr);
    EXPECT_LT(largest_difference(select(part), before), 1e-4) << kind.name;
  }
}

TEST_F(SelectionEdit, HandlesThatStayWhereTheyAreChangeNothing) {
  for (const char* kind : {"rectangle", "ellipse", "polygon", "stroke", "gradient", "similar"})
    for (const bool relative : {false, true}) {
      Document part = make_part(kind, start());
      convert_unit(part, relative, size);
      const std::vector<float> before = select(part);
      const std::vector<Place> handles = find_handles(part, size);
      ASSERT_FALSE(handles.empty()) << kind;
      for (std::size_t i = 0; i < handles.size(); ++i) move_handle(part, i, handles[i], size);
      EXPECT_LT(largest_difference(select(part), before), 1e-4) << kind;
      for (std::size_t i = 0; i < handles.size(); ++i) {
        move_handle(part, i, {handles[i][0] + 0.5, handles[i][1] + 0.25}, size);
        const Place moved = find_handles(part, size).at(i);
        const double off =
            std::hypot(moved[0] - handles[i][0] - 0.5, moved[1] - handles[i][1] - 0.25);
        // The ellipse's second radius keeps its direction.
        EXPECT_LT(off, std::string(kind) == "ellipse" && i == 2 ? 1 : 1e-9) << kind << i;
        select(part);
        EXPECT_EQ(error, std::nullopt) << kind << i;
        part = make_part(kind, start());
        convert_unit(part, relative, size);
      }
    }
}

TEST_F(SelectionEdit, ACornerLeavesTheOppositeOne) {
  Document part = make_part("rectangle", start());
  const std::vector<Place> before = find_handles(part, size);
  move_handle(part, 0, {4.75, 4.5}, size);  // beyond it
  const std::vector<Place> after = find_handles(part, size);
  EXPECT_EQ(after[0], before[2]);
  EXPECT_EQ(after[2], (Place{4.75, 4.5}));
}

TEST_F(SelectionEdit, TheEllipseTurnsWithItsHandle) {
  Document part = make_part("ellipse", start());
  const Place center = find_handles(part, size)[0];
  move_handle(part, 1, {center[0], center[1] + 2}, size);
  EXPECT_NEAR(as_number(get(part, "rotation_deg")), 90, 1e-9);
  EXPECT_NEAR(as_numbers(get(part, "radii"))[0], 2, 1e-12);
  EXPECT_NEAR(find_handles(part, size)[1][1], center[1] + 2, 1e-9);
}

TEST_F(SelectionEdit, DrawnOutlinesSelectWhatTheyEnclose) {
  const Place center{3, 2.5};
  Document drawn = make_part("polygon", start()), ellipse = make_part("ellipse", start());
  EXPECT_TRUE(draw_part(drawn, make_circle(center, 1.75, 400), size));
  EXPECT_LT(as_array(get(drawn, "points")).size(), 60u);  // few enough for handles
  place_part(ellipse, {{{1.25, 0.75}, {4.75, 4.25}}});
  EXPECT_LT(largest_difference(select(drawn), select(ellipse)), 0.2);
  // Each way across a box, and a click that moves it.
  for (const std::vector<Place>& line :
       {std::vector<Place>{{1, 1}, {4, 3}}, {{4, 1}, {1, 3}}, {{4, 3}, {1, 1}}}) {
    Document box = make_part("rectangle", start());
    EXPECT_TRUE(draw_part(box, line, size));
    EXPECT_EQ(as_numbers(get(box, "min")), (std::vector<double>{1, 1}));
    EXPECT_EQ(as_numbers(get(box, "max")), (std::vector<double>{4, 3}));
    EXPECT_TRUE(draw_part(box, {{2, 2}}, size));
    EXPECT_EQ(as_numbers(get(box, "min")), (std::vector<double>{0.5, 1}));
    EXPECT_FALSE(draw_part(box, {{2, 2}, {4, 2}}, size));  // no area
  }
  Document square = make_line("polygon", {{1, 1}, {3, 1}, {3, 3}, {1, 3}});
  EXPECT_TRUE(draw_part(square, {{2, 0.5}}, size));  // a corner more in the upper side
  EXPECT_EQ(find_handles(square, size)[1], (Place{2, 0.5}));
  Document everything = make_part("all", start());
  EXPECT_FALSE(draw_part(everything, {{1, 1}, {2, 2}}, size));
}

TEST_F(SelectionEdit, PartsAreAddedRaisedAndRemoved) {
  Document selection = make_part("rectangle", start());
  EXPECT_EQ(add_part(selection, {}, make_part("ellipse", start())), (PartPath{1}));
  EXPECT_EQ(part_type(selection), "union");
  set_part(selection, {1}, change_part(*find_part(selection, {1}), "difference", start()));
  // Beside the chosen part: into the set that holds it.
  EXPECT_EQ(add_part(selection, {1, 0}, make_part("gradient", start())), (PartPath{1, 1}));
  EXPECT_EQ(part_type(*find_part(selection, {1, 1})), "gradient");
  EXPECT_EQ(raise_part(selection, {1, 1}), (PartPath{1, 0}));
  EXPECT_EQ(part_type(*find_part(selection, {1, 0})), "gradient");
  EXPECT_EQ(raise_part(selection, {0}), PartPath{0});
  select(selection);
  EXPECT_EQ(error, std::nullopt);
  EXPECT_EQ(find_part(selection, {1, 2}), nullptr);
  EXPECT_EQ(find_part(selection, {0, 0}), nullptr);
  EXPECT_TRUE(remove_part(selection, {1, 1}));
  EXPECT_TRUE(remove_part(selection, {1, 0}));  // with the difference, which is empty then
  EXPECT_EQ(as_array(get(selection, "of")).size(), 1u);
  EXPECT_FALSE(remove_part(selection, {0}));
}

}  // namespace
}  // namespace parian

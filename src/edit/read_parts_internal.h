// Pieces of recipes that several readers share: places and lengths, sources of profiles.
#pragma once

#include <string>
#include <vector>

#include "edit/mask_shapes.h"
#include "edit/recipe.h"

namespace parian {

inline constexpr double max_edit_length_mm = 1e6;

// Positions in mm from the map's upper left corner, or as parts of its width and height; lengths in
// mm, or as parts of its shorter side.
enum class Unit { mm, relative };
Unit read_unit(const Document& object);  // key "unit", default mm

struct Grid {
  int width = 1, height = 1;
  double pixel_pitch_mm = 1;
};
inline Grid grid_of(const EditState& state) {
  return {state.width, state.height, state.pixel_pitch_mm};
}
inline Grid grid_of(const Image& image) {
  return {image.width, image.height, 1};
}
Point2 to_pixels(Point2 place, Unit unit, const Grid& grid);
double length_to_pixels(double length, Unit unit, const Grid& grid);
// The pixel at a place; an Error at `node` where that is outside the grid.
std::uint32_t pixel_at(Point2 place, Unit unit, const Grid& grid, const Document& node);

// [x, y]
Point2 read_point(const Document& node);
std::vector<Point2> read_points(const Document& node, std::size_t least);
double read_length(const Document& node, double min);  // finite

// One of these strings, or an Error naming the nearest.
std::size_t read_choice(const Document& node, const std::vector<std::string>& names);

// Plain numbers of an object whose other keys are read, or checked, elsewhere.
void read_numbers(const Document& object, const ParamList& params);
// The names of false and true.
ChoiceTarget make_choice_of_two(bool& field, std::vector<std::string> names);
// "state": the map as it was when it got its grid, or as it is before the layer.
Param describe_state(bool& current);

// "from": {"map": FILE, "at": [x, y], "unit": ...}: a profile of another map, or without "map" of
// the edited map as it was when it got its grid. Without "at" the whole map, pixel by pixel.
struct ProfileSource {
  Document node;
  std::shared_ptr<const EditState> map;  // null: the edited map's frame
  bool has_place = false;
  Point2 place;
  Unit unit = Unit::mm;
};
ProfileSource read_profile_source(const Document& node, RecipeResources& resources);
// The map's state, or the frame; as many channels as the frame or 1, on the frame's knots.
EditState get_source_map(const ProfileSource& source, const EditState& frame);
// Its pixel at the place as a map of one pixel.
EditState get_source_profile(const ProfileSource& source, const EditState& frame);

// keys of the object beyond `own` are errors.
void check_layer_keys(const Document& layer, const std::vector<std::string>& own);
// Plain numbers of a layer; `own` are keys that the caller reads itself.
void read_layer_params(const Document& layer, const ParamList& params,
                       const std::vector<std::string>& own = {});
std::vector<std::string> keys_of(const ParamList& params, std::vector<std::string> own = {});

}  // namespace parian

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/names.h"
#include "edit/blend.h"
#include "edit/geometry.h"
#include "edit/read_parts_internal.h"

namespace parian {

Unit read_unit(const Document& object) {
  const Document* node = find(object, "unit");
  return node == nullptr || read_choice(*node, {"mm", "relative"}) == 0 ? Unit::mm : Unit::relative;
}

Point2 to_pixels(Point2 place, Unit unit, const Grid& grid) {
  if (unit == Unit::relative) return {place.x * grid.width, place.y * grid.height};
  return {place.x / grid.pixel_pitch_mm, place.y / grid.pixel_pitch_mm};
}

double length_to_pixels(double length, Unit unit, const Grid& grid) {
  if (unit == Unit::relative) return length * std::min(grid.width, grid.height);
  return length / grid.pixel_pitch_mm;
}

std::uint32_t pixel_at(Point2 place, Unit unit, const Grid& grid, const Document& node) {
  const Point2 pixel = to_pixels(place, unit, grid);
  if (!(pixel.x >= 0 && pixel.x < grid.width && pixel.y >= 0 && pixel.y < grid.height)) {
    const double width = unit == Unit::mm ? grid.width * grid.pixel_pitch_mm : 1;
    const double height = unit == Unit::mm ? grid.height * grid.pixel_pitch_mm : 1;
    throw_at(node, fmt::format("a place in [0, {:.6g}] x [0, {:.6g}], the map", width, height),
             fmt::format("({:.6g}, {:.6g})", place.x, place.y));
  }
  return static_cast<std::uint32_t>(static_cast<int>(pixel.y) * grid.width +
                                    static_cast<int>(pixel.x));
}

Point2 read_point(const Document& node) {
  if (as_array(node).size() != 2) throw_at(node, "a place [x, y]");
  return {as_number(as_array(node)[0], -max_edit_length_mm, max_edit_length_mm),
          as_number(as_array(node)[1], -max_edit_length_mm, max_edit_length_mm)};
}

std::vector<Point2> read_points(const Document& node, std::size_t least) {
  constexpr std::size_t most = 20'000;
  const Document::Array& array = as_array(node);
  if (array.size() < least || array.size() > most)
    throw_at(node, fmt::format("an array of {} to {} places [x, y]", least, most));
  std::vector<Point2> points;
  points.reserve(array.size());
  for (const Document& point : array) points.push_back(read_point(point));
  return points;
}

double read_length(const Document& node, double min) {
  return as_number(node, min, max_edit_length_mm);
}

std::size_t read_choice(const Document& node, const std::vector<std::string>& names) {
  const std::string& name = as_string(node);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return i;
  const std::string nearest = nearest_name(name, names);
  throw_at(
      node, list_names(names),
      nearest.empty() ? "'" + name + "'" : fmt::format("'{}' (did you mean '{}'?)", name, nearest));
}

void read_numbers(const Document& object, const ParamList& params) {
  std::vector<std::string> keys;
  keys.reserve(as_object(object).size());
  for (const auto& [key, member] : as_object(object)) keys.push_back(key);
  for (const Param& param : params) {
    const auto* choice = std::get_if<ChoiceTarget>(&param.target);
    const Document* node = choice != nullptr ? find(object, json_key(param)) : nullptr;
    if (node != nullptr) choice->set(static_cast<int>(read_choice(*node, choice->names)));
  }
  read_params(object, params, keys);
}

ChoiceTarget make_choice_of_two(bool& field, std::vector<std::string> names) {
  return {std::move(names), [&field] { return field ? 1 : 0; },
          [&field](int value) { field = value == 1; }};
}

Param describe_state(bool& current) {
  return {.name = "state",
          .help =
              "the map that is looked at: as it was when it got its grid, or as it is before "
              "the layer",
          .target = make_choice_of_two(current, {"original", "current"})};
}

ProfileSource read_profile_source(const Document& node, RecipeResources& resources) {
  check_keys(node, {"map", "at", "unit"});
  ProfileSource source;
  source.node = node;
  source.unit = read_unit(node);
  if (const Document* map = find(node, "map")) source.map = get_map(resources, *map);
  if (const Document* at = find(node, "at")) {
    source.place = read_point(*at);
    source.has_place = true;
  }
  if (!source.map && !source.has_place) throw_at(node, "the key 'map', 'at' or both", "neither");
  return source;
}

EditState get_source_map(const ProfileSource& source, const EditState& frame) {
  const EditState& map = source.map ? *source.map : frame;
  if (map.channels != frame.channels && map.channels != 1)
    throw_at(source.node, fmt::format("a map with {} channels, or 1", frame.channels),
             fmt::format("{}", map.channels));
  // eta may differ: it is the edited map's from then on.
  const auto name_of = [](const EditState& state) {
    return state.boundary == Boundary::included ? "included" : "excluded";
  };
  if (map.boundary != frame.boundary)
    throw_at(source.node, fmt::format("a map with boundary '{}'", name_of(frame)),
             fmt::format("'{}'", name_of(map)));
  return match_knots(map, frame.knots_mm);
}

EditState get_source_profile(const ProfileSource& source, const EditState& frame) {
  const EditState& map = source.map ? *source.map : frame;
  const std::uint32_t pixel =
      pixel_at(source.place, source.unit, grid_of(map), get(source.node, "at"));
  ProfileSource single = source;
  single.map = std::make_shared<const EditState>(gather_pixels(map, {pixel}, 1, 1));
  return get_source_map(single, frame);
}

std::vector<std::string> keys_of(const ParamList& params, std::vector<std::string> own) {
  for (const Param& param : params) own.push_back(json_key(param));
  return own;
}

void check_layer_keys(const Document& layer, const std::vector<std::string>& own) {
  std::vector<std::string> known = layer_keys();
  known.insert(known.end(), own.begin(), own.end());
  check_keys(layer, known);
}

void read_layer_params(const Document& layer, const ParamList& params,
                       const std::vector<std::string>& own) {
  std::vector<std::string> known = layer_keys();
  known.insert(known.end(), own.begin(), own.end());
  read_params(layer, params, known);
}

}  // namespace parian

#include "app/studio/selection_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "app/studio/selection_edit.h"

namespace parian {
namespace {

constexpr std::size_t max_handles = 64;

Document to_point(Place place) {
  return Document::Array{place[0], place[1]};
}

Document to_points(const std::vector<Place>& places) {
  Document::Array array;
  array.reserve(places.size());
  for (const Place& place : places) array.push_back(to_point(place));
  return array;
}

// Documents of a recipe have been checked.
Place get_place(const Document& part, const char* key) {
  const std::vector<double> numbers = as_numbers(get(part, key));
  return {numbers.at(0), numbers.at(1)};
}

std::vector<Place> get_places(const Document& part) {
  std::vector<Place> places;
  for (const Document& point : as_array(get(part, "points"))) {
    const std::vector<double> numbers = as_numbers(point);
    places.push_back({numbers.at(0), numbers.at(1)});
  }
  return places;
}

PlaceBox box_of(const std::vector<Place>& places) {
  PlaceBox box{places.front(), places.front()};
  for (const Place& place : places)
    for (std::size_t i = 0; i < 2; ++i) {
      box[0][i] = std::min(box[0][i], place[i]);
      box[1][i] = std::max(box[1][i], place[i]);
    }
  return box;
}

double get_rotation(const Document& part) {
  const Document* rotation = find(part, "rotation_deg");
  return rotation != nullptr ? as_number(*rotation) * std::numbers::pi / 180 : 0;
}

// A point of the ellipse's own axes, in units of its radii.
Place on_ellipse(const Document& part, double u, double v) {
  const Place center = get_place(part, "center"), radii = get_place(part, "radii");
  const double c = std::cos(get_rotation(part)), s = std::sin(get_rotation(part));
  return {center[0] + c * u * radii[0] - s * v * radii[1],
          center[1] + s * u * radii[0] + c * v * radii[1]};
}

double distance(const Place& a, const Place& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

// Distance from a line segment.
double distance(const Place& p, const Place& a, const Place& b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
  const double t =
      square > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0.0, 1.0) : 0;
  return distance(p, {a[0] + t * dx, a[1] + t * dy});
}

// Leaves points out as long as the line stays within `most` (Douglas and Peucker 1973).
void simplify(const std::vector<Place>& line, std::size_t first, std::size_t last, double most,
              std::vector<Place>& kept) {
  double largest = most;
  std::size_t farthest = first;
  for (std::size_t i = first + 1; i < last; ++i)
    if (const double d = distance(line[i], line[first], line[last]); d > largest) {
      largest = d;
      farthest = i;
    }
  if (farthest != first) {
    simplify(line, first, farthest, most, kept);
    simplify(line, farthest, last, most, kept);
  } else {
    kept.push_back(line[last]);
  }
}

// A corner more where the outline is nearest.
void insert_corner(std::vector<Place>& places, const Place& at) {
  std::size_t best = 0;
  double nearest = distance(at, places.back(), places.front());
  for (std::size_t i = 1; i < places.size(); ++i)
    if (const double d = distance(at, places[i - 1], places[i]); d < nearest) {
      nearest = d;
      best = i;
    }
  places.insert(places.begin() + static_cast<std::ptrdiff_t>(best), at);
}

void move_by(Document& part, const char* key, double dx, double dy) {
  const Place at = get_place(part, key);
  set(part, key, to_point({at[0] + dx, at[1] + dy}));
}

bool draw_outline_into(Document& part, const std::vector<Place>& line, double most) {
  std::vector<Place> kept{line.front()};
  if (line.size() > 1) simplify(line, 0, line.size() - 1, most, kept);
  if (part_type(part) == "stroke") {
    set(part, "points", to_points(kept));
    return true;
  }
  if (kept.size() < 3) {  // a click
    if (find(part, "points") == nullptr) return false;
    kept = get_places(part);
    insert_corner(kept, line.back());
  }
  set(part, "points", to_points(kept));
  return true;
}

// A click moves the shape there.
void move_shape(Document& part, const Place& to) {
  const PlaceBox box = *find_box(part);
  const double dx = to[0] - 0.5 * (box[0][0] + box[1][0]),
               dy = to[1] - 0.5 * (box[0][1] + box[1][1]);
  for (const char* key : {"min", "max", "center"})
    if (find(part, key) != nullptr) move_by(part, key, dx, dy);
}

bool draw_box_into(Document& part, const std::vector<Place>& line, double least) {
  const PlaceBox box = box_of({line.front(), line.back()});
  if (box[1][0] - box[0][0] < least || box[1][1] - box[0][1] < least) {
    if (distance(line.front(), line.back()) >= least) return false;
    move_shape(part, line.back());
  } else {
    place_part(part, box);
  }
  return true;
}

void move_corner(Document& part, std::size_t handle, const Place& to) {
  const PlaceBox box{get_place(part, "min"), get_place(part, "max")};
  if (handle == 4) return move_shape(part, to);
  // The opposite corner stays: 0 least, 1 right above, 2 largest, 3 left below.
  const Place other{handle == 0 || handle == 3 ? box[1][0] : box[0][0],
                    handle < 2 ? box[1][1] : box[0][1]};
  if (to[0] == other[0] || to[1] == other[1]) return;
  place_part(part, box_of({to, other}));
}

void move_ellipse(Document& part, std::size_t handle, const Place& to) {
  if (handle == 0) return set(part, "center", to_point(to));
  Place radii = get_place(part, "radii");
  const Place center = get_place(part, "center");
  const double radius = distance(to, center);
  if (!(radius > 1e-6)) return;
  radii[handle - 1] = radius;
  set(part, "radii", to_point(radii));
  if (handle != 1) return;
  const double degrees = std::atan2(to[1] - center[1], to[0] - center[0]) * 180 / std::numbers::pi;
  const bool turns = find(part, "rotation_deg") != nullptr || std::abs(degrees) > 3;
  if (turns) set(part, "rotation_deg", degrees);
}

}  // namespace

MapSize size_of(const EditState& state) {
  return {state.width * state.pixel_pitch_mm, state.height * state.pixel_pitch_mm};
}

std::optional<PlaceBox> find_box(const Document& part) {
  const std::string type = part_type(part);
  if (type == "rectangle") return PlaceBox{get_place(part, "min"), get_place(part, "max")};
  if (type == "polygon" || type == "stroke") return box_of(get_places(part));
  if (type == "gradient") return box_of({get_place(part, "from"), get_place(part, "to")});
  if (type != "ellipse") return std::nullopt;
  const Place center = get_place(part, "center"), radii = get_place(part, "radii");
  return PlaceBox{
      {{center[0] - radii[0], center[1] - radii[1]}, {center[0] + radii[0], center[1] + radii[1]}}};
}

void place_part(Document& part, const PlaceBox& box) {
  const std::string type = part_type(part);
  const auto& [low, high] = box;
  const Place middle{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
  const Place half{std::max(0.5 * (high[0] - low[0]), 1e-6),
                   std::max(0.5 * (high[1] - low[1]), 1e-6)};
  if (type == "rectangle") {
    set(part, "min", to_point({middle[0] - half[0], middle[1] - half[1]}));
    set(part, "max", to_point({middle[0] + half[0], middle[1] + half[1]}));
  } else if (type == "ellipse") {
    set(part, "center", to_point(middle));
    set(part, "radii", to_point(half));
  } else if (type == "polygon") {
    set(part, "points", to_points({low, {high[0], low[1]}, high, {low[0], high[1]}}));
  } else if (type == "stroke") {
    set(part, "points", to_points({{low[0], middle[1]}, {high[0], middle[1]}}));
  } else if (type == "gradient") {
    set(part, "from", to_point({middle[0] - half[0], middle[1]}));
    set(part, "to", to_point({middle[0] + half[0], middle[1]}));
  }
}

bool is_relative(const Document& part) {
  const Document* unit = find(part, "unit");
  const auto* text = unit != nullptr ? std::get_if<std::string>(&unit->value) : nullptr;
  return text != nullptr && *text == "relative";
}

void convert_unit(Document& part, bool relative, const MapSize& size) {
  if (is_relative(part) == relative) return;
  const auto factor = [&](double length) { return relative ? 1 / length : length; };
  const double fx = factor(size.width_mm), fy = factor(size.height_mm),
               fl = factor(std::min(size.width_mm, size.height_mm));
  for (const char* key : {"min", "max", "center", "radii", "from", "to", "at"})
    if (find(part, key) != nullptr) {
      const Place at = get_place(part, key);
      set(part, key, to_point({fx * at[0], fy * at[1]}));
    }
  if (find(part, "points") != nullptr) {
    std::vector<Place> places = get_places(part);
    for (Place& place : places) place = {fx * place[0], fy * place[1]};
    set(part, "points", to_points(places));
  }
  for (const char* key : {"radius", "grow", "feather"})
    if (const Document* length = find(part, key)) set(part, key, fl * as_number(*length));
  if (relative)
    set(part, "unit", "relative");
  else
    remove_key(part, "unit");
}

bool draw_part(Document& part, const std::vector<Place>& line, const MapSize& size) {
  if (line.empty()) return false;
  const bool relative = is_relative(part);
  convert_unit(part, false, size);
  const std::string type = part_type(part);
  const double least = 0.005 * std::min(size.width_mm, size.height_mm);
  bool draws = true;
  if (type == "rectangle" || type == "ellipse") {
    draws = draw_box_into(part, line, least);
  } else if (type == "polygon" || type == "stroke") {
    draws = draw_outline_into(part, line, least);
  } else if (type == "gradient") {
    draws = distance(line.front(), line.back()) >= least;
    if (draws) set(part, "from", to_point(line.front()));
    if (draws) set(part, "to", to_point(line.back()));
  } else if (type == "similar") {
    set(part, "at", to_point(line.back()));
  } else {
    draws = false;
  }
  convert_unit(part, relative, size);
  return draws;
}

std::vector<Place> find_handles(const Document& original, const MapSize& size) {
  Document part = original;
  convert_unit(part, false, size);
  const std::string type = part_type(part);
  if (type == "rectangle") {
    const Place low = get_place(part, "min"), high = get_place(part, "max");
    return {low,
            {high[0], low[1]},
            high,
            {low[0], high[1]},
            {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])}};
  }
  if (type == "ellipse")
    return {get_place(part, "center"), on_ellipse(part, 1, 0), on_ellipse(part, 0, 1)};
  if (type == "gradient") return {get_place(part, "from"), get_place(part, "to")};
  if (type == "similar") return {get_place(part, "at")};
  if (type != "polygon" && type != "stroke") return {};
  std::vector<Place> places = get_places(part);
  if (places.size() > max_handles) places.clear();
  return places;
}

void move_handle(Document& part, std::size_t handle, Place to, const MapSize& size) {
  if (handle >= find_handles(part, size).size()) return;
  const bool relative = is_relative(part);
  convert_unit(part, false, size);
  const std::string type = part_type(part);
  if (type == "rectangle") {
    move_corner(part, handle, to);
  } else if (type == "ellipse") {
    move_ellipse(part, handle, to);
  } else if (type == "gradient") {
    const Place other = get_place(part, handle == 0 ? "to" : "from");
    if (distance(to, other) > 0) set(part, handle == 0 ? "from" : "to", to_point(to));
  } else if (type == "similar") {
    set(part, "at", to_point(to));
  } else {
    std::vector<Place> places = get_places(part);
    places[handle] = to;
    set(part, "points", to_points(places));
  }
  convert_unit(part, relative, size);
}

PartOutline find_outline(const Document& original, const MapSize& size) {
  Document part = original;
  convert_unit(part, false, size);
  const std::string type = part_type(part);
  std::vector<Place> points;
  if (type == "rectangle") {
    points = find_handles(part, size);
    points.pop_back();
  } else if (type == "ellipse") {
    constexpr int corners = 64;
    for (int i = 0; i < corners; ++i)
      points.push_back(on_ellipse(part, std::cos(2 * std::numbers::pi * i / corners),
                                  std::sin(2 * std::numbers::pi * i / corners)));
  } else if (type == "polygon" || type == "stroke") {
    points = get_places(part);
  } else if (type == "gradient") {
    points = {get_place(part, "from"), get_place(part, "to")};
  } else if (type == "similar") {
    points = {get_place(part, "at")};
  }
  return {points, type == "rectangle" || type == "ellipse" || type == "polygon"};
}

}  // namespace parian

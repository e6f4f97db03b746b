// Selections in recipes: shapes, images, thresholds, similarity, propagated strokes, and sets of
// them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "edit/propagation_source_internal.h"
#include "edit/read_parts_internal.h"
#include "edit/selection_cache.h"
#include "edit/session.h"
#include "image/color_spaces.h"

namespace parian {
namespace {

using Make = std::function<Mask(const SelectionContext&)>;

struct Read {
  Make make;
  bool uses_input = false;
};

Mask empty_mask(const SelectionContext& context) {
  return make_mask(context.frame.width, context.frame.height, 0);
}

// A shape drawn in pixels; an Error where it misses the map.
template <typename Draw>
Read make_shape(const Document& node, const Draw& draw) {
  return {[node, draw](const SelectionContext& context) {
            Mask mask = empty_mask(context);
            const Grid grid = grid_of(context.frame);
            draw(mask, grid);
            if (is_empty(mask))
              throw_at(
                  node,
                  fmt::format("a shape that meets the map of {:.6g} x {:.6g} mm",
                              grid.width * grid.pixel_pitch_mm, grid.height * grid.pixel_pitch_mm),
                  "one outside");
            return mask;
          },
          false};
}

Read read_all(const Document&, RecipeResources&) {
  return {[](const SelectionContext& context) {
    return make_mask(context.frame.width, context.frame.height, 1);
  }};
}

Read read_rectangle(const Document& node, RecipeResources&) {
  const Unit unit = read_unit(node);
  const Point2 min = read_point(get(node, "min")), max = read_point(get(node, "max"));
  if (!(min.x < max.x && min.y < max.y))
    throw_at(get(node, "max"), "a corner to the right of and below 'min'");
  return make_shape(node, [=](Mask& mask, const Grid& grid) {
    draw_rectangle(mask, to_pixels(min, unit, grid), to_pixels(max, unit, grid));
  });
}

Read read_ellipse(const Document& node, RecipeResources&) {
  const Unit unit = read_unit(node);
  const Point2 center = read_point(get(node, "center")), radii = read_point(get(node, "radii"));
  if (!(radii.x > 0 && radii.y > 0)) throw_at(get(node, "radii"), "two radii > 0");
  const Document* rotation = find(node, "rotation_deg");
  const double degrees = rotation == nullptr ? 0 : as_number(*rotation, -360, 360);
  return make_shape(node, [=](Mask& mask, const Grid& grid) {
    draw_ellipse(mask, to_pixels(center, unit, grid), to_pixels(radii, unit, grid), degrees);
  });
}

std::vector<Point2> all_to_pixels(std::vector<Point2> points, Unit unit, const Grid& grid) {
  for (Point2& point : points) point = to_pixels(point, unit, grid);
  return points;
}

Read read_polygon(const Document& node, RecipeResources&) {
  const Unit unit = read_unit(node);
  const std::vector<Point2> points = read_points(get(node, "points"), 3);
  return make_shape(node, [=](Mask& mask, const Grid& grid) {
    draw_polygon(mask, all_to_pixels(points, unit, grid));
  });
}

Read read_stroke(const Document& node, RecipeResources&) {
  const Unit unit = read_unit(node);
  const std::vector<Point2> points = read_points(get(node, "points"), 1);
  const double radius = read_length(get(node, "radius"), 1e-6);
  const Document* given = find(node, "hardness");
  const double hardness = given == nullptr ? 0.5 : as_number(*given, 0, 1);
  return make_shape(node, [=](Mask& mask, const Grid& grid) {
    draw_stroke(mask, all_to_pixels(points, unit, grid), length_to_pixels(radius, unit, grid),
                hardness);
  });
}

Read read_gradient(const Document& node, RecipeResources&) {
  const Unit unit = read_unit(node);
  const Point2 from = read_point(get(node, "from")), to = read_point(get(node, "to"));
  if (from.x == to.x && from.y == to.y) throw_at(get(node, "to"), "a place other than 'from'");
  return make_shape(node, [=](Mask& mask, const Grid& grid) {
    draw_gradient(mask, to_pixels(from, unit, grid), to_pixels(to, unit, grid));
  });
}

Read read_image(const Document& node, RecipeResources& resources) {
  const Document file = get(node, "file");
  const std::shared_ptr<const Image> image = get_image(resources, file);
  return {[file, image](const SelectionContext& context) {
    try {
      return make_mask(*image, context.frame.width, context.frame.height);
    } catch (const Error& error) {
      throw_at(file, error.parts.expected,
               error.parts.place.empty() ? error.parts.found
                                         : error.parts.found + " at " + error.parts.place);
    }
  }};
}

const std::vector<std::string> property_names{"albedo",    "range",  "mean_radius",
                                              "lightness", "chroma", "hue_deg"};

// The mean over channels for albedo and lengths; OKLCh of the albedo for the others.
Plane make_property(const EditState& state, std::size_t property, int channel) {
  const std::size_t pixels = state.pixels();
  Plane values(pixels, 0.0);
  if (property >= 3) {
    const Plane albedo = albedo_plane(state);
    for (std::size_t i = 0; i < pixels; ++i) {
      Color rgb;
      for (std::size_t c = 0; c < 3; ++c)
        rgb[c] = albedo[(state.channels == 3 ? c : 0) * pixels + i];
      const Color lch = oklab_to_oklch(linear_to_oklab(rgb));
      const double degrees = lch[2] * 180 / std::numbers::pi;
      values[i] = property == 3 ? lch[0] : property == 4 ? lch[1] : std::fmod(degrees + 360, 360.0);
    }
    return values;
  }
  const Plane plane = property == 0   ? albedo_plane(state)
                      : property == 1 ? range_plane(state)
                                      : mean_radius_plane(state);
  const int first = channel < 0 ? 0 : channel, end = channel < 0 ? state.channels : channel + 1;
  for (int c = first; c < end; ++c)
    for (std::size_t i = 0; i < pixels; ++i)
      values[i] += plane[static_cast<std::size_t>(c) * pixels + i] / (end - first);
  return values;
}

Read read_threshold(const Document& node, RecipeResources&) {
  const std::size_t property = read_choice(get(node, "property"), property_names);
  const auto number = [&](const char* key, double otherwise) {
    const Document* member = find(node, key);
    return member == nullptr ? otherwise : as_number(*member, -1e9, 1e9);
  };
  const double low = number("low", -1e9), high = number("high", 1e9),
               softness = number("softness", 0);
  if (find(node, "low") == nullptr && find(node, "high") == nullptr)
    throw_at(node, "the key 'low', 'high' or both", "neither");
  if (!(low <= high)) throw_at(get(node, "high"), "a number >= 'low'");
  if (!(softness >= 0)) throw_at(get(node, "softness"), "a number >= 0");
  const Document* given = find(node, "channel");
  const int channel = given == nullptr ? -1 : as_int(*given, 0, 2);
  const Document* state = find(node, "state");
  const bool current = state != nullptr && read_choice(*state, {"original", "current"}) == 1;
  return {[=](const SelectionContext& context) {
            const EditState& from = current ? context.input : context.frame;
            if (channel >= from.channels)
              throw_at(node, fmt::format("a channel below {}", from.channels),
                       fmt::format("{}", channel));
            return threshold(make_property(from, property, channel).data(), from.width, from.height,
                             low, high, softness);
          },
          current};
}

Read read_similar(const Document& node, RecipeResources& resources) {
  const PropagationSource source = read_appearance(node, resources);
  const Unit unit = read_unit(node);
  const Point2 at = read_point(get(node, "at"));
  const Document* given = find(node, "sigma");
  const double sigma = given == nullptr ? 0.2 : as_number(*given, 1e-6, 1e6);
  return {[=, place = get(node, "at")](const SelectionContext& context) {
            const std::uint32_t picked = pixel_at(at, unit, grid_of(context.frame), place);
            const Appearance appearance = get_appearance(source, context, false);
            Mask mask = empty_mask(context);
            for (std::size_t i = 0; i < mask.weight.size(); ++i)
              mask.weight[i] = static_cast<float>(
                  std::exp(-feature_distance_squared(*appearance.features, i, picked) / sigma));
            return mask;
          },
          source.uses_input};
}

Read read_propagate(const Document& node, RecipeResources& resources) {
  const PropagationSource source =
      read_propagation(node, get(node, "strokes"), resources,
                       [](const Document& stroke) { check_keys(stroke, stroke_keys()); });
  if (std::none_of(source.strokes.begin(), source.strokes.end(),
                   [](const Stroke& stroke) { return stroke.positive; }))
    throw_at(get(node, "strokes"), "at least one positive stroke", "none");
  return {[source](const SelectionContext& context) { return propagate_strokes(source, context); },
          source.uses_input};
}

template <Mask combine(const Mask&, const Mask&)>
Read read_set(const Document& node, RecipeResources& resources) {
  std::vector<Selection> operands;
  const Document& of = get(node, "of");
  if (as_array(of).empty()) throw_at(of, "at least one selection", "none");
  bool uses_input = false;
  for (const Document& operand : as_array(of)) {
    operands.push_back(read_selection(operand, resources));
    uses_input = uses_input || operands.back().uses_input;
  }
  return {[operands](const SelectionContext& context) {
            Mask mask = operands[0].make(context);
            for (std::size_t i = 1; i < operands.size(); ++i)
              mask = combine(mask, operands[i].make(context));
            return mask;
          },
          uses_input};
}

struct SelectionKind {
  std::string name;
  std::vector<std::string> keys;
  Read (*read)(const Document&, RecipeResources&);
};

const std::vector<SelectionKind>& selection_kinds() {
  static const std::vector<SelectionKind> kinds{
      {"all", {}, read_all},
      {"rectangle", {"min", "max", "unit"}, read_rectangle},
      {"ellipse", {"center", "radii", "rotation_deg", "unit"}, read_ellipse},
      {"polygon", {"points", "unit"}, read_polygon},
      {"stroke", {"points", "radius", "hardness", "unit"}, read_stroke},
      {"gradient", {"from", "to", "unit"}, read_gradient},
      {"image", {"file"}, read_image},
      {"threshold", {"property", "channel", "low", "high", "softness", "state"}, read_threshold},
      {"similar", appearance_keys({"at", "unit", "sigma"}), read_similar},
      {"propagate", propagation_keys({"strokes"}), read_propagate},
      {"union", {"of"}, read_set<unite>},
      {"intersection", {"of"}, read_set<intersect>},
      {"difference", {"of"}, read_set<subtract>},
  };
  return kinds;
}

// Applied in this order.
struct Modifiers {
  double grow = 0, feather = 0;
  Unit unit = Unit::mm;
  bool invert = false;
};

Mask modify(Mask mask, const Modifiers& modifiers, const Grid& grid) {
  if (modifiers.grow != 0)
    mask = grow(mask, length_to_pixels(modifiers.grow, modifiers.unit, grid));
  if (modifiers.feather > 0)
    mask = feather(mask, length_to_pixels(modifiers.feather, modifiers.unit, grid));
  return modifiers.invert ? invert(std::move(mask)) : mask;
}

// The mask made once for as long as the map stays the same.
Make remember(const Document& source, const Make& make, bool uses_input) {
  constexpr std::size_t most = 64;
  return [=](const SelectionContext& context) {
    auto& known = context.cache.masks;
    for (const SelectionCache::KnownMask& item : known)
      if (is_same_state(item.frame, context.frame) &&
          (!item.uses_input || is_same_state(item.input, context.input)) &&
          is_same_value(item.source, source))
        return *item.mask;
    auto mask = std::make_shared<const Mask>(make(context));
    if (known.size() >= most) known.erase(known.begin());
    known.push_back({source, context.frame, context.input, uses_input, mask});
    return *mask;
  };
}

}  // namespace

Selection make_whole_selection() {
  return {.make = [](const SelectionContext& context) {
    return make_mask(context.frame.width, context.frame.height, 1);
  }};
}

std::vector<std::pair<std::string, std::vector<std::string>>> selection_keys() {
  std::vector<std::pair<std::string, std::vector<std::string>>> keys;
  keys.reserve(selection_kinds().size());
  for (const SelectionKind& kind : selection_kinds()) keys.emplace_back(kind.name, kind.keys);
  return keys;
}

Selection read_selection(const Document& node, RecipeResources& resources) {
  std::vector<std::string> names;
  names.reserve(selection_kinds().size());
  for (const SelectionKind& kind : selection_kinds()) names.push_back(kind.name);
  as_object(node);
  const SelectionKind& kind = selection_kinds()[read_choice(get(node, "type"), names)];
  std::vector<std::string> known = kind.keys;
  for (const char* key : {"type", "grow", "feather", "invert", "unit"}) known.emplace_back(key);
  check_keys(node, known);
  Modifiers modifiers;
  modifiers.unit = read_unit(node);
  if (const Document* member = find(node, "grow"))
    modifiers.grow = read_length(*member, -max_edit_length_mm);
  if (const Document* member = find(node, "feather")) modifiers.feather = read_length(*member, 0);
  if (const Document* member = find(node, "invert")) modifiers.invert = as_bool(*member);
  const Read read = kind.read(node, resources);
  const Make make = [read, modifiers](const SelectionContext& context) {
    return modify(read.make(context), modifiers, grid_of(context.frame));
  };
  return {node, read.uses_input, remember(node, make, read.uses_input)};
}

}  // namespace parian

// Selections in recipes: shapes, images, thresholds, similarity, propagated strokes, and sets of
// them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/propagation_source_internal.h"
#include "edit/read_parts_internal.h"
#include "edit/selection_cache.h"
#include "edit/selection_kinds_internal.h"
#include "edit/session.h"

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
  EllipseNumbers numbers;
  read_numbers(node, describe(numbers));
  return make_shape(node, [=](Mask& mask, const Grid& grid) {
    draw_ellipse(mask, to_pixels(center, unit, grid), to_pixels(radii, unit, grid),
                 numbers.rotation_deg);
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
  get(node, "radius");
  BrushNumbers brush;
  read_numbers(node, describe(brush));
  return make_shape(node, [=](Mask& mask, const Grid& grid) {
    draw_stroke(mask, all_to_pixels(points, unit, grid), length_to_pixels(brush.radius, unit, grid),
                brush.hardness);
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

Read read_threshold(const Document& node, RecipeResources&) {
  get(node, "property");
  ThresholdNumbers numbers;
  read_numbers(node, describe(numbers));
  if (find(node, "low") == nullptr && find(node, "high") == nullptr)
    throw_at(node, "the key 'low', 'high' or both", "neither");
  if (!(numbers.low <= numbers.high)) throw_at(get(node, "high"), "a number >= 'low'");
  const Document* given = find(node, "channel");
  const int channel = given == nullptr ? -1 : as_int(*given, 0, 2);
  return {[=](const SelectionContext& context) {
            const EditState& from = numbers.current ? context.input : context.frame;
            if (channel >= from.channels)
              throw_at(node, fmt::format("a channel below {}", from.channels),
                       fmt::format("{}", channel));
            const Plane values = eval_selection_property(from, numbers.property, channel);
            return threshold(values.data(), from.width, from.height, numbers.low, numbers.high,
                             numbers.softness);
          },
          numbers.current};
}

Read read_similar(const Document& node, RecipeResources& resources) {
  PropagationSource source = read_appearance(node, resources);
  read_numbers(node, {describe(source.sparse).front()});  // sigma
  const Unit unit = read_unit(node);
  const Point2 at = read_point(get(node, "at"));
  const double sigma = source.sparse.sigma;
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

// A kind with how it is read.
struct Reader {
  SelectionKind kind;
  Read (*read)(const Document&, RecipeResources&);
};

OperationKind::Params no_params() {
  return {};
}

template <typename Numbers>
OperationKind::Params make_params() {
  const auto numbers = std::make_shared<Numbers>();
  return {numbers, describe(*numbers)};
}

const std::vector<Reader>& readers() {
  static const std::vector<Reader> kinds{
      {{"all", "everything", {}, no_params}, read_all},
      {{"rectangle", "upright", {"min", "max", "unit"}, no_params}, read_rectangle},
      {{"ellipse",
        "with two radii, turned",
        {"center", "radii", "rotation_deg", "unit"},
        make_params<EllipseNumbers>},
       read_ellipse},
      {{"polygon", "inside a closed line", {"points", "unit"}, no_params}, read_polygon},
      {{"stroke",
        "a brush along a line",
        {"points", "radius", "hardness", "unit"},
        make_params<BrushNumbers>},
       read_stroke},
      {{"gradient", "from 0 at one place to 1 at another", {"from", "to", "unit"}, no_params},
       read_gradient},
      {{"image", "a picture stretched over the map: white is selected", {"file"}, no_params},
       read_image},
      {{"threshold",
        "pixels of which a property lies within bounds",
        {"property", "channel", "low", "high", "softness", "state"},
        make_params<ThresholdNumbers>},
       read_threshold},
      {{"similar", "pixels that look like one", appearance_keys({"at", "unit", "sigma"}),
        make_similar_params},
       read_similar},
      {{"propagate", "strokes spread over like-looking pixels", propagation_keys({"strokes"}),
        make_propagation_params},
       read_propagate},
      {{"union", "the largest of several", {"of"}, no_params}, read_set<unite>},
      {{"intersection", "the smallest of several", {"of"}, no_params}, read_set<intersect>},
      {{"difference", "the first less all others", {"of"}, no_params}, read_set<subtract>},
  };
  return kinds;
}

Mask modify(Mask mask, const Modifiers& modifiers, Unit unit, const Grid& grid) {
  if (modifiers.grow != 0) mask = grow(mask, length_to_pixels(modifiers.grow, unit, grid));
  if (modifiers.feather > 0) mask = feather(mask, length_to_pixels(modifiers.feather, unit, grid));
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

const std::vector<SelectionKind>& selection_kinds() {
  static const std::vector<SelectionKind> kinds = [] {
    std::vector<SelectionKind> all;
    all.reserve(readers().size());
    for (const Reader& reader : readers()) all.push_back(reader.kind);
    return all;
  }();
  return kinds;
}

OperationKind::Params make_modifier_params() {
  return make_params<Modifiers>();
}

Selection read_selection(const Document& node, RecipeResources& resources) {
  std::vector<std::string> names;
  names.reserve(readers().size());
  for (const Reader& reader : readers()) names.push_back(reader.kind.name);
  as_object(node);
  const Reader& reader = readers()[read_choice(get(node, "type"), names)];
  std::vector<std::string> known = reader.kind.keys;
  for (const char* key : {"type", "grow", "feather", "invert", "unit"}) known.emplace_back(key);
  check_keys(node, known);
  const Unit unit = read_unit(node);
  Modifiers modifiers;
  read_numbers(node, describe(modifiers));
  const Read read = reader.read(node, resources);
  const Make make = [read, modifiers, unit](const SelectionContext& context) {
    return modify(read.make(context), modifiers, unit, grid_of(context.frame));
  };
  return {node, read.uses_input, remember(node, make, read.uses_input)};
}

}  // namespace parian

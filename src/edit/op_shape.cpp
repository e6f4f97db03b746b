// "shape": factor and offset curves along the normalised radius. "monotone": profiles that rise are
// made to fall.
#include <fmt/format.h>

#include "base/error.h"
#include "edit/operations.h"
#include "edit/read_parts_internal.h"
#include "edit/shape_edit.h"

namespace parian {
namespace {

std::vector<std::array<double, 2>> read_curve(const Document& layer, const char* key) {
  std::vector<std::array<double, 2>> points;
  const Document* node = find(layer, key);
  if (node == nullptr) return points;
  points.reserve(as_array(*node).size());
  for (const Document& point : as_array(*node)) {
    const std::vector<double> pair = as_numbers(point);
    if (pair.size() != 2) throw_at(point, "a pair [u, value]");
    points.push_back({pair[0], pair[1]});
  }
  return points;
}

Operation read_shape(const Document& layer, RecipeResources&) {
  ShapeEdit edit;
  read_layer_params(layer, describe(edit), {"scale", "offset"});
  edit.scale = read_curve(layer, "scale");
  edit.offset = read_curve(layer, "offset");
  try {
    check(edit);
  } catch (const Error& error) {
    throw_at(get(layer, error.parts.place), error.parts.expected, error.parts.found);
  }
  return {.apply = [edit](const LayerContext& context) {
    EditState state = context.input;
    apply(edit, state, context.mask);
    return state;
  }};
}

Operation read_monotone(const Document& layer, RecipeResources&) {
  check_layer_keys(layer, {});
  return {.apply = [](const LayerContext& context) {
    EditState state = context.input;
    make_monotone(state, context.mask);
    return state;
  }};
}

}  // namespace

OperationKind make_shape_operation() {
  OperationKind kind;
  kind.name = "shape";
  kind.summary = "factors and offsets along the normalised radius; albedo and range stay";
  ShapeEdit defaults;
  kind.keys = keys_of(describe(defaults), {"scale", "offset"});
  kind.read = read_shape;
  kind.params = [] {
    const auto edit = std::make_shared<ShapeEdit>();
    return OperationKind::Params{edit, describe(*edit)};
  };
  return kind;
}

OperationKind make_monotone_operation() {
  OperationKind kind;
  kind.name = "monotone";
  kind.summary = "profiles that rise somewhere are replaced by the nearest that never do";
  kind.read = read_monotone;
  kind.params = [] { return OperationKind::Params{}; };
  return kind;
}

}  // namespace parian

// "filter": Gaussian, bilateral, unsharp.
#include "base/error.h"
#include "edit/operations.h"
#include "edit/read_parts_internal.h"
#include "edit/smooth.h"

namespace parian {
namespace {

Operation read_filter(const Document& layer, RecipeResources&) {
  FilterParams params;
  read_layer_params(layer, describe(params));
  if (!params.albedo && !params.range && !params.shape)
    throw_at(layer, "one of 'albedo', 'range' and 'shape' to filter", "none");
  return {.apply = [params](const LayerContext& context) {
    EditState state = context.input;
    apply(params, state, context.mask, context.report);
    return state;
  }};
}

}  // namespace

OperationKind make_filter_operation() {
  OperationKind kind;
  kind.name = "filter";
  kind.summary = "Gaussian, bilateral or unsharp filtering of albedo, range and shape";
  FilterParams defaults;
  kind.keys = keys_of(describe(defaults));
  kind.read = read_filter;
  kind.params = [] {
    const auto params = std::make_shared<FilterParams>();
    return OperationKind::Params{params, describe(*params)};
  };
  return kind;
}

}  // namespace parian

// "bound_energy": row sums of R_d within a limit.
#include "edit/bound.h"
#include "edit/operations.h"
#include "edit/read_parts_internal.h"

namespace parian {
namespace {

Operation read_bound(const Document& layer, RecipeResources&) {
  BoundParams params;
  read_layer_params(layer, describe(params));
  return {.apply = [params](const LayerContext& context) {
    EditState state = context.input;
    bound_energy(params, state, context.mask, context.progress);
    return state;
  }};
}

}  // namespace

OperationKind make_bound_operation() {
  OperationKind kind;
  kind.name = "bound_energy";
  kind.summary = "lowers albedos until no illumination makes more light leave than enters";
  BoundParams defaults;
  kind.keys = keys_of(describe(defaults));
  kind.read = read_bound;
  kind.params = [] {
    const auto params = std::make_shared<BoundParams>();
    return OperationKind::Params{params, describe(*params)};
  };
  return kind;
}

}  // namespace parian

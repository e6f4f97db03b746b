// "hallucinate": a photograph and pinned profiles become the map.
#include <fmt/format.h>

#include "base/error.h"
#include "edit/hallucinate.h"
#include "edit/operations.h"
#include "edit/read_parts_internal.h"

namespace parian {
namespace {

struct PinSource {
  Document node;
  Point2 at;  // in the photograph
  Unit unit = Unit::relative;
  ProfileSource profile;
};

struct Hallucination {
  HallucinateParams params;
  PropagateParams propagation;
  std::shared_ptr<const Image> photograph, guidance;
  std::vector<PinSource> pins;
};

// A photograph has no size in mm: places in it are relative.
PinSource read_pin(const Document& node, RecipeResources& resources) {
  check_keys(node, {"at", "from"});
  PinSource pin;
  pin.node = get(node, "at");
  pin.at = read_point(pin.node);
  pin.profile = read_profile_source(get(node, "from"), resources);
  if (!pin.profile.has_place) throw_at(get(node, "from"), "the key 'at': a place in the map");
  return pin;
}

EditState apply_hallucination(const Hallucination& work, const Document& layer,
                              const LayerContext& context) {
  const std::size_t values = work.params.illumination.size();
  if (values != 1 && values != static_cast<std::size_t>(context.input.channels))
    throw_at(get(layer, "illumination"),
             fmt::format("1 value or {}, as the map has channels", context.input.channels),
             fmt::format("{}", values));
  std::vector<Pin> pins;
  pins.reserve(work.pins.size());
  for (const PinSource& source : work.pins) {
    Pin pin;
    pin.pixel = pixel_at(source.at, source.unit, grid_of(*work.photograph), source.node);
    pin.profile = get_source_profile(source.profile, context.input);
    if (pin.profile.channels != context.input.channels)
      throw_at(source.profile.node, fmt::format("a map with {} channels", context.input.channels),
               fmt::format("{}", pin.profile.channels));
    pins.push_back(std::move(pin));
  }
  try {
    return hallucinate(work.params, work.propagation, *work.photograph, *work.guidance, pins,
                       context.input, context.report, context.progress);
  } catch (const Error& error) {
    if (error.parts.place.empty() || find(layer, error.parts.place) == nullptr) throw;
    throw_at(get(layer, error.parts.place), error.parts.expected, error.parts.found);
  }
}

Operation read_hallucinate(const Document& layer, RecipeResources& resources) {
  Hallucination work;
  ParamList params = describe(work.params);
  for (Param& param : describe(work.propagation)) params.push_back(std::move(param));
  read_layer_params(layer, params, {"photograph", "guidance", "pins"});
  work.photograph = get_image(resources, get(layer, "photograph"));
  const Document* guidance = find(layer, "guidance");
  work.guidance = guidance == nullptr ? work.photograph : get_image(resources, *guidance);
  const Document& pins = get(layer, "pins");
  if (as_array(pins).empty()) throw_at(pins, "at least one pin", "none");
  for (const Document& node : as_array(pins)) work.pins.push_back(read_pin(node, resources));
  return {.changes_grid = true, .apply = [work, layer](const LayerContext& context) {
            return apply_hallucination(work, layer, context);
          }};
}

}  // namespace

OperationKind make_hallucinate_operation() {
  OperationKind kind;
  kind.name = "hallucinate";
  kind.summary = "a new material from a photograph and a few profiles";
  const auto make_params = [] {
    const auto work = std::make_shared<Hallucination>();
    ParamList list = describe(work->params);
    for (Param& param : describe(work->propagation)) list.push_back(std::move(param));
    return OperationKind::Params{work, list};
  };
  kind.keys = keys_of(make_params().list, {"photograph", "guidance", "pins"});
  kind.read = read_hallucinate;
  kind.params = make_params;
  return kind;
}

}  // namespace parian

// Operations that change the grid: "crop", "tile", "flip", "rotate", "resample", "synthesize".
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "edit/geometry.h"
#include "edit/operations.h"
#include "edit/read_parts_internal.h"
#include "edit/synthesis.h"

namespace parian {
namespace {

struct TileParams {
  int nx = 2, ny = 2;
  bool mirror = false;
};
ParamList describe(TileParams& params) {
  return {{.name = "nx", .help = "copies across", .target = &params.nx, .min = 1, .max = 256},
          {.name = "ny", .help = "copies down", .target = &params.ny, .min = 1, .max = 256},
          {.name = "mirror", .help = "every other one mirrored", .target = &params.mirror}};
}

struct FlipParams {
  bool horizontal = true;
  bool vertical = false;
};
ParamList describe(FlipParams& params) {
  return {{.name = "horizontal", .help = "left and right", .target = &params.horizontal},
          {.name = "vertical", .help = "top and bottom", .target = &params.vertical}};
}

struct RotateParams {
  double degrees = 90;
};
ParamList describe(RotateParams& params) {
  return {{.name = "degrees",
           .help = "turned clockwise; quarters are exact",
           .target = &params.degrees,
           .min = -360,
           .max = 360,
           .unit = "degrees"}};
}

struct ResampleParams {
  double pixel_pitch_mm = 1;
};
ParamList describe(ResampleParams& params) {
  return {{.name = "pixel-pitch-mm",
           .help = "side of the new pixels",
           .target = &params.pixel_pitch_mm,
           .min = 0,
           .max = 1e6,
           .above_min = true,
           .unit = "mm"}};
}

void check_size(const Document& layer, const EditState& state, double width, double height) {
  const std::size_t most = max_pixels(state);
  if (!(width * height <= static_cast<double>(most)))
    throw_at(layer, fmt::format("a map of at most {} pixels", most),
             fmt::format("{:.0f} x {:.0f}", width, height));
}

// An operation whose plain numbers are all there is, as `apply(params, state, layer)`.
template <typename Params, typename Apply>
OperationKind make_grid_operation(const char* name, const char* summary, Apply apply,
                                  const char* required = nullptr) {
  OperationKind kind;
  kind.name = name;
  kind.summary = summary;
  Params defaults;
  kind.keys = keys_of(describe(defaults));
  kind.read = [apply, required](const Document& layer, RecipeResources&) {
    Params params;
    read_layer_params(layer, describe(params));
    if (required != nullptr) get(layer, required);
    return Operation{.changes_grid = true, .apply = [=](const LayerContext& context) {
                       return apply(params, context, layer);
                     }};
  };
  kind.params = [] {
    const auto params = std::make_shared<Params>();
    return OperationKind::Params{params, describe(*params)};
  };
  return kind;
}

EditState apply_synthesis(const SynthesisParams& params, const LayerContext& context,
                          const Document& layer) {
  const EditState& state = context.input;
  check_size(layer, state, params.width_px, params.height_px);
  const Plane albedo = albedo_plane(state), range = range_plane(state);
  std::vector<float> planes;
  planes.reserve(2 * albedo.size());
  for (const Plane* plane : {&albedo, &range})
    for (double value : *plane) planes.push_back(static_cast<float>(std::log(value)));
  try {
    return gather_pixels(
        state,
        synthesize(planes, 2 * state.channels, state.width, state.height, params, context.progress),
        params.width_px, params.height_px);
  } catch (const Error& error) {
    if (error.kind == ErrorKind::cancelled) throw;
    throw_at(layer, error.parts.expected, error.parts.found);
  }
}

Operation read_crop(const Document& layer, RecipeResources&) {
  check_layer_keys(layer, {"min", "max", "unit"});
  const Unit unit = read_unit(layer);
  const Point2 min = read_point(get(layer, "min")), max = read_point(get(layer, "max"));
  return {.changes_grid = true, .apply = [=](const LayerContext& context) {
            const Grid grid = grid_of(context.input);
            const Point2 a = to_pixels(min, unit, grid), b = to_pixels(max, unit, grid);
            const auto inside = [](double value, int size) {
              return static_cast<int>(std::lround(std::min(std::max(value, 0.0), 1.0 * size)));
            };
            const int x0 = inside(a.x, grid.width), x1 = inside(b.x, grid.width);
            const int y0 = inside(a.y, grid.height), y1 = inside(b.y, grid.height);
            if (x0 >= x1 || y0 >= y1)
              throw_at(
                  layer,
                  fmt::format("a rectangle that meets the map of {:.6g} x {:.6g} mm",
                              grid.width * grid.pixel_pitch_mm, grid.height * grid.pixel_pitch_mm),
                  "one without a pixel of it");
            return crop(context.input, x0, y0, x1, y1);
          }};
}

}  // namespace

OperationKind make_crop_operation() {
  OperationKind kind;
  kind.name = "crop";
  kind.summary = "a rectangle of the map, to whole pixels";
  kind.keys = {"min", "max", "unit"};
  kind.read = read_crop;
  kind.params = [] { return OperationKind::Params{}; };
  return kind;
}

OperationKind make_tile_operation() {
  return make_grid_operation<TileParams>(
      "tile", "copies side by side",
      [](const TileParams& params, const LayerContext& context, const Document& layer) {
        check_size(layer, context.input, 1.0 * params.nx * context.input.width,
                   1.0 * params.ny * context.input.height);
        return tile(context.input, params.nx, params.ny, params.mirror);
      });
}

OperationKind make_flip_operation() {
  return make_grid_operation<FlipParams>(
      "flip", "mirrored",
      [](const FlipParams& params, const LayerContext& context, const Document&) {
        return flip(context.input, params.horizontal, params.vertical);
      });
}

OperationKind make_rotate_operation() {
  return make_grid_operation<RotateParams>(
      "rotate", "turned about its centre",
      [](const RotateParams& params, const LayerContext& context, const Document&) {
        return rotate(context.input, params.degrees);
      });
}

OperationKind make_resample_operation() {
  return make_grid_operation<ResampleParams>(
      "resample", "the same extent with pixels of another size",
      [](const ResampleParams& params, const LayerContext& context, const Document& layer) {
        const double ratio = context.input.pixel_pitch_mm / params.pixel_pitch_mm;
        check_size(layer, context.input, std::ceil(context.input.width * ratio),
                   std::ceil(context.input.height * ratio));
        return resample_to_pitch(context.input, params.pixel_pitch_mm);
      },
      "pixel_pitch_mm");
}

OperationKind make_synthesize_operation() {
  return make_grid_operation<SynthesisParams>(
      "synthesize", "a map of any size that looks alike, quilted from patches", apply_synthesis);
}

}  // namespace parian

// parian edit: a map or a blend and a recipe -> the edited material (SubEdit 2009, sections
// 5, 7.1).
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "app/report/provenance.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "edit/retarget.h"
#include "edit/session.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/json.h"

namespace parian {
namespace {

struct EditOptions {
  std::string input, recipe, output, masks, planes;
  bool bases = false;
  bool list = false;
};

// A blend stays beside its map, for edits that go into it directly.
struct Source {
  ProfileMap map;
  std::unique_ptr<ProfileBlend> blend;
  std::string provenance;
};

Source open_source(const EditOptions& options) {
  Source source;
  const FileKind kind = find_file_kind(options.input);
  if (kind == FileKind::blend) {
    source.blend = std::make_unique<ProfileBlend>(load_blend(options.input));
    source.provenance = source.blend->provenance;
    source.map = options.bases ? make_profile_map(make_base_state(*source.blend))
                               : make_profile_map(*source.blend);
    return source;
  }
  if (options.bases)
    throw Error({{}, "--bases", "a blend (.kbm) to edit", options.input}, ErrorKind::usage);
  if (kind == FileKind::table)
    throw Error({options.input, {}, "a profile map or a blend (parian fit makes one)", "a table"});
  source.map = load_profile_map(options.input);
  source.provenance = source.map.provenance;
  return source;
}

bool wants_blend(const EditOptions& options) {
  return std::filesystem::path(options.output).extension() == ".kbm";
}

void check_kinds(const EditOptions& options, const Source& source) {
  if (options.bases && !wants_blend(options))
    throw Error({{}, "--bases", "an output named .kbm", options.output}, ErrorKind::usage);
  if (wants_blend(options) && !source.blend)
    throw Error({options.output,
                 {},
                 "an output named .h5, as the input is a map (parian compress "
                 "makes a blend of it)",
                 ".kbm"});
}

struct LayerFigures {
  std::string name, operation;
  double seconds = 0;
  double selected = 1;  // mean of the mask
  EditReport report;
};

// Layer by layer, so that each one's time is its own.
std::vector<LayerFigures> run_layers(EditSession& session, const Progress& progress) {
  std::vector<LayerFigures> figures;
  figures.reserve(session.recipe.layers.size());
  for (std::size_t i = 0; i < session.recipe.layers.size(); ++i) {
    const Layer& layer = *session.recipe.layers[i];
    if (!layer.enabled) continue;
    const Stopwatch watch;
    evaluate(session, progress, i + 1);
    LayerFigures row{.name = layer.name, .operation = layer.kind};
    row.seconds = watch.seconds();
    const LayerResult* result = find_result(session, i);
    row.report = result->report;
    if (!result->mask->weight.empty()) {
      double sum = 0;
      for (float weight : result->mask->weight) sum += static_cast<double>(weight);
      row.selected = sum / static_cast<double>(result->mask->weight.size());
    }
    figures.push_back(row);
  }
  return figures;
}

void write_masks(const EditSession& session, const std::string& folder) {
  for (std::size_t i = 0; i < session.recipe.layers.size(); ++i) {
    const LayerResult* result = find_result(session, i);
    if (result == nullptr || result->mask->weight.empty()) continue;
    Image image{result->mask->width, result->mask->height, 1, result->mask->weight};
    save_image(fmt::format("{}/layer-{:02}.exr", folder, i + 1), image);
    for (float& value : image.values) value *= value;  // so that half selected looks half bright
    save_image(fmt::format("{}/layer-{:02}.png", folder, i + 1), image);
  }
}

// Channels as colours, in EXR: 2 pi C, alpha and the mean radius in mm.
void write_planes(const EditState& state, const std::string& folder) {
  const auto write = [&](const char* name, const Plane& plane) {
    Image image = make_image(state.width, state.height, state.channels);
    const auto channels = static_cast<std::size_t>(state.channels);
    for (std::size_t i = 0; i < plane.size(); ++i)
      image.values[i % state.pixels() * channels + i / state.pixels()] =
          static_cast<float>(plane[i]);
    save_image(fmt::format("{}/{}.exr", folder, name), image);
  };
  write("albedo", albedo_plane(state));
  write("range", range_plane(state));
  write("mean-radius", mean_radius_plane(state));
}

void save(const EditOptions& options, const Source& source, const EditSession& session,
          const EditState& result) {
  const std::string provenance = make_edit_provenance(options.input, source.provenance,
                                                      options.recipe, write_recipe(session.recipe));
  if (!wants_blend(options)) {
    ProfileMap map = make_profile_map(result);
    map.provenance = provenance;
    return save_profile_map(options.output, map);
  }
  ProfileBlend blend;
  try {
    blend = options.bases ? retarget_bases(*source.blend, result)
                          : retarget(*source.blend, session.original, result);
  } catch (const Error& error) {
    throw Error({options.recipe, error.parts.place, error.parts.expected, error.parts.found});
  }
  blend.provenance = provenance;
  save_blend(options.output, blend,
             blend.grid == BlendGrid{} ? BlendEncoding::paper : BlendEncoding::packed);
}

Document to_document(const std::vector<LayerFigures>& figures, const EditState& result) {
  Document::Array layers;
  layers.reserve(figures.size());
  for (const LayerFigures& row : figures) {
    Document layer{Document::Object{}};
    set(layer, "name", row.name);
    set(layer, "operation", row.operation);
    set(layer, "selected", row.selected);
    set(layer, "clamped_albedo", row.report.clamped_albedo);
    set(layer, "clamped_range", row.report.clamped_range);
    set(layer, "seconds", row.seconds);
    layers.push_back(std::move(layer));
  }
  Document document{Document::Object{}};
  set(document, "width", result.width);
  set(document, "height", result.height);
  set(document, "channels", result.channels);
  set(document, "layers", std::move(layers));
  return document;
}

std::string summarise(const EditOptions& options, const std::vector<LayerFigures>& figures,
                      const EditState& result) {
  std::string text = fmt::format("{}: {} x {} pixels, {} channels\n", options.output, result.width,
                                 result.height, result.channels);
  for (const LayerFigures& row : figures) {
    text += fmt::format("  {} ({}): {:.1f} % selected, {:.0f} ms", row.name, row.operation,
                        100 * row.selected, 1000 * row.seconds);
    if (row.report.clamped_albedo > 0)
      text += fmt::format(", {} albedos kept at {}", row.report.clamped_albedo, least_albedo);
    if (row.report.clamped_range > 0)
      text += fmt::format(", {} ranges kept at half a pixel", row.report.clamped_range);
    text += "\n";
  }
  return text;
}

// "a, b, c"
std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void list_operations() {
  std::string text = "operations\n";
  for (const OperationKind& kind : operation_kinds()) {
    text += fmt::format("\n{}: {}\n", kind.name, kind.summary);
    const OperationKind::Params params = kind.params();
    std::vector<std::string> others = kind.keys;
    for (const Param& param : params.list) {
      std::erase(others, json_key(param));
      text += fmt::format("  {} = {}  {}{}{}\n", json_key(param), format_value(param), param.help,
                          format_range(param).empty() ? "" : ", ", format_range(param));
    }
    if (!others.empty()) text += "  and " + join(others) + "\n";
  }
  text += "\nselections, each with grow, feather, invert, unit\n";
  for (const SelectionKind& kind : selection_kinds())
    text += fmt::format("  {}{}{}\n", kind.name, kind.keys.empty() ? "" : ": ", join(kind.keys));
  print_summary({}, text);
}

void edit(const EditOptions& options, const Context& context) {
  if (options.list) return list_operations();
  check_output(options.output, {options.input, options.recipe});
  for (const std::string& folder : {options.masks, options.planes})
    if (!folder.empty()) make_folder(folder);
  const Source source = open_source(options);
  check_kinds(options, source);
  std::vector<std::string> files;
  EditSession session = make_edit_session(
      source.map,
      make_recipe_loaders(std::filesystem::path(options.recipe).parent_path().string(), &files));
  set_recipe(session, load_document(options.recipe));
  check_output(options.output, files);
  const std::vector<LayerFigures> figures = run_layers(session, context.progress);
  const EditState result = evaluate(session, context.progress);
  save(options, source, session, result);
  if (!options.masks.empty()) write_masks(session, options.masks);
  if (!options.planes.empty()) write_planes(result, options.planes);
  write_figures(context, to_document(figures, result));
  print_summary(context, summarise(options, figures, result));
}

}  // namespace

CommandSpec make_edit_command() {
  const auto options = std::make_shared<EditOptions>();
  CommandSpec command;
  command.name = "edit";
  command.summary = "apply a recipe of edits to a profile map or a blend";
  command.example = "parian edit stone-map.h5 --recipe warmer.json -o warmer-map.h5";
  command.positionals = {
      {"MATERIAL", "profile map, or a blend whose shapes stay", &options->input}};
  command.flags = {
      {"recipe", 'r', "RECIPE.json", "the edits, layer by layer", &options->recipe,
       /*required=*/true},
      {"output", 'o', "FILE", "map (.h5) or, of a blend, blend (.kbm)", &options->output,
       /*required=*/true},
      {"masks", 0, "DIR", "also write what each layer selects, as EXR and PNG", &options->masks},
      {"planes", 0, "DIR", "also write albedo, range and mean radius of the result, as EXR",
       &options->planes},
      {"bases", 0, {}, "edit a blend's base materials, as a map of M x 1 pixels", &options->bases},
      {"list",
       0,
       {},
       "list the operations and their parameters",
       &options->list,
       false,
       /*alone=*/true}};
  command.has_figures = true;
  command.run = [options](const Context& context) { edit(*options, context); };
  return command;
}

}  // namespace parian

// parian import: slices or textures that other programs made -> a table or a profile map.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "acquire/import_slices.h"
#include "acquire/import_textures.h"
#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "base/error.h"
#include "io/array/npy_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/json.h"

namespace parian {
namespace {

struct ImportOptions {
  std::string description, output;
  int deflate = 0;
};

ParamList describe(ImportOptions& options) {
  return {deflate_param(options.deflate)};
}

NamedArray load_array(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".npy") {
    NpyArray array = load_npy(path);
    return {std::move(array.shape), std::move(array.values)};
  }
  if (extension != ".exr")
    throw Error({.file = path,
                 .expected = "a name that ends in .npy or .exr",
                 .found = extension.empty() ? "none" : extension});
  Image image = load_raw_image(path, /*allow_nan=*/true);
  return {{static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width),
           static_cast<std::size_t>(image.channels)},
          std::move(image.values)};
}

void import_table(const ImportOptions& options, const Document& document, const Context& context) {
  const SliceImport slices = read_slice_import(document, load_array);
  const TableHeader& header = slices.header;
  const auto sink = create_table(options.output, header, {options.deflate});
  import_slices(slices, load_array, *sink, context.progress);
  print_summary(
      context,
      fmt::format("{}: imported table, {} x {} pixels of {} mm, {} offsets, {} channels{}\n",
                  options.output, header.width, header.height, header.pixel_pitch_mm,
                  header.offsets.size(), header.channels,
                  header.symmetric ? "" : ", both directions"));
}

void import_map(const ImportOptions& options, const Document& document, const Context& context) {
  TextureMap made = make_texture_map(read_texture_import(
      document, [](const std::string& path) { return load_image(path); },
      [](const std::string& path) { return load_raw_image(path); }));
  made.map.provenance = format_document(
      Document::Object{{"kind", "import"}, {"simulated", true}, {"import", document}});
  save_profile_map(options.output, made.map);
  std::string text =
      fmt::format("{}: imported profile map, {} x {} pixels of {} mm, {} knots, {} channels\n",
                  options.output, made.map.width, made.map.height, made.map.pixel_pitch_mm,
                  made.map.knots_mm.size(), made.map.channels);
  if (made.limited > 0)
    text += fmt::format("{} values moved into the range that profiles can have\n", made.limited);
  print_summary(context, text);
}

void import_files(const ImportOptions& options, const Context& context) {
  check_output(options.output, {options.description});
  const Document document = load_document(options.description);
  const Document& kind = get(document, "kind");
  if (as_string(kind) == "slices") {
    import_table(options, document, context);
  } else if (as_string(kind) == "textures") {
    import_map(options, document, context);
  } else {
    throw_at(kind, "'slices' or 'textures'", fmt::format("'{}'", as_string(kind)));
  }
}

}  // namespace

CommandSpec make_import_command() {
  const auto options = std::make_shared<ImportOptions>();
  CommandSpec command;
  command.name = "import";
  command.summary = "make a table of NumPy or EXR slices, or a profile map of textures";
  command.example = "parian import slices.json -o stone.h5";
  command.positionals = {{"IMPORT.json", "what the files hold", &options->description}};
  command.flags = {
      {"output", 'o', "OUT.h5", "table or map to write", &options->output, /*required=*/true}};
  command.params = describe(*options);
  command.run = [options](const Context& context) { import_files(*options, context); };
  return command;
}

}  // namespace parian

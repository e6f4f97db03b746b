// parian relight: the flat sample under uniform, disc, line or image light.
#include "judge/relight.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "base/error.h"
#include "base/names.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"

namespace parian {
namespace {

struct RelightOptions {
  std::string input, output, like, light = "uniform";
  double exposure = 0;
};

ParamList describe(RelightOptions& options) {
  return {{.name = "exposure",
           .help = "the image is multiplied by 2 to this power",
           .target = &options.exposure,
           .min = -64,
           .max = 64,
           .unit = "stops"}};
}

// An image as irradiance; grey light is that of all channels.
Image load_light(const std::string& path, const TableHeader& header) {
  Image light = load_image(path);
  if (light.width != header.width || light.height != header.height)
    throw Error({path, "size",
                 fmt::format("{} x {} pixels, as the sample", header.width, header.height),
                 fmt::format("{} x {}", light.width, light.height)});
  return light;
}

Image make_light(const std::string& name, const TableHeader& header) {
  const std::vector<std::string> names{"uniform", "disc", "line"};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (name == names[i])
      return make_flat_light(static_cast<FlatLight>(i), header.width, header.height,
                             header.channels);
  const std::filesystem::path path = name;
  if (path.has_extension() && find_file_kind(name) == FileKind::image)
    return load_light(name, header);
  const std::string nearest = nearest_name(name, names);
  throw Error({{},
               "--light",
               list_names(names) + ", or an image file",
               "'" + name + "'" + (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)")},
              ErrorKind::usage);
}

void relight_file(const RelightOptions& options, const Context& context) {
  check_output(options.output, {options.input, options.light});
  const std::unique_ptr<SliceSource> like =
      options.like.empty() ? nullptr : open_table(options.like);
  const Surface surface = open_surface(options.input, like ? &like->header() : nullptr);
  const Image light = make_light(options.light, surface.slices->header());
  const Image lit = relight(*surface.slices, {light}, context.progress).front();
  save_image(options.output, scale(lit, std::exp2(static_cast<float>(options.exposure))));
  print_summary(context, fmt::format("{}: {} x {} pixels under {} light\n", options.output,
                                     lit.width, lit.height, options.light));
}

}  // namespace

CommandSpec make_relight_command() {
  const auto options = std::make_shared<RelightOptions>();
  CommandSpec command;
  command.name = "relight";
  command.summary = "light a flat sample, measured or modelled";
  command.example = "parian relight stone-map.h5 --light disc -o stone-disc.png --exposure 1";
  command.positionals = {{"MATERIAL|TABLE", "profile map, blend or table", &options->input}};
  command.flags = {
      {"output", 'o', "IMAGE", "image to write: .png, .exr or .hdr", &options->output,
       /*required=*/true},
      {"light", 0, "uniform|disc|line|IMAGE", "irradiance over the sample", &options->light},
      {"like", 0, "TABLE.h5", "light a material at this table's offsets, not its whole support",
       &options->like}};
  command.params = describe(*options);
  command.run = [options](const Context& context) { relight_file(*options, context); };
  return command;
}

}  // namespace parian

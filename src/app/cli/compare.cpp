// parian compare: how well a material, or a second table, agrees with a measured table.
#include "judge/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "app/report/pictures.h"
#include "base/error.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "judge/false_color.h"

namespace parian {
namespace {

struct CompareOptions {
  std::string table, material, error_image, plot_folder = ".";
  std::vector<std::string> plots;
  double error_scale = 0;
  int plot_channel = -1;
};

ParamList describe(CompareOptions& options) {
  return {{.name = "error-scale",
           .help = "relative error that is brightest in a PNG error image; 0: the largest",
           .target = &options.error_scale,
           .min = 0},
          {.name = "plot-channel",
           .help = "channel of the plots; -1: the middle one",
           .target = &options.plot_channel,
           .min = -1,
           .max = 2}};
}

std::string format_lights(const PerLight& values) {
  return fmt::format("uniform {:.4g}  disc {:.4g}  line {:.4g}", values.uniform, values.disc,
                     values.line);
}

std::string format_range_of(const MinMeanMax& values) {
  return fmt::format("mean {:.5f}  min {:.5f}  max {:.5f}", values.mean, values.min, values.max);
}

std::string summarise(const CompareReport& report) {
  std::string text = "relative error     " + format_range_of(report.relative_error) + "\n";
  text += "relative error L1  " + format_range_of(report.relative_error_l1) + "\n";
  text += fmt::format("albedo error       mean {:.5f}  max {:.5f}\n", report.albedo_error_mean,
                      report.albedo_error_max);
  text += "PSNR in dB         " + format_lights(report.psnr_db) + "\n";
  text += "SSIM               " + format_lights(report.ssim) + "\n";
  text += fmt::format("log RMS            {:.5f}\n", report.log_rms);
  if (report.held_out)
    text += fmt::format("held out           {} pairs, relative error {}, log RMS {:.5f}\n",
                        report.held_out->pairs, format_range_of(report.held_out->relative_error),
                        report.held_out->log_rms);
  if (report.asymmetry) text += fmt::format("asymmetry          {:.3g}\n", *report.asymmetry);
  if (report.missing_in_model + report.pixels_skipped > 0)
    text +=
        fmt::format("left out           {} pairs missing in the model, {} pixels not measured\n",
                    report.missing_in_model, report.pixels_skipped);
  return text + fmt::format("bytes              {} table, {} material\n", report.bytes_table,
                            report.bytes_material);
}

bool is_linear(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".exr" || extension == ".hdr";
}

// PNG and JPEG show false colours, EXR and HDR hold the relative errors themselves.
void save_error_image(const CompareOptions& options, const Image& errors) {
  if (options.error_image.empty()) return;
  const double top = options.error_scale > 0 ? options.error_scale : largest_value(errors);
  const int magnification = std::max(1, (320 + errors.width - 1) / errors.width);
  save_image(options.error_image,
             is_linear(options.error_image)
                 ? errors
                 : draw_color_map(errors, top, magnification, "relative error per pixel"));
}

void save_plots(const CompareOptions& options, const SliceSource& table, const Surface& model,
                const std::vector<PlotPixel>& pixels) {
  if (pixels.empty()) return;
  const int channels = table.header().channels;
  const int channel = options.plot_channel < 0 ? channels / 2 : options.plot_channel;
  if (channel >= channels)
    throw Error({{},
                 "--plot-channel",
                 fmt::format("a channel below {}", channels),
                 fmt::format("{}", channel)},
                ErrorKind::usage);
  const std::vector<Image> plots =
      plot_profiles(table, *model.slices, model.material.get(), pixels, channel);
  for (std::size_t i = 0; i < plots.size(); ++i)
    save_image(fmt::format("{}/profile-{}-{}.png", options.plot_folder, pixels[i].x, pixels[i].y),
               plots[i]);
}

void compare_files(const CompareOptions& options, const Context& context) {
  const std::vector<std::string> inputs{options.table, options.material};
  if (!options.error_image.empty()) check_output(options.error_image, inputs);
  if (!options.plots.empty()) make_folder(options.plot_folder);
  const std::unique_ptr<SliceSource> table = open_table(options.table);
  const Surface model = open_surface(options.material, &table->header());
  std::vector<PlotPixel> pixels;
  pixels.reserve(options.plots.size());
  for (const std::string& text : options.plots)
    pixels.push_back(parse_pixel(text, table->header()));
  const HoldOut hold_out = model.material ? hold_out_of(*model.material) : HoldOut{};
  CompareReport report = compare(*table, *model.slices, hold_out, context.progress);
  report.bytes_material = std::filesystem::file_size(options.material);
  save_error_image(options, report.error_image);
  save_plots(options, *table, model, pixels);
  write_figures(context, to_document(report));
  print_summary(context, summarise(report));
}

}  // namespace

CommandSpec make_compare_command() {
  const auto options = std::make_shared<CompareOptions>();
  CommandSpec command;
  command.name = "compare";
  command.summary = "report a material's errors against a table";
  command.example = "parian compare stone.h5 stone-map.h5 --json report.json --plot 20,30";
  command.positionals = {{"TABLE.h5", "what was measured", &options->table},
                         {"MATERIAL", "profile map, blend, or a second table", &options->material}};
  command.flags = {
      {"error-image", 0, "IMAGE", "relative error per pixel: false colours, or values in EXR",
       &options->error_image},
      {"plot", 0, "X,Y", "plot data against model around this pixel", &options->plots},
      {"plot-dir", 0, "DIR", "where plots go, as profile-X-Y.png", &options->plot_folder}};
  command.params = describe(*options);
  command.has_figures = true;
  command.run = [options](const Context& context) { compare_files(*options, context); };
  return command;
}

}  // namespace parian

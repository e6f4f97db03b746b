// parian capture: photographs of a projected dot grid -> a table, and with --synthesize a sample or
// a table -> such photographs.
#include "acquire/capture.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "acquire/capture_synthesize.h"
#include "acquire/sample.h"
#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "base/error.h"
#include "io/capture/capture_folder.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/json.h"

namespace parian {
namespace {

namespace fs = std::filesystem;

struct CaptureOptions {
  std::string input, output;
  bool synthesize = false;
  bool raw = false;
  int lattice_px = 0;
  double radius_px = 0;
  int exposures = 3;
  double shortest_s = 0.01, ratio = 8;
  CaptureMeta meta;  // format, response, calibration_frames, reference_albedo
  PhotographParams synthesis;
};

ParamList describe(CaptureOptions& options) {
  ParamList params{
      {.name = "lattice-px",
       .help = "distance of dots; 0: twice the radius and 4",
       .target = &options.lattice_px,
       .min = 0,
       .max = 1024},
      {.name = "radius-px",
       .help = "offsets to be captured; 0: the sample's or table's",
       .target = &options.radius_px,
       .min = 0,
       .max = 512},
      {.name = "exposures", .help = "how many", .target = &options.exposures, .min = 1, .max = 16},
      {.name = "shortest-s",
       .help = "shortest exposure",
       .target = &options.shortest_s,
       .min = 1e-6,
       .max = 1000,
       .unit = "s"},
      {.name = "ratio",
       .help = "of neighbouring exposures",
       .target = &options.ratio,
       .min = 1.1,
       .max = 100}};
  for (Param& param : describe(options.meta))
    if (param.name == "calibration-frames" || param.name == "format" || param.name == "response" ||
        param.name == "reference-albedo" || param.name == "centre-px")
      params.push_back(std::move(param));
  for (Param& param : describe(options.synthesis)) params.push_back(std::move(param));
  for (Param& param : params) param.help = "--synthesize: " + param.help;
  return params;
}

// A sample's own offsets, and in `reach_px` those that neighbours' tails need.
struct Truth {
  BssrdfTable table;
  double radius_px = 0;
};
Truth load_truth(const CaptureOptions& options) {
  if (find_file_kind(options.input) == FileKind::table) {
    BssrdfTable table = read_table(*open_table(options.input));
    if (!table.header.symmetric) throw Error({options.input, "attribute 'symmetric'", "1", "0"});
    const double radius = radius_px(table.header);
    return {std::move(table), radius};
  }
  const fs::path folder = fs::path(options.input).parent_path();
  Sample sample = read_sample(load_document(options.input), [&](const std::string& path) {
    return load_image((folder / path).string());
  });
  const double radius = options.radius_px > 0 ? options.radius_px : sample.radius_px;
  // All that reaches a pixel from the dots around it.
  sample.radius_px = std::min({3 * radius + 6, 512.0, std::max(sample.width, sample.height) - 1.0});
  return {read_table(*make_analytic_source(sample)), radius};
}

CaptureMeta make_meta(const CaptureOptions& options, const Truth& truth) {
  CaptureMeta meta = options.meta;
  const TableHeader& header = truth.table.header;
  meta.width = header.width;
  meta.height = header.height;
  meta.channels = header.channels;
  meta.pixel_pitch_mm = header.pixel_pitch_mm;
  meta.eta = header.eta;
  meta.synthetic = true;
  meta.radius_px = options.radius_px > 0 ? options.radius_px : truth.radius_px;
  meta.lattice_px = options.lattice_px > 0 ? options.lattice_px
                                           : 2 * static_cast<int>(std::ceil(meta.radius_px)) + 4;
  meta.exposures_s.clear();
  for (int e = 0; e < options.exposures; ++e)
    meta.exposures_s.push_back(options.shortest_s * std::pow(options.ratio, e));
  make_camera(options.synthesis, meta);
  return meta;
}

void synthesize(const CaptureOptions& options, const Context& context) {
  const Truth truth = load_truth(options);
  const CaptureMeta meta = make_meta(options, truth);
  if (fs::exists(fs::path(options.output) / "meta.json"))
    throw Error({options.output, {}, "a new or empty folder", "one with a meta.json"},
                ErrorKind::usage);
  // What the description must be for a capture, checked before anything is written.
  read_capture_meta(parse_document(format_document(write_capture_meta(meta)), "meta.json"));
  make_folder(options.output);
  std::size_t frames = 0;
  synthesize_capture(
      truth.table, meta, options.synthesis,
      [&](const FrameName& frame, const Image& codes) {
        save_frame(options.output, meta, frame, codes);
        ++frames;
      },
      context.progress);
  save_capture_meta(options.output, meta);  // last: with it the folder is whole
  print_summary(context, fmt::format("{}: {} synthetic photographs of {} x {} pixels, dots {} "
                                     "pixels of the table apart\n",
                                     options.output, frames, meta.camera_width, meta.camera_height,
                                     meta.lattice_px));
}

std::string summarise(const CaptureReport& report) {
  std::string text =
      fmt::format("camera             full well {:.0f} e-, read noise {:.2f} e-\n",
                  report.camera.full_well, report.camera.read * report.camera.full_well);
  text += fmt::format("geometry           {} dots, residual {:.3f} px, blur {:.3f} px\n",
                      report.dots_found, report.reprojection_px, report.psf_px);
  text += fmt::format("dot power          spread {:.3f}\n", report.dot_power_spread);
  text += fmt::format("saturated          {:.4g} of the pixels at every exposure\n",
                      report.saturated_fraction);
  text += fmt::format("tails              {:.4g} of the light belonged to other dots\n",
                      report.tail_fraction);
  text += fmt::format("asymmetry          {:.4g}\n", report.asymmetry);
  text += fmt::format("sum of all slices  {:.4g} from the white image\n", report.white_error);
  for (const NoiseModel& noise : report.noise)
    text += fmt::format("noise              floor {:.3g}, gain {:.3g}, systematic {:.3g}\n",
                        noise.floor, noise.gain, noise.relative);
  if (report.white_error > 0.05)
    text +=
        "warning: the dot frames do not add up to the white image: the light changed, the "
        "camera is not linear, or frames are mixed up\n";
  return text;
}

void capture(const CaptureOptions& options, const Context& context) {
  CaptureOptions given = options, defaults;
  check_unused(describe(given), describe(defaults), "--synthesize with it", "photographs");
  check_output(options.output, {});
  const CaptureMeta meta = open_capture(options.input);
  CaptureResult result;
  try {
    result = process_capture(meta, make_frame_loader(options.input, meta), context.progress);
  } catch (Error& error) {
    if (error.parts.file.empty() && error.kind == ErrorKind::input) {
      ErrorParts parts = error.parts;
      parts.file = options.input;
      throw Error(std::move(parts));
    }
    throw;
  }
  const Document figures = to_document(result.report);
  BssrdfTable& table = options.raw ? result.raw : result.table;
  table.header.provenance = format_document(Document::Object{{"kind", "capture"},
                                                             {"simulated", meta.synthetic},
                                                             {"meta", write_capture_meta(meta)},
                                                             {"report", figures}});
  const auto sink = create_table(options.output, table.header);
  copy_slices(*make_slices(table), *sink, context.progress);
  write_figures(context, figures);
  print_summary(
      context,
      fmt::format("{}: captured table, {} x {} pixels of {} mm, {} offsets, {} channels{}\n",
                  options.output, table.header.width, table.header.height,
                  table.header.pixel_pitch_mm, table.header.offsets.size(), table.header.channels,
                  options.raw ? ", both directions" : "") +
          summarise(result.report));
}

}  // namespace

CommandSpec make_capture_command() {
  const auto options = std::make_shared<CaptureOptions>();
  CommandSpec command;
  command.name = "capture";
  command.summary = "make a table of photographs of a projected dot grid";
  command.example = "parian capture photographs -o stone.h5 --json report.json";
  command.positionals = {
      {"FOLDER", "folder of photographs; with --synthesize a sample or a table", &options->input}};
  command.flags = {{"output", 'o', "TABLE.h5", "table to write; with --synthesize a new folder",
                    &options->output, /*required=*/true},
                   {"synthesize", 0, "", "make such a folder from SAMPLE.json or TABLE.h5",
                    &options->synthesize},
                   {"raw", 0, "", "write both directions of each pair", &options->raw}};
  command.params = describe(*options);
  command.has_figures = true;
  command.run = [options](const Context& context) {
    if (options->synthesize) {
      synthesize(*options, context);
    } else {
      capture(*options, context);
    }
  };
  return command;
}

}  // namespace parian

// parian simulate: a described sample -> a table. The result is simulated, and says so.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "acquire/sample.h"
#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "app/cli/simulate_photon.h"
#include "base/error.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/json.h"

namespace parian {
namespace {

enum class Engine { analytic, photon };

struct SimulateOptions {
  std::string sample;
  Engine engine = Engine::analytic;
  int seed = -1;
  PhotonRun run;
};

// The parameters of photons, which mean nothing to the analytic engine.
ParamList describe_photons(PhotonRun& run) {
  ParamList params = describe(run.params);
  params.push_back({.name = "checkpoint",
                    .help = "store what has been gathered in OUTPUT.partial every so often",
                    .target = &run.checkpoint_s,
                    .min = 0,
                    .max = 3600,
                    .unit = "s"});
  return params;
}

ParamList describe(SimulateOptions& options) {
  ParamList params{
      {.name = "engine",
       .help = "the dipole, or photons traced through the sample's volume",
       .target = make_choice(options.engine, {"analytic", "photon"})},
      {.name = "seed",
       .help = "of the layout's random numbers, instead of the description's (-1: that one)",
       .target = &options.seed,
       .min = -1}};
  for (Param& param : describe_photons(options.run)) params.push_back(std::move(param));
  params.push_back(deflate_param(options.run.deflate));
  return params;
}

void check_engine(const SimulateOptions& options) {
  if (options.engine == Engine::photon) return;
  PhotonRun given = options.run, defaults;
  check_unused(describe_photons(given), describe_photons(defaults), "--engine photon with it",
               "--engine analytic");
}

void simulate(const SimulateOptions& options, const Context& context) {
  check_engine(options);
  check_output(options.run.output, {options.sample});
  const std::filesystem::path folder = std::filesystem::path(options.sample).parent_path();
  const Sample sample = read_sample(
      load_document(options.sample),
      [&](const std::string& path) { return load_image((folder / path).string()); }, options.seed);
  if (options.engine == Engine::photon) return simulate_photons(sample, options.run, context);
  const std::unique_ptr<SliceSource> source = make_analytic_source(sample);
  const TableHeader& header = source->header();
  const auto sink = create_table(options.run.output, header, {options.run.deflate});
  copy_slices(*source, *sink, context.progress);
  write_figures(context, Document::Object{{"pixels", header.pixels()},
                                          {"offsets", header.offsets.size()},
                                          {"channels", header.channels}});
  print_summary(
      context,
      fmt::format("{}: simulated table, {} x {} pixels of {} mm, {} offsets, {} channels\n",
                  options.run.output, header.width, header.height, header.pixel_pitch_mm,
                  header.offsets.size(), header.channels));
}

}  // namespace

CommandSpec make_simulate_command() {
  const auto options = std::make_shared<SimulateOptions>();
  CommandSpec command;
  command.name = "simulate";
  command.summary = "simulate the table of a described sample";
  command.example = "parian simulate data/samples/chessboard.json -o chessboard.h5";
  command.positionals = {{"SAMPLE.json", "sample description", &options->sample}};
  command.flags = {
      {"output", 'o', "TABLE.h5", "table to write", &options->run.output, /*required=*/true}};
  command.params = describe(*options);
  command.has_figures = true;
  command.run = [options](const Context& context) { simulate(*options, context); };
  return command;
}

}  // namespace parian

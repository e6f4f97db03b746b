// parian simulate: a described sample -> a table. The result is simulated, and says so.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "acquire/sample.h"
#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "base/error.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/json.h"

namespace parian {
namespace {

enum class Engine { analytic, photon };

struct SimulateOptions {
  std::string sample, output;
  Engine engine = Engine::analytic;
  int seed = -1;
  int deflate = 0;
};

ParamList describe(SimulateOptions& options) {
  return {{.name = "engine",
           .help = "how light is followed",
           .target = make_choice(options.engine, {"analytic", "photon"})},
          {.name = "seed",
           .help = "of the layout's random numbers, instead of the description's (-1: that one)",
           .target = &options.seed,
           .min = -1},
          {.name = "deflate",
           .help = "compression of the table, 0 for none",
           .target = &options.deflate,
           .min = 0,
           .max = 9}};
}

void simulate(const SimulateOptions& options, const Context& context) {
  if (options.engine == Engine::photon)
    throw Error({{}, "--engine", "analytic (photon simulation comes later)", "photon"},
                ErrorKind::usage);
  check_output(options.output, {options.sample});
  const std::filesystem::path folder = std::filesystem::path(options.sample).parent_path();
  const Sample sample = read_sample(
      load_document(options.sample),
      [&](const std::string& path) { return load_image((folder / path).string()); }, options.seed);
  const std::unique_ptr<SliceSource> source = make_analytic_source(sample);
  const TableHeader& header = source->header();
  const auto sink = create_table(options.output, header, {options.deflate});
  copy_slices(*source, *sink, context.progress);
  print_summary(
      context,
      fmt::format("{}: simulated table, {} x {} pixels of {} mm, {} offsets, {} channels\n",
                  options.output, header.width, header.height, header.pixel_pitch_mm,
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
      {"output", 'o', "TABLE.h5", "table to write", &options->output, /*required=*/true}};
  command.params = describe(*options);
  command.run = [options](const Context& context) { simulate(*options, context); };
  return command;
}

}  // namespace parian

// parian fit: a table -> a profile map (SubEdit 2009, section 4.3).
#include "fit/fit.h"

#include <fmt/format.h>

#include <memory>

#include "app/cli/command.h"
#include "app/cli/inputs.h"
#include "app/cli/output.h"
#include "app/report/provenance.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"

namespace parian {
namespace {

struct FitOptions {
  std::string table, output;
  FitParams params;
};

std::string summarise(const FitResult& result, const FitOptions& options) {
  const ProfileMap& map = result.map;
  const FitReport& report = result.report;
  std::string text = fmt::format("{}: {} x {} profiles of {} knots, {} channels\n", options.output,
                                 map.width, map.height, map.knots_mm.size(), map.channels);
  for (std::size_t c = 0; c < report.channels.size(); ++c) {
    const FitChannelReport& channel = report.channels[c];
    text += fmt::format(
        "  channel {}: energy {:.6g} ({:.6g} non-increasing, {} profiles touched), "
        "{} iterations to {:.1e}, {} pairs, {} missing\n",
        c, channel.energy, channel.energy_monotone, channel.profiles_touched, channel.iterations,
        channel.relative_residual, channel.pairs, channel.missing);
    if (channel.steps > 0)
      text += fmt::format("    by the noise model, {} passes over the table; {} values <= 0\n",
                          channel.steps, channel.not_positive);
    else if (channel.not_positive > 0)
      text += fmt::format("    {} values <= 0 left out\n", channel.not_positive);
  }
  if (report.pixels_filled > 0)
    text += fmt::format("  {} pixels without a measured pair filled\n", report.pixels_filled);
  for (const FitChannelReport& channel : report.channels)
    if (!channel.converged)
      text +=
          channel.steps > 0
              ? std::string("  steps still large at the last pass: lower spread\n")
              : fmt::format("  not solved to the tolerance of {}: raise max-iterations or lambda\n",
                            options.params.tolerance);
  return text + fmt::format("  seconds: {:.2f} reading, {:.2f} solving, {:.2f} non-increasing\n",
                            report.seconds_stream, report.seconds_solve, report.seconds_monotone);
}

void fit(const FitOptions& options, const Context& context) {
  check_output(options.output, {options.table});
  const std::unique_ptr<SliceSource> table = open_table(options.table);
  FitResult result = fit_profiles(*table, options.params, context.progress);
  result.map.provenance = make_fit_provenance(*table, options.params);
  save_profile_map(options.output, result.map);
  write_figures(context, to_document(result.report));
  print_summary(context, summarise(result, options));
}

}  // namespace

CommandSpec make_fit_command() {
  const auto options = std::make_shared<FitOptions>();
  CommandSpec command;
  command.name = "fit";
  command.summary = "fit scattering profiles to a table";
  command.example = "parian fit stone.h5 -o stone-map.h5 --segments 24 --lambda 0.01";
  command.positionals = {{"TABLE.h5", "measured or simulated table", &options->table}};
  command.flags = {
      {"output", 'o', "MAP.h5", "profile map to write", &options->output, /*required=*/true}};
  command.params = describe(options->params);
  command.has_figures = true;
  command.run = [options](const Context& context) { fit(*options, context); };
  return command;
}

}  // namespace parian

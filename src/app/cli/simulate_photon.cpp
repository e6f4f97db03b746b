#include "app/cli/simulate_photon.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/cli/output.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "io/hdf5/photon_file.h"
#include "io/hdf5/table_file.h"

namespace parian {
namespace {

void take_up(PhotonSimulation& simulation, const std::string& partial, const Context& context) {
  if (!std::filesystem::exists(partial)) return;
  try {
    simulation.resume(load_photon_progress(partial, simulation));
  } catch (const Error& error) {
    if (!context.quiet)
      fmt::print(stderr, "parian: warning: {}; the simulation starts anew\n", error.what());
  }
}

// Returns the seconds it took.
double run_rounds(PhotonSimulation& simulation, const PhotonRun& run, const std::string& partial,
                  const Context& context) {
  Stopwatch watch;
  double seconds = 0, stored = 0;
  try {
    while (!simulation.is_done()) {
      advance_progress(context.progress, "photons", simulation.done());
      simulation.advance();
      seconds += watch.lap();
      if (seconds - stored < run.checkpoint_s) continue;
      save_photon_progress(partial, simulation);
      watch.lap();
      stored = seconds;
    }
  } catch (const Error& error) {
    if (error.kind == ErrorKind::cancelled && simulation.progress().steps > 0)
      save_photon_progress(partial, simulation);
    throw;
  }
  return seconds;
}

Document to_document(const PhotonEstimate& estimate) {
  return Document::Object{{"value", estimate.value}, {"standard_error", estimate.error}};
}

Document to_document(const PhotonReport& report, const TableHeader& header, double per_second) {
  Document::Array channels;
  for (std::size_t c = 0; c < report.channels.size(); ++c) {
    const PhotonReport::Channel& channel = report.channels[c];
    channels.push_back(Document::Object{{"specular", to_document(channel.specular)},
                                        {"reflected", to_document(channel.reflected)},
                                        {"transmitted", to_document(channel.transmitted)},
                                        {"absorbed", to_document(channel.absorbed)},
                                        {"roulette", channel.roulette},
                                        {"balance", channel.balance},
                                        {"noise_floor", header.noise_floor[c]},
                                        {"noise_gain", header.noise_gain[c]}});
  }
  return Document::Object{{"photons", report.photons},
                          {"flights", report.flights},
                          {"rounds", static_cast<double>(report.rounds)},
                          {"photons_per_second", per_second},
                          {"median_offset_mm", report.median_offset_mm},
                          {"median_relative_error", report.median_error},
                          {"asymmetry", report.asymmetry},
                          {"expected_asymmetry", report.expected_asymmetry},
                          {"empty_pairs", static_cast<double>(report.empty_pairs)},
                          {"channels", std::move(channels)}};
}

std::string summarise(const PhotonReport& report, const TableHeader& header,
                      const std::string& output, double per_second) {
  std::string text = fmt::format(
      "{}: simulated table, {} x {} pixels of {} mm, {} offsets, {} channels\n"
      "  {:.4g} photons, {:.0f} per ms, {:.0f} flights each\n",
      output, header.width, header.height, header.pixel_pitch_mm, header.offsets.size(),
      header.channels, report.photons, per_second / 1000, report.flights / report.photons);
  for (std::size_t c = 0; c < report.channels.size(); ++c) {
    const PhotonReport::Channel& channel = report.channels[c];
    text += fmt::format(
        "  channel {}: {:.5f} ± {:.5f} reflected, {:.5f} transmitted, {:.5f} absorbed, {:.5f} "
        "specular\n",
        c, channel.reflected.value, channel.reflected.error, channel.transmitted.value,
        channel.absorbed.value, channel.specular.value);
  }
  return text + fmt::format(
                    "  standard error at {:.3g} mm: {:.1f} %; asymmetry {:.2f} % ({:.2f} % from "
                    "noise); {} pairs without a photon\n",
                    report.median_offset_mm, 100 * report.median_error, 100 * report.asymmetry,
                    100 * report.expected_asymmetry, report.empty_pairs);
}

}  // namespace

void simulate_photons(const Sample& sample, const PhotonRun& run, const Context& context) {
  PhotonSimulation simulation(sample, run.params);
  const std::string partial = run.output + ".partial";
  take_up(simulation, partial, context);
  const double before = make_report(simulation).photons;
  const double seconds = run_rounds(simulation, run, partial, context);
  const std::unique_ptr<SliceSource> source = make_photon_source(simulation);
  const auto sink = create_table(run.output, source->header(), {run.deflate});
  copy_slices(*source, *sink, context.progress);
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  const PhotonReport report = make_report(simulation);
  const double per_second = seconds > 0 ? (report.photons - before) / seconds : 0;
  write_figures(context, to_document(report, source->header(), per_second));
  print_summary(context, summarise(report, source->header(), run.output, per_second));
}

}  // namespace parian

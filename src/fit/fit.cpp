#include "fit/fit.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "fit/monotone.h"
#include "fit/noise_fit.h"
#include "fit/solve.h"

namespace parian {
namespace {

// What channels with equal weights share.
struct SharedSolver {
  ReducedSystem geometry;  // weights and offsets only
  Hessian hessian;
  Preconditioner preconditioner;
};

ReducedSystem without_data(const ReducedSystem& system) {
  ReducedSystem geometry;
  geometry.width = system.width;
  geometry.height = system.height;
  geometry.knots_mm = system.knots_mm;
  geometry.offsets = system.offsets;
  geometry.pair_count = system.pair_count;
  geometry.weights = system.weights;
  geometry.restream = system.restream;
  return geometry;
}

// Nearest pixel (in steps of 4 neighbours, ties in scan order) that is not in `holes`, for all
// pixels.
std::vector<std::uint32_t> nearest_measured(const ReducedSystem& system,
                                            const std::vector<std::uint32_t>& holes) {
  constexpr std::uint32_t none = ~0u;
  std::vector<std::uint32_t> nearest(system.pixels());
  for (std::uint32_t i = 0; i < nearest.size(); ++i) nearest[i] = i;
  for (std::uint32_t hole : holes) nearest[hole] = none;
  std::deque<std::uint32_t> front;
  for (std::uint32_t i = 0; i < nearest.size(); ++i)
    if (nearest[i] != none) front.push_back(i);
  const int width = system.width, height = system.height;
  for (; !front.empty(); front.pop_front()) {
    const int x = static_cast<int>(front.front()) % width,
              y = static_cast<int>(front.front()) / width;
    for (const auto& [nx, ny] : {std::pair{x, y - 1}, {x - 1, y}, {x + 1, y}, {x, y + 1}}) {
      if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
      const auto neighbour = static_cast<std::uint32_t>(ny * width + nx);
      if (nearest[neighbour] != none) continue;
      nearest[neighbour] = nearest[front.front()];
      front.push_back(neighbour);
    }
  }
  return nearest;
}

std::size_t fill_holes(const SliceSource& table, const ReducedSystem& system,
                       std::vector<double>& p) {
  const std::vector<std::uint32_t> holes = unmeasured_pixels(system);
  if (holes.size() == system.pixels())
    throw Error({table.name(), "reflectance", "at least one measured pair", "none"});
  const std::vector<std::uint32_t> nearest = nearest_measured(system, holes);
  for (std::size_t k = 0; k < system.knots(); ++k)
    for (std::uint32_t hole : holes)
      p[k * system.pixels() + hole] = p[k * system.pixels() + nearest[hole]];
  return holes.size();
}

ProfileMap make_map(const TableHeader& header, const FitParams& params,
                    std::vector<double> knots_mm) {
  ProfileMap map = make_profile_map(header.width, header.height, header.channels,
                                    header.pixel_pitch_mm, std::move(knots_mm));
  map.boundary = header.boundary;
  map.eta = header.eta;
  map.hold_out = {params.hold_out, params.seed};
  return map;
}

void store(const std::vector<double>& p, int channel, ProfileMap& map) {
  float* target = knot_plane(map, channel, 0);
  parallel_for(map.knots_mm.size(), [&](std::size_t k) {
    for (std::size_t i = k * map.pixels(); i < (k + 1) * map.pixels(); ++i)
      target[i] = static_cast<float>(p[i]);
  });
}

void refuse_bad_solution(const SliceSource& table, int channel, const SolveReport& report) {
  if (std::isfinite(report.energy) && std::isfinite(report.relative_residual)) return;
  throw Error({table.name(), "channel " + std::to_string(channel), "a finite solution",
               "a system that rounding made unsolvable; raise lambda"});
}

Progress part_of(const Progress& progress, int channel, int channels) {
  if (!progress.report) return progress;
  Progress part = progress;
  part.report = [&progress, channel, channels](std::string_view stage, double done) {
    // Reading takes about half of a channel's time, solving the rest.
    const double within = stage == "reading the table" ? 0.5 * done : 0.5 + 0.5 * done;
    progress.report(stage, (channel + within) / channels);
  };
  return part;
}

// Everything that goes on from channel to channel.
struct Run {
  const SliceSource& table;
  const FitParams& params;
  const ReducedParams& reduced;
  FitResult& result;
  Stopwatch watch;
  std::optional<SharedSolver> shared;
  std::vector<double> p;
  SolveStart start;
};

void count_pairs(const ReducedSystem& system, FitChannelReport& report) {
  report.pairs = system.pairs;
  report.missing = system.not_measured;
  report.not_positive = system.not_positive;
  report.held_out = system.held_out;
}

// Fills and projects p, and stores it. `energy` gives E of a changed p.
void finish_channel(Run& run, const ReducedSystem& system, FitChannelReport report,
                    const std::function<double()>& energy) {
  FitReport& all = run.result.report;
  if (run.params.fill_unmeasured) all.pixels_filled += fill_holes(run.table, system, run.p);
  if (run.params.monotone) {
    report.profiles_touched = project_monotone(system, run.p);
    if (report.profiles_touched > 0) report.energy_monotone = energy();
    all.seconds_monotone += run.watch.lap();
  }
  store(run.p, system.channel, run.result.map);
  all.channels.push_back(report);
}

void fit_logarithms(Run& run, int channel, const Progress& progress) {
  const FitParams& params = run.params;
  const ReducedSystem system = make_reduced_system(run.table, channel, run.reduced, progress);
  run.result.report.seconds_stream += run.watch.lap();
  if (!run.shared || !shares_hessian(system, run.shared->geometry)) {
    run.shared.reset();  // free before the next is made
    run.start.product = {};
    const bool exact = params.tolerance < single_precision_tolerance;
    Hessian hessian = make_hessian(system, ProductMethod::automatic, exact);
    Preconditioner preconditioner = make_preconditioner(system, hessian);
    run.shared.emplace(
        SharedSolver{without_data(system), std::move(hessian), std::move(preconditioner)});
  }
  const std::vector<double> profile = fit_mean_profile(system);
  if (run.start.deviation.empty()) run.p = make_constant_field(system, profile);
  const SolveReport solved = solve_reduced(system, run.shared->hessian, run.shared->preconditioner,
                                           {params.tolerance, params.max_iterations}, profile,
                                           run.p, progress, &run.start);
  refuse_bad_solution(run.table, channel, solved);
  run.result.report.seconds_solve += run.watch.lap();

  FitChannelReport report;
  report.energy = report.energy_monotone = solved.energy;
  report.iterations = solved.iterations;
  report.relative_residual = solved.relative_residual;
  report.converged = solved.relative_residual <= params.tolerance;
  count_pairs(system, report);
  finish_channel(run, system, report,
                 [&] { return eval_energy(system, run.shared->hessian, run.p.data()); });
}

void fit_with_noise(Run& run, int channel, const Progress& progress) {
  NoisyFitParams noisy;
  noisy.spread = run.params.spread;
  noisy.max_iterations = run.params.max_iterations;
  NoisyFit fit = fit_noisy(run.table, channel, run.reduced, noisy, progress);
  run.p = std::move(fit.p);
  FitChannelReport report;
  report.energy = report.energy_monotone = eval_noisy_energy(run.table, run.reduced, fit, run.p);
  report.iterations = fit.iterations;
  report.steps = fit.steps;
  report.relative_residual = fit.relative_residual;
  report.converged = fit.last_step <= noisy.tolerance;
  refuse_bad_solution(run.table, channel, {fit.iterations, fit.relative_residual, report.energy});
  count_pairs(fit.system, report);
  run.result.report.seconds_solve += run.watch.lap();
  finish_channel(run, fit.system, report,
                 [&] { return eval_noisy_energy(run.table, run.reduced, fit, run.p); });
}

// Whether the fit goes by the table's noise model.
bool uses_noise(const SliceSource& table, const FitParams& params) {
  if (params.noise_model && table.header().has_noise_model()) return true;
  if (params.weight == PairWeight::noise)
    throw Error({table.name(), "weight 'noise'",
                 "a table with a noise model (noise_floor, noise_gain)",
                 table.header().has_noise_model() ? "--no-noise-model" : "none"});
  return false;
}

}  // namespace

FitResult fit_profiles(const SliceSource& table, const FitParams& params,
                       const Progress& progress) {
  FitParams checked = params;
  check(describe(checked));
  const TableHeader& header = table.header();
  ReducedParams reduced;
  reduced.knots_mm = make_knots(header, params);
  reduced.lambda = params.lambda;
  reduced.weight = params.weight;
  reduced.hold_out = {params.hold_out, params.seed};
  reduced.allow_unmeasured = params.fill_unmeasured;

  FitResult result{make_map(header, params, reduced.knots_mm), {}};
  Run run{table, params, reduced, result, {}, {}, {}, {}};
  const bool noisy = uses_noise(table, params);
  for (int channel = 0; channel < header.channels; ++channel) {
    const Progress part = part_of(progress, channel, header.channels);
    noisy ? fit_with_noise(run, channel, part) : fit_logarithms(run, channel, part);
  }
  return result;
}

Document to_document(const FitReport& report) {
  Document document{Document::Object{}};
  Document::Array channels;
  for (const FitChannelReport& channel : report.channels) {
    Document entry{Document::Object{}};
    set(entry, "energy", channel.energy);
    set(entry, "energy_monotone", channel.energy_monotone);
    set(entry, "relative_residual", channel.relative_residual);
    set(entry, "converged", channel.converged);
    set(entry, "iterations", channel.iterations);
    set(entry, "steps", channel.steps);
    set(entry, "pairs", channel.pairs);
    set(entry, "missing", channel.missing);
    set(entry, "not_positive", channel.not_positive);
    set(entry, "held_out", channel.held_out);
    set(entry, "profiles_touched", channel.profiles_touched);
    channels.push_back(std::move(entry));
  }
  set(document, "channels", std::move(channels));
  set(document, "pixels_filled", report.pixels_filled);
  Document seconds{Document::Object{}};
  set(seconds, "stream", report.seconds_stream);
  set(seconds, "solve", report.seconds_solve);
  set(seconds, "monotone", report.seconds_monotone);
  set(document, "seconds", std::move(seconds));
  return document;
}

}  // namespace parian

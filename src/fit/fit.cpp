#include "fit/fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "fit/monotone.h"
#include "fit/solve.h"

namespace parian {
namespace {

class Stopwatch {
 public:
  // Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

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
  std::optional<SharedSolver> shared;
  std::vector<double> p;
  SolveStart start;
  for (int channel = 0; channel < header.channels; ++channel) {
    const Progress part = part_of(progress, channel, header.channels);
    Stopwatch watch;
    FitChannelReport report;
    const ReducedSystem system = make_reduced_system(table, channel, reduced, part);
    result.report.seconds_stream += watch.lap();

    if (!shared || !shares_hessian(system, shared->geometry)) {
      shared.reset();  // free before the next is made
      start.product = {};
      const bool exact = params.tolerance < single_precision_tolerance;
      Hessian hessian = make_hessian(system, ProductMethod::automatic, exact);
      Preconditioner preconditioner = make_preconditioner(system, hessian);
      shared.emplace(
          SharedSolver{without_data(system), std::move(hessian), std::move(preconditioner)});
    }
    const std::vector<double> profile = fit_mean_profile(system);
    if (start.deviation.empty()) p = make_constant_field(system, profile);
    const SolveReport solved =
        solve_reduced(system, shared->hessian, shared->preconditioner,
                      {params.tolerance, params.max_iterations}, profile, p, part, &start);
    refuse_bad_solution(table, channel, solved);
    result.report.seconds_solve += watch.lap();

    report.energy = report.energy_monotone = solved.energy;
    report.iterations = solved.iterations;
    report.relative_residual = solved.relative_residual;
    report.pairs = system.pairs;
    report.missing = system.not_measured;
    report.not_positive = system.not_positive;
    report.held_out = system.held_out;
    if (params.fill_unmeasured) result.report.pixels_filled += fill_holes(table, system, p);
    if (params.monotone) {
      report.profiles_touched = project_monotone(system, p);
      if (report.profiles_touched > 0)
        report.energy_monotone = eval_energy(system, shared->hessian, p.data());
      result.report.seconds_monotone += watch.lap();
    }
    store(p, channel, result.map);
    result.report.channels.push_back(report);
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
    set(entry, "iterations", channel.iterations);
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

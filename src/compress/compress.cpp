#include "compress/compress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "compress/assign.h"
#include "compress/log_objective.h"
#include "compress/pair_objective.h"
#include "fit/noise_fit.h"
#include "fit/reduced_system.h"
#include "material/bssrdf_table.h"
#include "material/material.h"
#include "math/isotonic.h"

namespace parian {
namespace {

// Weights of the two errors, e^2 and a^2, for each objective.
struct ErrorWeights {
  float relative, albedo;
};
ErrorWeights weights_of(Objective objective) {
  if (objective == Objective::relative) return {1, 0};
  if (objective == Objective::albedo) return {0.03f, 1};
  return {1, 1};
}

// Profiles that rise, as a fit may leave them, become the nearest that do not: no base may rise.
void lower_rises(ProfileMap& map) {
  const std::vector<double> weights(map.knots_mm.size(), 1.0);
  parallel_for_blocks(map.pixels(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<double> values(map.knots_mm.size());
    for (int c = 0; c < map.channels; ++c)
      for (std::size_t i = begin; i < end; ++i) {
        for (std::size_t k = 0; k < values.size(); ++k)
          values[k] = static_cast<double>(knot_plane(map, c, static_cast<int>(k))[i]);
        if (!make_non_increasing(values, weights)) continue;
        for (std::size_t k = 0; k < values.size(); ++k)
          knot_plane(map, c, static_cast<int>(k))[i] = static_cast<float>(values[k]);
      }
  });
}

// Gain and dilation written into the profiles, at the same knots.
void bake_edits(ProfileMap& flat, const ProfileMap& map) {
  flat.gain.clear();
  flat.dilation.clear();
  for (int c = 0; c < map.channels; ++c)
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x) {
        Profile profile = get_profile(map, c, x, y);
        profile.support_mm = std::numeric_limits<double>::infinity();
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
            static_cast<std::size_t>(x);
        for (std::size_t k = 0; k < map.knots_mm.size(); ++k)
          knot_plane(flat, c, static_cast<int>(k))[pixel] =
              static_cast<float>(eval_log_profile(profile, map.knots_mm[k]));
      }
}

// What a blend can take on.
ProfileMap flatten(const ProfileMap& map) {
  ProfileMap flat = map;
  if (!map.gain.empty() || !map.dilation.empty()) bake_edits(flat, map);
  lower_rises(flat);
  return flat;
}

ProfileMap without_values(const ProfileMap& map) {
  ProfileMap header;
  header.width = map.width;
  header.height = map.height;
  header.channels = map.channels;
  header.pixel_pitch_mm = map.pixel_pitch_mm;
  header.boundary = map.boundary;
  header.eta = map.eta;
  header.knots_mm = map.knots_mm;
  header.hold_out = map.hold_out;
  return header;
}

// Pairs that count: the table's, or all, within the last knot.
std::vector<Offset> list_offsets(const ProfileMap& map, const SliceSource* table) {
  const double radius = map.knots_mm.back() / map.pixel_pitch_mm * (1 + 1e-9);
  const double reach = std::hypot(map.width, map.height);
  std::vector<Offset> offsets;
  for (Offset d :
       table == nullptr ? half_disc_offsets(std::min(radius, reach)) : table->header().offsets) {
    const bool in_half_plane = d.dy > 0 || (d.dy == 0 && d.dx >= 0);
    if (in_half_plane && length_px(d) <= radius && std::abs(d.dx) < map.width && d.dy < map.height)
      offsets.push_back(d);
  }
  return offsets;
}

// Logarithms of the table, or, where it has a noise model, the fit's quadratic about the map.
BlendObjective make_paper_objective(const ProfileMap& map, const SliceSource& table,
                                    const Progress& progress) {
  ReducedParams reduced;
  reduced.knots_mm = map.knots_mm;
  reduced.lambda = 0;
  reduced.weight = PairWeight::inverse_quadratic;
  reduced.hold_out = map.hold_out;
  reduced.allow_unmeasured = true;
  std::vector<ReducedSystem> systems;
  const std::size_t unknowns = map.knots_mm.size() * map.pixels();
  for (int c = 0; c < map.channels; ++c) {
    const float* from = map.log_profile.data() + static_cast<std::size_t>(c) * unknowns;
    systems.push_back(table.header().has_noise_model()
                          ? make_noisy_system(table, c, reduced, {from, from + unknowns}, progress)
                          : make_reduced_system(table, c, reduced, progress));
  }
  return make_log_objective(std::move(systems));
}

BlendObjective make_objective(const ProfileMap& map, const SliceSource* table, Objective objective,
                              const Progress& progress) {  // of a flat map
  const std::vector<Offset> offsets = list_offsets(map, table);
  if (objective != Objective::paper) {
    const ErrorWeights each = weights_of(objective);
    const PixelWeights weights{std::vector<float>(map.pixels(), each.relative),
                               std::vector<float>(map.pixels(), each.albedo)};
    return make_pair_objective(map, offsets, weights, table, progress);
  }
  if (table != nullptr) return make_paper_objective(map, *table, progress);
  const Material material = map;
  TableHeader like = natural_header(material);
  like.offsets = offsets;
  return make_paper_objective(map, *make_slices(material, like), progress);
}

OptimiseParams make_optimise_params(const ProfileMap& map, const CompressParams& params,
                                    int per_pixel) {
  OptimiseParams optimise;
  optimise.bases = std::min(static_cast<std::size_t>(params.bases), map.pixels());
  optimise.per_pixel = static_cast<std::size_t>(per_pixel);
  optimise.width = map.width;
  optimise.rounds = params.rounds;
  optimise.tolerance = params.tolerance;
  optimise.seed = params.seed;
  return optimise;
}

Mixture make_mixture(const ProfileBlend& blend, const RowShape& shape) {
  Mixture mixture;
  mixture.shape = shape;
  mixture.per_pixel = static_cast<std::size_t>(blend.per_pixel);
  const std::size_t row = shape.channels * shape.knots, per_pixel = mixture.per_pixel;
  mixture.bases.assign(blend.bases() * shape.stride(), 0.0f);
  for (std::size_t j = 0; j < blend.bases(); ++j)
    std::copy_n(&blend.base_log_profile[j * row], row, mixture.base(j));
  mixture.index.resize(shape.pixels * per_pixel);
  mixture.weight.resize(shape.pixels * per_pixel);
  for (std::size_t x = 0; x < shape.pixels; ++x) {
    get_weights(blend, x, &mixture.weight[x * per_pixel]);
    for (std::size_t k = 0; k < per_pixel; ++k)
      mixture.index[x * per_pixel + k] = blend.index[k * shape.pixels + x];
  }
  return mixture;
}

void check_start(const ProfileMap& map, const CompressParams& params, const ProfileBlend& start) {
  if (start.width != map.width || start.height != map.height || start.channels != map.channels ||
      start.knots_mm != map.knots_mm)
    throw Error({{},
                 "start",
                 fmt::format("a blend of {} x {} pixels, {} channels and the fit's {} knots",
                             map.width, map.height, map.channels, map.knots_mm.size()),
                 fmt::format("{} x {} pixels, {} channels, {} knots", start.width, start.height,
                             start.channels, start.knots_mm.size())});
  if (start.per_pixel > params.per_pixel)
    throw Error({{},
                 "start",
                 fmt::format("at most {} bases per pixel", params.per_pixel),
                 fmt::format("{}", start.per_pixel)});
}

void check_table(const ProfileMap& map, const SliceSource& table) {
  const TableHeader& header = table.header();
  if (header.width != map.width || header.height != map.height || header.channels != map.channels)
    throw Error(
        {table.name(), "grid",
         fmt::format("{} x {} pixels, {} channels, as the map", map.width, map.height,
                     map.channels),
         fmt::format("{} x {} pixels, {} channels", header.width, header.height, header.channels)});
}

bool wants_grid(const CompressParams& params) {
  return params.weight_levels > 0 || params.profile_step > 0;
}

// On with the present mixture, moved to the lattice.
void begin_grid(CompressState& state) {
  ProfileBlend blend = make_blend(state);
  snap_to_grid(blend, {state.params.profile_step, state.params.weight_levels});
  OptimiseParams params = state.run.params;
  params.weight_levels = state.params.weight_levels;
  params.fixed_bases = state.params.profile_step > 0;
  state.run =
      make_optimise_state(*state.objective, make_mixture(blend, state.objective->shape), params);
  state.on_grid = true;
}

}  // namespace

std::shared_ptr<const BlendObjective> make_blend_objective(const ProfileMap& map,
                                                           const SliceSource* table,
                                                           Objective objective,
                                                           const Progress& progress) {
  if (table != nullptr) check_table(map, *table);
  return std::make_shared<const BlendObjective>(
      make_objective(flatten(map), table, objective, progress));
}

CompressState make_compress_state(const ProfileMap& map,
                                  std::shared_ptr<const BlendObjective> objective,
                                  const CompressParams& params, const ProfileBlend* start) {
  CompressParams checked = params;
  check(describe(checked));
  if (start != nullptr) check_start(map, params, *start);
  CompressState state;
  state.params = params;
  state.header = without_values(map);
  state.objective = std::move(objective);
  const RowShape& shape = state.objective->shape;
  const int per_pixel = start != nullptr ? start->per_pixel : std::min(2, params.per_pixel);
  const OptimiseParams optimise = make_optimise_params(map, params, per_pixel);
  if (start != nullptr)
    state.run = make_optimise_state(*state.objective, make_mixture(*start, shape), optimise);
  else
    state.run = make_optimise_state(*state.objective,
                                    make_rows(shape, flatten(map).log_profile.data()), optimise);
  state.history = state.run.history;
  return state;
}

void advance(CompressState& state) {
  if (state.done) return;
  if (!state.run.done) {
    advance(*state.objective, state.run);
  } else if (!state.on_grid &&
             static_cast<int>(state.run.params.per_pixel) < state.params.per_pixel) {
    OptimiseParams params = state.run.params;
    ++params.per_pixel;
    state.run = make_optimise_state(*state.objective, std::move(state.run.mixture), params);
    if (state.run.done) return;
    advance(*state.objective, state.run);
  } else if (!state.on_grid && wants_grid(state.params)) {
    begin_grid(state);
  } else {
    state.done = true;
    return;
  }
  state.history.push_back(state.run.history.back());
}

ProfileBlend make_blend(const CompressState& state) {
  const Mixture& mixture = state.run.mixture;
  const RowShape& shape = mixture.shape;
  ProfileBlend blend;
  blend.width = state.header.width;
  blend.height = state.header.height;
  blend.channels = state.header.channels;
  blend.per_pixel = static_cast<int>(mixture.per_pixel);
  blend.pixel_pitch_mm = state.header.pixel_pitch_mm;
  blend.boundary = state.header.boundary;
  blend.eta = state.header.eta;
  blend.knots_mm = state.header.knots_mm;
  blend.hold_out = state.header.hold_out;
  const std::size_t row = shape.channels * shape.knots;
  for (std::size_t j = 0; j < mixture.base_count(); ++j)
    blend.base_log_profile.insert(blend.base_log_profile.end(), mixture.base(j),
                                  mixture.base(j) + row);
  blend.index.resize(mixture.index.size());
  blend.weight.resize(shape.pixels * (mixture.per_pixel - 1));
  for (std::size_t x = 0; x < shape.pixels; ++x)
    for (std::size_t k = 0; k < mixture.per_pixel; ++k) {
      blend.index[k * shape.pixels + x] = mixture.index[x * mixture.per_pixel + k];
      if (k + 1 < mixture.per_pixel)
        blend.weight[k * shape.pixels + x] = mixture.weight[x * mixture.per_pixel + k];
    }
  if (state.on_grid) blend.grid = {state.params.profile_step, state.params.weight_levels};
  return blend;
}

CompressErrors estimate_errors(const CompressState& state) {
  PixelErrors errors;
  eval_energy(*state.objective, state.run.mixture, &errors);
  const auto mean_root = [](const std::vector<float>& squares) {
    double sum = 0;
    for (float value : squares) sum += std::sqrt(std::max(0.0, static_cast<double>(value)));
    return sum / static_cast<double>(squares.size());  // of no values: NaN
  };
  return {mean_root(errors.relative), mean_root(errors.albedo)};
}

double progress_of(const CompressState& state) {
  if (state.done) return 1;
  const double stages =
      std::max(1, state.params.per_pixel - 1) + (wants_grid(state.params) ? 1 : 0);
  const double stage = state.on_grid
                           ? stages - 1
                           : std::max(0.0, static_cast<double>(state.run.params.per_pixel) - 2);
  const double within =
      std::min(1.0, static_cast<double>(state.run.round) / std::max(1, state.params.rounds));
  return (stage + within) / stages;
}

ProfileBlend compress_profiles(const ProfileMap& map, const SliceSource* table,
                               const CompressParams& params, const Progress& progress,
                               CompressReport* report) {
  const Stopwatch watch;
  CompressState state = make_compress_state(
      map, make_blend_objective(map, table, params.objective, progress), params);
  while (!state.done) {
    advance(state);
    advance_progress(progress, "compressing", progress_of(state));
  }
  if (report != nullptr) {
    report->rounds = state.history;
    report->energy = state.run.energy;
    report->seconds = watch.seconds();
  }
  return make_blend(state);
}

Document to_document(const CompressReport& report) {
  Document document{Document::Object{}};
  Document::Array rounds;
  for (const RoundReport& round : report.rounds) {
    Document entry{Document::Object{}};
    set(entry, "per_pixel", round.per_pixel);
    set(entry, "energy", round.energy);
    set(entry, "accepted", round.accepted);
    rounds.push_back(std::move(entry));
  }
  set(document, "energy", report.energy);
  set(document, "seconds", report.seconds);
  set(document, "rounds", std::move(rounds));
  return document;
}

}  // namespace parian

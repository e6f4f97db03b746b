#include "compress/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace parian {
namespace {

constexpr int short_rounds = 3;

// From small to large.
struct Size {
  int per_pixel, bases;
};
constexpr std::array<Size, 16> ladder{{{1, 8},
                                       {1, 32},
                                       {2, 8},
                                       {2, 16},
                                       {2, 32},
                                       {2, 64},
                                       {2, 128},
                                       {2, 256},
                                       {3, 128},
                                       {3, 256},
                                       {4, 256},
                                       {5, 256},
                                       {6, 256},
                                       {7, 256},
                                       {8, 256},
                                       {8, 1024}}};

// What a run with few rounds comes to.
struct Trial {
  CompressParams params;
  std::size_t bytes = 0;
  double energy = 0;
  double error = 0;  // mean, relative
};

class Trials {
 public:
  Trials(const ProfileMap& map, std::shared_ptr<const BlendObjective> objective,
         const CompressParams& params, bool packed, const BlendMeasures& measures,
         const Progress& progress)
      : map_(map),
        objective_(std::move(objective)),
        params_(params),
        packed_(packed),
        measures_(measures),
        progress_(progress) {}

  ProfileBlend compress(Size size, CompressParams& params) {
    params = params_;
    params.per_pixel = size.per_pixel;
    params.bases = static_cast<int>(std::min(static_cast<std::size_t>(size.bases), map_.pixels()));
    params.rounds = short_rounds;
    if (packed_) set_lattice(params);
    CompressState state = make_compress_state(map_, objective_, params);
    while (!state.done) {
      advance(state);
      advance_progress(progress_, "choosing sizes", std::min(0.99, 0.05 * ++steps_));
    }
    params.rounds = params_.rounds;
    energy_ = state.run.energy;
    return make_blend(state);
  }

  Trial measure_size(Size size) {
    Trial trial;
    trial.bytes = measures_.bytes(compress(size, trial.params));
    trial.energy = energy_;
    return trial;
  }
  Trial measure_error(Size size) {
    Trial trial;
    trial.error = measures_.error(compress(size, trial.params));
    return trial;
  }

 private:
  static void set_lattice(CompressParams& params) {
    if (params.weight_levels == 0) params.weight_levels = default_weight_levels;
    if (params.profile_step == 0) params.profile_step = default_profile_step;
  }

  const ProfileMap& map_;
  std::shared_ptr<const BlendObjective> objective_;
  CompressParams params_;
  bool packed_;
  const BlendMeasures& measures_;
  const Progress& progress_;
  double steps_ = 0, energy_ = 0;
};

// The largest number of bases that fits, for one K: size grows with M nearly linearly.
std::vector<Trial> fit_bases(Trials& trials, int per_pixel, std::size_t max_bytes) {
  std::vector<Trial> fitting;
  int low = 1, high = 1024;  // low fits or is 1
  for (int bases = 64; low < high;) {
    Trial trial = trials.measure_size({per_pixel, bases});
    const bool fits = trial.bytes <= max_bytes;
    if (fits) {
      low = std::max(low, bases);
      fitting.push_back(trial);
    } else {
      high = bases - 1;
    }
    if (fits && trial.params.bases < bases) break;  // no more pixels
    const int next = fits ? std::min(high, bases * 2) : (low + high + 1) / 2;
    // Good enough when the step left is small.
    if (next == bases || high - low < std::max(2, low / 8)) break;
    bases = next;
  }
  return fitting;
}

CompressParams choose_for_bytes(Trials& trials, std::size_t max_bytes) {
  std::vector<Trial> fitting;
  for (int per_pixel = 1; per_pixel <= 4; ++per_pixel) {
    const std::vector<Trial> found = fit_bases(trials, per_pixel, max_bytes);
    if (found.empty() && per_pixel > 1) break;  // more bases per pixel take even more
    fitting.insert(fitting.end(), found.begin(), found.end());
  }
  if (fitting.empty())
    throw Error({{},
                 "--max-bytes",
                 fmt::format("at least {} for one base", trials.measure_size({1, 1}).bytes),
                 fmt::format("{}", max_bytes)});
  return std::min_element(fitting.begin(), fitting.end(),
                          [](const Trial& a, const Trial& b) { return a.energy < b.energy; })
      ->params;
}

CompressParams choose_for_error(Trials& trials, double max_error) {
  std::size_t low = 0, high = ladder.size();  // the first that is good enough is in [low, high]
  double best = HUGE_VAL;
  CompressParams chosen;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const Trial trial = trials.measure_error(ladder[middle]);
    best = std::min(best, trial.error);
    if (trial.error <= max_error) {
      high = middle;
      chosen = trial.params;
    } else {
      low = middle + 1;
    }
  }
  if (high == ladder.size())
    throw Error(
        {{}, "--max-error", fmt::format("at least {:.4g}", best), fmt::format("{}", max_error)});
  return chosen;
}

}  // namespace

CompressParams choose_params(const ProfileMap& map,
                             const std::shared_ptr<const BlendObjective>& objective,
                             const CompressParams& params, const CompressLimits& limits,
                             bool packed, const BlendMeasures& measures, const Progress& progress) {
  Trials trials(map, objective, params, packed, measures, progress);
  if (limits.max_error <= 0) return choose_for_bytes(trials, limits.max_bytes);
  const CompressParams chosen = choose_for_error(trials, limits.max_error);
  if (limits.max_bytes > 0) {
    const std::size_t bytes = trials.measure_size({chosen.per_pixel, chosen.bases}).bytes;
    if (bytes > limits.max_bytes)
      throw Error({{},
                   "--max-bytes with --max-error",
                   fmt::format("at least {} for that error", bytes),
                   fmt::format("{}", limits.max_bytes)});
  }
  return chosen;
}

}  // namespace parian

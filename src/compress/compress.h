// A fitted material -> K base materials per pixel (Yatagawa et al. 2019, section 3), by alternating
// minimisation on the fit: the table is read once more, for what the fit misses of it, and never
// again.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/document.h"
#include "base/progress.h"
#include "compress/compress_params.h"
#include "compress/optimise.h"
#include "material/profile_blend.h"

namespace parian {

// A run: may be copied, advanced from elsewhere, abandoned and gone on with. Rounds with 2 bases
// per pixel come first (or 1, where K = 1), then one more after another up to K, then rounds on the
// lattice where one is asked for.
struct CompressState {
  CompressParams params;
  ProfileMap header;  // the map without its values: sizes, knots, boundary, provenance ...
  std::shared_ptr<const BlendObjective> objective;
  OptimiseState run;  // of the present number of bases per pixel
  std::vector<RoundReport> history;
  bool on_grid = false;
  bool done = false;
};

// What a run minimises, for any number of bases. `table`, which may be null, is the one that the
// map was fitted to: rho and errors are then the table's, and Objective::paper sums over its pairs.
// Throws Error when the grids disagree.
std::shared_ptr<const BlendObjective> make_blend_objective(const ProfileMap& map,
                                                           const SliceSource* table,
                                                           Objective objective,
                                                           const Progress& progress = {});

// Starts from `start`'s bases, indices and weights, where it is given, with K of its own or more.
// Throws Error for bad parameters, and for a start with another grid or other knots.
CompressState make_compress_state(const ProfileMap& map,
                                  std::shared_ptr<const BlendObjective> objective,
                                  const CompressParams& params,
                                  const ProfileBlend* start = nullptr);

// One round.
void advance(CompressState& state);

// The blend as it is now. Without a lattice, or before it is reached, its grid is empty.
ProfileBlend make_blend(const CompressState& state);

// Mean errors of the present blend against the map, which `compare` would measure; where the
// objective took in a table, its albedo is the table's, and the relative error is too large by what
// the blend makes up for. NaN for Objective::paper.
struct CompressErrors {
  double relative = 0, albedo = 0;
};
CompressErrors estimate_errors(const CompressState& state);

struct CompressReport {
  std::vector<RoundReport> rounds;
  double energy = 0;
  double seconds = 0;
};

// How far a run is, 0 to 1: rounds often end early.
double progress_of(const CompressState& state);

// All rounds.
ProfileBlend compress_profiles(const ProfileMap& map, const SliceSource* table,
                               const CompressParams& params, const Progress& progress = {},
                               CompressReport* report = nullptr);

Document to_document(const CompressReport& report);

}  // namespace parian

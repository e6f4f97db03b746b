#include "edit/synthesis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "base/random.h"
#include "edit/synthesis_seams.h"
#include "edit/synthesis_search.h"

namespace parian {

ParamList describe(SynthesisParams& params) {
  return {
      {.name = "width-px",
       .help = "width of the result",
       .target = &params.width_px,
       .min = 1,
       .max = 8192,
       .unit = "px"},
      {.name = "height-px",
       .help = "height of the result",
       .target = &params.height_px,
       .min = 1,
       .max = 8192,
       .unit = "px"},
      {.name = "patch-px",
       .help = "side of the patches; 0 takes a quarter of the sample's shorter side, at least 8",
       .target = &params.patch_px,
       .min = 0,
       .max = 8192,
       .unit = "px"},
      {.name = "overlap-px",
       .help = "overlap of patches; 0 takes a third of the patch",
       .target = &params.overlap_px,
       .min = 0,
       .max = 8192,
       .unit = "px"},
      {.name = "tolerance",
       .help = "patches up to this much worse than the best one are chosen among at random",
       .target = &params.tolerance,
       .min = 0,
       .max = 10},
      {.name = "seed", .help = "of the random choices", .target = &params.seed, .min = 0},
      {.name = "tileable",
       .help = "the result continues itself across its borders",
       .target = &params.tileable},
  };
}

namespace {

constexpr int min_side = 4;

std::size_t at(int y, int x, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

// Where patches start along one axis, and how far each lies on those placed before it.
struct Axis {
  int size = 0, patch = 0, overlap = 0;
  bool wraps = false;
  std::vector<int> starts;

  int count() const { return static_cast<int>(starts.size()); }
  int start(int index) const { return starts[static_cast<std::size_t>(index)]; }
  int before(int index) const { return index == 0 ? 0 : start(index - 1) + patch - start(index); }
  int step() const { return std::max(1, patch - overlap); }
  // The index itself, wrapped around, or -1 outside.
  int neighbour(int index) const {
    if (wraps) return ((index % count()) + count()) % count();
    return index < count() ? index : -1;
  }
  // From a to b, the shorter way.
  int distance(int a, int b) const {
    const int straight = b - a;
    if (!wraps || 2 * std::abs(straight) <= size) return straight;
    return straight > 0 ? straight - size : straight + size;
  }
};

// Patches shrink a little so that they divide the axis evenly.
Axis make_axis(int size, int patch, int overlap, bool wraps) {
  Axis axis{
      .size = size, .patch = 0, .overlap = 0, .wraps = wraps && size >= min_side, .starts = {}};
  const int step = patch - overlap, covered = axis.wraps ? size : std::max(1, size - overlap);
  const int count = std::max(axis.wraps ? 2 : 1, (covered + step - 1) / step);
  const int even_step = (covered + count - 1) / count;
  if (axis.wraps) overlap = std::min(overlap, even_step / 2);
  axis.patch = std::min(size, even_step + overlap);
  axis.overlap = std::min(overlap, axis.patch / 2);
  axis.starts.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    if (axis.wraps)
      axis.starts.push_back(static_cast<int>(std::int64_t{i} * size / count));
    else
      axis.starts.push_back(
          i == 0 ? 0 : static_cast<int>(std::int64_t{i} * (size - axis.patch) / (count - 1)));
  }
  return axis;
}

// A smooth hill of the given height and radii on a plane.
void add_hill(std::vector<float>& plane, int columns, int rows, double centre_x, double centre_y,
              double radius_x, double radius_y, double height) {
  const int x_begin = std::max(0, static_cast<int>(std::ceil(centre_x - radius_x)));
  const int x_end = std::min(columns - 1, static_cast<int>(std::floor(centre_x + radius_x)));
  const int y_begin = std::max(0, static_cast<int>(std::ceil(centre_y - radius_y)));
  const int y_end = std::min(rows - 1, static_cast<int>(std::floor(centre_y + radius_y)));
  for (int y = y_begin; y <= y_end; ++y)
    for (int x = x_begin; x <= x_end; ++x) {
      const double u = (x - centre_x) / radius_x, v = (y - centre_y) / radius_y;
      const double rest = std::max(0.0, 1.0 - u * u - v * v);
      plane[at(y, x, columns)] += static_cast<float>(height * rest * rest);
    }
}

// A patch on the lattice: where it lies in the result, and which position of the sample it shows.
struct Patch {
  int x = 0, y = 0, position = -1;  // -1: not placed
};

class Quilt {
 public:
  Quilt(const TextureSample& sample, const Axis& x_axis, const Axis& y_axis,
        const SynthesisParams& params)
      : sample_(sample),
        x_(x_axis),
        y_(y_axis),
        params_(params),
        search_(sample),
        columns_(sample.width - x_.patch + 1),
        rows_(sample.height - y_.patch + 1),
        output_(at(y_.size, 0, x_.size), 0u),
        usage_(at(rows_, 0, columns_), 0.0f),
        penalty_(usage_.size()) {
    patches_.resize(layers * at(y_.count(), 0, x_.count()));
  }

  // Layer 0 fills the result in raster order. Those after it lie between its patches, over its
  // seams and corners (and over the borders of results that wrap around), and stay where they make
  // the seams better.
  void place(int layer, int i, int j) {
    Patch patch{.x = x_.start(i) + (layer & 1 ? x_.step() / 2 : 0),
                .y = y_.start(j) + (layer & 2 ? y_.step() / 2 : 0)};
    if (!x_.wraps) patch.x = std::min(patch.x, x_.size - x_.patch);
    if (!y_.wraps) patch.y = std::min(patch.y, y_.size - y_.patch);
    Overlap overlap{.left = x_.before(i), .right = 0, .top = y_.before(j), .bottom = 0};
    if (layer > 0) {
      overlap.left = x_.wraps || patch.x > 0 ? x_.overlap : 0;
      overlap.right = x_.wraps || patch.x + x_.patch < x_.size ? x_.overlap : 0;
      overlap.top = y_.wraps || patch.y > 0 ? y_.overlap : 0;
      overlap.bottom = y_.wraps || patch.y + y_.patch < y_.size ? y_.overlap : 0;
      if (overlap.left + overlap.right + overlap.top + overlap.bottom == 0) return;
    }
    const std::size_t place = cell(layer, i, j);
    penalise(layer, i, j, patch);
    patch.position = choose(patch, overlap, place);
    const double seams = layer > 0 ? measure_seams(patch) : 0;
    lay(patch, overlap);
    if (layer > 0 && measure_seams(patch) >= seams) return restore(patch);
    patches_[place] = patch;
    const int x = patch.position % columns_, y = patch.position / columns_;
    add_hill(usage_, columns_, rows_, x, y, 0.5 * x_.patch + 1, 0.5 * y_.patch + 1, 1);
  }

  static constexpr int layers = 4;
  std::vector<std::uint32_t>& output() { return output_; }

 private:
  std::size_t cell(int layer, int i, int j) const {
    return at(layer * y_.count() + j, i, x_.count());
  }
  std::size_t output_index(const Patch& patch, int x, int y) const {
    return at((patch.y + y) % y_.size, (patch.x + x) % x_.size, x_.size);
  }
  std::size_t source_index(const Patch& patch, int x, int y) const {
    return at(patch.position / columns_ + y, patch.position % columns_ + x, sample_.width);
  }
  bool is_covered(int x, int y, const Overlap& overlap) const {
    return x < overlap.left || x >= x_.patch - overlap.right || y < overlap.top ||
           y >= y_.patch - overlap.bottom;
  }
  float difference(std::size_t a, std::size_t b) const {
    float sum = 0;
    for (int plane = 0; plane < sample_.planes; ++plane) {
      const float step = sample_.plane(plane)[a] - sample_.plane(plane)[b];
      sum += step * step;
    }
    return sum;
  }

  // Writes the patch, cut where it differs least from what lies under it.
  void lay(const Patch& patch, const Overlap& overlap) {
    std::vector<float> error(at(y_.patch, 0, x_.patch), 0.0f);
    for (int y = 0; y < y_.patch; ++y)
      for (int x = 0; x < x_.patch; ++x)
        if (is_covered(x, y, overlap))
          error[at(y, x, x_.patch)] =
              difference(output_[output_index(patch, x, y)], source_index(patch, x, y));
    const std::vector<unsigned char> is_new = cut_patch(error, x_.patch, y_.patch, overlap);
    covered_.clear();
    covered_.reserve(is_new.size());
    for (int y = 0; y < y_.patch; ++y)
      for (int x = 0; x < x_.patch; ++x) {
        std::uint32_t& pixel = output_[output_index(patch, x, y)];
        covered_.push_back(pixel);
        if (is_new[at(y, x, x_.patch)] != 0)
          pixel = static_cast<std::uint32_t>(source_index(patch, x, y));
      }
  }

  // Undoes the last lay().
  void restore(const Patch& patch) {
    for (int y = 0; y < y_.patch; ++y)
      for (int x = 0; x < x_.patch; ++x)
        output_[output_index(patch, x, y)] = covered_[at(y, x, x_.patch)];
  }

  // How visible the seams inside a patch's rectangle are.
  double measure_seams(const Patch& patch) const {
    double sum = 0;
    for (int y = 0; y < y_.patch; ++y)
      for (int x = 0; x < x_.patch; ++x) {
        const std::uint32_t pixel = output_[output_index(patch, x, y)];
        if (x > 0) sum += measure_step(output_[output_index(patch, x - 1, y)], pixel, 1, 0);
        if (y > 0) sum += measure_step(output_[output_index(patch, x, y - 1)], pixel, 0, 1);
      }
    return sum;
  }

  // By how much neighbours differ from the sample's own continuation of each other; 0 where both
  // were copied together (the seam's cost of Kwatra et al. 2003, eq. 1).
  double measure_step(std::uint32_t before, std::uint32_t after, int dx, int dy) const {
    const std::uint32_t step = static_cast<std::uint32_t>(dx + dy * sample_.width);
    const auto width = static_cast<std::uint32_t>(sample_.width);
    const auto height = static_cast<std::uint32_t>(sample_.height);
    const bool has_next = dx > 0 ? before % width + 1 < width : before / width + 1 < height;
    const bool has_last = dx > 0 ? after % width > 0 : after / width > 0;
    if (has_next && before + step == after) return 0;
    const double ahead = has_next ? difference(before + step, after) : 0;
    const double behind = has_last ? difference(before, after - step) : 0;
    if (has_next && has_last) return ahead + behind;
    if (has_next || has_last) return 2 * (ahead + behind);
    return 2.0 * difference(before, after);
  }

  // Sets factors >= 1 on the cost of sources that were used often, of those that lie around the
  // sources of near patches, and of those that would go on copying the sample where one stopped.
  void penalise(int layer, int i, int j, const Patch& patch) {
    double sum = 0;
    for (const float used : usage_) sum += used;
    const double scale = usage_weight / (1.0 + sum / static_cast<double>(usage_.size()));
    for (std::size_t k = 0; k < usage_.size(); ++k)
      penalty_[k] = static_cast<float>(1.0 + scale * usage_[k]);
    for (int other = 0; other <= layer; ++other)
      for (int dj = -reach; dj <= reach; ++dj)
        for (int di = -reach; di <= reach; ++di) {
          const int column = x_.neighbour(i + di), row = y_.neighbour(j + dj);
          if (column >= 0 && row >= 0) penalise_near(patch, patches_[cell(other, column, row)]);
        }
  }

  void penalise_near(const Patch& patch, const Patch& near) {
    if (near.position < 0) return;
    const int dx = x_.distance(patch.x, near.x), dy = y_.distance(patch.y, near.y);
    const double u = 1.0 * dx / x_.step(), v = 1.0 * dy / y_.step();
    const double weight = near_weight / std::max(1.0, u * u + v * v);
    const int x = near.position % columns_, y = near.position / columns_;
    add_hill(penalty_, columns_, rows_, x, y, 0.6 * x_.patch, 0.6 * y_.patch, weight);
    add_hill(penalty_, columns_, rows_, x - dx, y - dy, 0.4 * x_.patch + 1, 0.4 * y_.patch + 1,
             weight);
  }

  void fill_wanted(const Patch& patch, const Overlap& overlap) {
    std::vector<float>& wanted = search_.wanted();
    std::fill(wanted.begin(), wanted.end(), 0.0f);
    for (int y = 0; y < y_.patch; ++y)
      for (int x = 0; x < x_.patch; ++x) {
        if (!is_covered(x, y, overlap)) continue;
        const std::uint32_t pixel = output_[output_index(patch, x, y)];
        const std::size_t place = at(y, x, sample_.width);
        for (int plane = 0; plane < sample_.planes; ++plane)
          wanted[static_cast<std::size_t>(plane) * sample_.pixels() + place] =
              sample_.plane(plane)[pixel];
      }
  }

  // One of the positions in the sample that continue the overlap best, at random.
  int choose(const Patch& patch, const Overlap& overlap, std::size_t stream) {
    fill_wanted(patch, overlap);
    search_.run(x_.patch, y_.patch, overlap, score_);
    const int inner_width = std::max(0, x_.patch - overlap.left - overlap.right);
    const int inner_height = std::max(0, y_.patch - overlap.top - overlap.bottom);
    const double covered = 1.0 * x_.patch * y_.patch - 1.0 * inner_width * inner_height;
    // Where several positions fit perfectly, this floor lets the penalty decide.
    const auto floor = static_cast<float>(1e-4 * sample_.variance * covered + 1e-20);
    float best = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < score_.size(); ++k) {
      score_[k] = (score_[k] + floor) * penalty_[k];
      best = std::min(best, score_[k]);
    }
    const double limit = best * (1.0 + params_.tolerance);
    candidates_.clear();
    for (std::size_t k = 0; k < score_.size(); ++k)
      if (score_[k] <= limit) candidates_.push_back(static_cast<int>(k));
    Rng rng = make_rng(static_cast<std::uint64_t>(params_.seed), stream);
    return candidates_[static_cast<std::size_t>(sample_uniform(rng) *
                                                static_cast<double>(candidates_.size()))];
  }

  static constexpr int reach = 3;  // lattice steps over which sources should differ
  static constexpr double near_weight = 4, usage_weight = 3;

  const TextureSample& sample_;
  const Axis& x_;
  const Axis& y_;
  const SynthesisParams& params_;
  PatchSearch search_;
  int columns_, rows_;  // of positions in the sample where a patch fits
  std::vector<std::uint32_t> output_;
  std::vector<std::uint32_t> covered_;          // what the last patch was laid on
  std::vector<Patch> patches_;                  // [layer][row][column]
  std::vector<float> usage_, penalty_, score_;  // of each position
  std::vector<int> candidates_;
};

void check_size(int width, int height, const SynthesisParams& params) {
  SynthesisParams checked = params;
  check(describe(checked));
  constexpr std::int64_t max_pixels = std::int64_t{1} << 24;
  if (std::int64_t{params.width_px} * params.height_px > max_pixels)
    throw Error({.place = "width-px x height-px",
                 .expected = fmt::format("at most {} pixels", max_pixels),
                 .found = fmt::format("{} x {}", params.width_px, params.height_px)});
  if (width < min_side || height < min_side)
    throw Error({.place = "sample",
                 .expected = fmt::format("at least {0} x {0} px", min_side),
                 .found = fmt::format("{} x {} px", width, height)});
}

}  // namespace

std::vector<std::uint32_t> synthesize(const std::vector<float>& planes, int plane_count, int width,
                                      int height, const SynthesisParams& params,
                                      const Progress& progress) {
  check_size(width, height, params);
  PARIAN_CHECK(plane_count >= 0);
  PARIAN_CHECK_EQ(planes.size(), static_cast<std::size_t>(plane_count) * at(height, 0, width));
  const TextureSample sample = make_texture_sample(planes, plane_count, width, height);
  const int side = std::min(width, height);
  const int wanted_patch = params.patch_px > 0 ? params.patch_px : std::max(8, side / 4);
  const int patch = std::clamp(wanted_patch, 2, side / 2);
  const int wanted_overlap = params.overlap_px > 0 ? params.overlap_px : (patch + 1) / 3;
  const int overlap = std::clamp(wanted_overlap, 1, patch / 2);
  const Axis x_axis = make_axis(params.width_px, patch, overlap, params.tileable);
  const Axis y_axis = make_axis(params.height_px, patch, overlap, params.tileable);
  Quilt quilt(sample, x_axis, y_axis, params);
  for (int layer = 0; layer < Quilt::layers; ++layer)
    for (int j = 0; j < y_axis.count(); ++j) {
      const double done = 1.0 * (layer * y_axis.count() + j) / (Quilt::layers * y_axis.count());
      advance_progress(progress, "synthesize", done);
      for (int i = 0; i < x_axis.count(); ++i) quilt.place(layer, i, j);
    }
  advance_progress(progress, "synthesize", 1.0);
  return std::move(quilt.output());
}

}  // namespace parian

#include "compress/assign.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "compress/mixture_kernels.h"
#include "compress/screen_internal.h"
#include "compress/simplex.h"

namespace parian {
namespace {

constexpr std::size_t nearest_starts = 3;  // bases whose segments to all others are screened
constexpr std::size_t kept = 5;            // screened candidates that are decided exactly
constexpr float huge = 1e30f;

using Set = std::array<std::uint16_t, max_corners>;

struct Candidate {
  float error = huge;
  Set set{};
};

// The best `kept` sets by screened error, each once.
struct Shortlist {
  std::array<Candidate, kept> items;
  std::size_t count = 0;

  void add(float error, const Set& set, std::size_t size) {
    if (count == kept && error >= items[kept - 1].error) return;
    for (std::size_t i = 0; i < count; ++i)
      if (std::equal(set.begin(), set.begin() + static_cast<std::ptrdiff_t>(size),
                     items[i].set.begin()))
        return;
    std::size_t at = count < kept ? count++ : kept - 1;
    for (; at > 0 && items[at - 1].error > error; --at) items[at] = items[at - 1];
    items[at] = {error, set};
  }
};

// What one thread needs for a pixel after another.
struct Scratch {
  AlignedVector<float> white, inner, distance, error, corners;
  Scratch(const RowShape& shape, std::size_t padded)
      : white(shape.stride()),
        inner(padded),
        distance(padded),
        error(padded),
        corners(max_corners * (shape.stride() + 8)) {}
};

struct Job {
  const LocalMetric& metric;
  const AlignedVector<float>& target;
  const AssignParams& params;
  const CommonMetric& common;
  const ScreenedBases& screened;
  const Mixture& before;
};

// The mixture of set entries as <m, V_j> for all j; returns |m|^2.
float project_mixture(const ScreenedBases& screened, const std::uint16_t* set, const float* weight,
                      std::size_t count, float* inner) {
  std::fill_n(inner, screened.padded, 0.0f);
  float square = 0;
  for (std::size_t k = 0; k < count; ++k)
    add_row(&screened.gram[set[k] * screened.padded], weight[k], inner, screened.padded);
  for (std::size_t k = 0; k < count; ++k) square += weight[k] * inner[set[k]];
  return square;
}

std::size_t smallest(const float* values, std::size_t count) {
  return static_cast<std::size_t>(std::min_element(values, values + count) - values);
}

// Screens the segments from a mixture (the set without `slot`) to every base; the best two of them
// take the slot.
void screen_from(const Job& job, const Set& set, const float* weight, std::size_t count,
                 std::size_t slot, Scratch& scratch, Shortlist& list) {
  const ScreenedBases& screened = job.screened;
  const float mm = project_mixture(screened, set.data(), weight, count, scratch.inner.data());
  float product = 0;  // <w, m> from |w - V|^2 = |V|^2 - 2 <w, V> (+ |w|^2)
  for (std::size_t k = 0; k < count; ++k)
    product += weight[k] * 0.5f * (screened.norm[set[k]] - scratch.distance[set[k]]);
  screen_segments(scratch.inner.data(), screened.norm.data(), scratch.distance.data(),
                  mm - 2 * product, mm, scratch.error.data(), screened.padded);
  for (int best = 0; best < 2; ++best) {
    const std::size_t j = smallest(scratch.error.data(), screened.count);
    Set candidate = set;
    candidate[slot] = static_cast<std::uint16_t>(j);
    list.add(scratch.error[j], candidate, std::max(count, slot + 1));
    scratch.error[j] = huge;
  }
}

// K = 2: pairs with one of the present or of the nearest bases. K > 2: the best pairs, grown.
void screen_pairs(const Job& job, const Set& present, Scratch& scratch, Shortlist& list) {
  AlignedVector<float> distance = scratch.distance;
  const float one = 1;
  for (std::size_t k = 0; k < 2; ++k) screen_from(job, {present[k]}, &one, 1, 1, scratch, list);
  for (std::size_t i = 0; i < std::min(nearest_starts, job.screened.count); ++i) {
    const std::size_t j = smallest(distance.data(), job.screened.count);
    distance[j] = huge;
    screen_from(job, {static_cast<std::uint16_t>(j)}, &one, 1, 1, scratch, list);
  }
}

// Each entry of the present mixture replaced by others.
void screen_replacements(const Job& job, const Set& present, const float* weight,
                         std::size_t per_pixel, Scratch& scratch, Shortlist& list) {
  for (std::size_t slot = 0; slot < per_pixel; ++slot) {
    Set rest = present;
    std::array<float, max_corners> rest_weight{};
    std::copy_n(weight, per_pixel, rest_weight.begin());
    const float left = 1 - weight[slot];
    if (left < 1e-6f) continue;  // without it nothing is left
    rest_weight[slot] = 0;
    for (std::size_t k = 0; k < per_pixel; ++k) rest_weight[k] /= left;
    screen_from(job, rest, rest_weight.data(), per_pixel, slot, scratch, list);
  }
}

// Nearest single bases, where pairs are too many to screen or K = 1.
void screen_singles(const Job& job, const Set& present, std::size_t per_pixel, Scratch& scratch,
                    Shortlist& list) {
  AlignedVector<float> distance = scratch.distance;
  std::array<std::uint16_t, nearest_starts> near{};
  const std::size_t count = std::min(nearest_starts, job.screened.count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = smallest(distance.data(), job.screened.count);
    near[i] = static_cast<std::uint16_t>(j);
    for (std::size_t slot = 0; slot < per_pixel; ++slot) {
      Set set = present;
      set[slot] = near[i];
      list.add(distance[j], set, per_pixel);
    }
    distance[j] = huge;
  }
}

struct Choice {
  Set set{};
  std::array<float, max_corners> weight{};
  float error = huge;
};

// Weights and error of a set in the pixel's own metric.
void decide(const Job& job, std::size_t pixel, const Set& set, Scratch& scratch, Choice& best) {
  const std::size_t per_pixel = job.before.per_pixel, stride = job.metric.shape.stride();
  const std::size_t row = pixel * stride;
  std::array<float, max_corners * max_corners> gram;
  eval_corners(job.before.bases.data(), stride, set.data(), per_pixel, &job.target[row],
               &job.metric.diagonal[row], &job.metric.coupling[row], scratch.corners.data(),
               gram.data());
  double matrix[max_corners][max_corners], weight[max_corners];
  for (std::size_t k = 0; k < per_pixel; ++k)
    for (std::size_t l = 0; l < per_pixel; ++l)
      matrix[k][l] = static_cast<double>(gram[k * per_pixel + l]);
  nearest_in_simplex(matrix, per_pixel, weight);
  if (job.params.weight_levels > 0) round_weights(weight, per_pixel, job.params.weight_levels);
  Choice choice{set, {}, 0};
  std::copy_n(weight, per_pixel, choice.weight.begin());
  choice.error = eval_mixed_corners(scratch.corners.data(), stride, choice.weight.data(), per_pixel,
                                    &job.metric.diagonal[row], &job.metric.coupling[row]);
  if (choice.error < best.error) best = choice;
}

Set present_set(const Mixture& mixture, std::size_t pixel) {
  Set set{};
  std::copy_n(&mixture.index[pixel * mixture.per_pixel], mixture.per_pixel, set.begin());
  return set;
}

// The present weights, as they are.
Choice present_choice(const Job& job, std::size_t pixel, Scratch& scratch) {
  const std::size_t per_pixel = job.before.per_pixel, stride = job.metric.shape.stride();
  Choice choice{present_set(job.before, pixel), {}, 0};
  std::copy_n(&job.before.weight[pixel * per_pixel], per_pixel, choice.weight.begin());
  std::array<float, max_corners * max_corners> gram;
  const std::size_t row = pixel * stride;
  eval_corners(job.before.bases.data(), stride, choice.set.data(), per_pixel, &job.target[row],
               &job.metric.diagonal[row], &job.metric.coupling[row], scratch.corners.data(),
               gram.data());
  choice.error = eval_mixed_corners(scratch.corners.data(), stride, choice.weight.data(), per_pixel,
                                    &job.metric.diagonal[row], &job.metric.coupling[row]);
  return choice;
}

void decide_neighbours(const Job& job, std::size_t pixel, Scratch& scratch, Choice& best) {
  const auto width = static_cast<std::size_t>(job.params.width);
  const std::size_t pixels = job.metric.shape.pixels, x = pixel % width;
  if (x > 0) decide(job, pixel, present_set(job.before, pixel - 1), scratch, best);
  if (x + 1 < width) decide(job, pixel, present_set(job.before, pixel + 1), scratch, best);
  if (pixel >= width) decide(job, pixel, present_set(job.before, pixel - width), scratch, best);
  if (pixel + width < pixels)
    decide(job, pixel, present_set(job.before, pixel + width), scratch, best);
}

Choice choose(const Job& job, std::size_t pixel, Scratch& scratch) {
  const ScreenedBases& screened = job.screened;
  const std::size_t per_pixel = job.before.per_pixel;
  whiten(job.common, &job.target[pixel * job.metric.shape.stride()], scratch.white.data());
  project_row(screened.columns.data(), job.metric.shape.stride(), screened.padded,
              scratch.white.data(), scratch.distance.data());
  for (std::size_t j = 0; j < screened.padded; ++j)  // |w - V|^2 without |w|^2
    scratch.distance[j] = screened.norm[j] - 2 * scratch.distance[j];
  Choice best = present_choice(job, pixel, scratch);
  const Set present = best.set;
  decide(job, pixel, present, scratch, best);
  Shortlist list;
  if (per_pixel == 1 || screened.gram.empty())
    screen_singles(job, present, per_pixel, scratch, list);
  else if (per_pixel == 2)
    screen_pairs(job, present, scratch, list);
  else
    screen_replacements(job, present, best.weight.data(), per_pixel, scratch, list);
  for (std::size_t i = 0; i < list.count; ++i) decide(job, pixel, list.items[i].set, scratch, best);
  if (job.params.width > 0) decide_neighbours(job, pixel, scratch, best);
  return best;
}

}  // namespace

double assign_mixtures(const LocalMetric& metric, const AlignedVector<float>& target,
                       const AssignParams& params, Mixture& mixture) {
  const CommonMetric common = make_common_metric(metric, target);
  const ScreenedBases screened = screen_bases(common, mixture.bases);
  const Mixture before = mixture;
  const Job job{metric, target, params, common, screened, before};
  const std::size_t per_pixel = mixture.per_pixel;
  return parallel_sum(metric.shape.pixels, 64, [&](std::size_t begin, std::size_t end) {
    Scratch scratch(metric.shape, screened.padded);
    double sum = 0;
    for (std::size_t x = begin; x < end; ++x) {
      const Choice choice = choose(job, x, scratch);
      std::copy_n(choice.set.begin(), per_pixel, &mixture.index[x * per_pixel]);
      std::copy_n(choice.weight.begin(), per_pixel, &mixture.weight[x * per_pixel]);
      sum += static_cast<double>(choice.error);
    }
    return sum;
  });
}

}  // namespace parian

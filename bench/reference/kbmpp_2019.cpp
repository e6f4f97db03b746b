#include "bench/reference/kbmpp_2019.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "bench/reference/kbmpp_2019_match.h"
#include "bench/reference/kbmpp_2019_pairs.h"
#include "bench/reference/kbmpp_2019_solver.h"

namespace parian {
namespace {

void require(bool good, const char* field, const char* expected, double found) {
  if (good) return;
  std::string text = std::to_string(found);
  text.erase(text.find_last_not_of('0') + 1);
  if (!text.empty() && text.back() == '.') text.pop_back();
  throw Error({"", field, expected, text});
}

ProfileBlend make_blend(const BssrdfTable& table, const std::vector<double>& knots_mm,
                        const kbmpp::Solver& solver) {
  const kbmpp::Model& model = solver.model;
  ProfileBlend blend;
  blend.width = table.header.width;
  blend.height = table.header.height;
  blend.channels = table.header.channels;
  blend.per_pixel = static_cast<int>(model.per_pixel);
  blend.pixel_pitch_mm = table.header.pixel_pitch_mm;
  blend.boundary = table.header.boundary;
  blend.eta = table.header.eta;
  blend.knots_mm = knots_mm;
  const std::size_t pixels = blend.pixels(), knots = knots_mm.size();
  for (std::size_t b = 0; b < model.bases; ++b)
    for (std::size_t c = 0; c < static_cast<std::size_t>(blend.channels); ++c)
      for (std::size_t h = 0; h < knots; ++h)
        blend.base_log_profile.push_back(model.base_rows[(b * knots + h) * 4 + c]);
  blend.index.resize(model.per_pixel * pixels);
  blend.weight.resize((model.per_pixel - 1) * pixels);
  for (std::size_t x = 0; x < pixels; ++x) {
    float sum = 0;
    const float* t = model.weight.data() + x * model.per_pixel;
    for (std::size_t k = 0; k < model.per_pixel; ++k) sum += t[k];
    for (std::size_t k = 0; k < model.per_pixel; ++k) {
      blend.index[k * pixels + x] = model.index[x * model.per_pixel + k];
      if (k + 1 < model.per_pixel) blend.weight[k * pixels + x] = t[k] / sum;
    }
  }
  return blend;
}

// ln P of a blend (Eq. 3, 4).
double eval_log_profile(const ProfileBlend& blend, int channel, std::size_t pixel, double r) {
  const auto& knots = blend.knots_mm;
  std::size_t h = 0;
  while (h + 2 < knots.size() && knots[h + 1] <= r) ++h;
  const double w = std::min((r - knots[h]) / (knots[h + 1] - knots[h]), 1.0);
  const auto last = static_cast<std::size_t>(blend.per_pixel) - 1;
  double left = 1, sum = 0;
  for (std::size_t k = 0; k <= last; ++k) {
    const std::size_t at = k * blend.pixels() + pixel;
    const double t = k < last ? static_cast<double>(blend.weight[at]) : left;
    const float* base = base_profile(blend, blend.index[at], channel);
    left -= t;
    sum += t * ((1 - w) * static_cast<double>(base[h]) + w * static_cast<double>(base[h + 1]));
  }
  return sum;
}

double eval_curvature(const ProfileBlend& blend) {
  double sum = 0;
  for (std::size_t b = 0; b < blend.bases(); ++b)
    for (int c = 0; c < blend.channels; ++c)
      for (std::size_t h = 0; h + 2 < blend.knots_mm.size(); ++h) {
        const float* y = base_profile(blend, b, c) + h;
        const double d =
            static_cast<double>(y[0]) - 2 * static_cast<double>(y[1]) + static_cast<double>(y[2]);
        sum += 0.5 * d * d;
      }
  return sum;
}

// 1/2 sum of squares over the pairs of one slice, without phi.
double eval_slice_energy(const BssrdfTable& table, const ProfileBlend& blend, int channel,
                         int offset_index) {
  const Offset d = table.header.offsets[static_cast<std::size_t>(offset_index)];
  const double r = length_px(d) * table.header.pixel_pitch_mm;
  const float* slice = slice_of(table, channel, offset_index);
  const PixelRange range = pairs_in_grid(table.header, d);
  double sum = 0;
  for (int y = range.y0; y < range.y1; ++y)
    for (int x = range.x0; x < range.x1; ++x) {
      const auto pixel = static_cast<std::size_t>(y * blend.width + x);
      const auto partner = static_cast<std::size_t>((y + d.dy) * blend.width + x + d.dx);
      if (!(slice[pixel] > 0)) continue;
      const double e = eval_log_profile(blend, channel, pixel, r) +
                       eval_log_profile(blend, channel, partner, r) -
                       2 * std::log(static_cast<double>(slice[pixel]));
      sum += 0.5 * e * e;
    }
  return sum;
}

}  // namespace

void check(const KbmppParams& p) {
  require(p.per_pixel >= 1 && p.per_pixel <= max_bases_per_pixel, "per_pixel", "a value in [1, 8]",
          p.per_pixel);
  require(p.bases >= p.per_pixel && p.bases <= max_bases, "bases", "a value in [per_pixel, 65535]",
          p.bases);
  require(p.iterations >= 1, "iterations", "a value >= 1", p.iterations);
  require(p.run_iterations >= 0, "run_iterations", "a value >= 0", p.run_iterations);
  require(p.inner >= 0, "inner", "a value >= 0", p.inner);
  require(p.memory >= 1 && p.memory <= 100, "memory", "a value in [1, 100]", p.memory);
  require(p.random_candidates >= 0, "random_candidates", "a value >= 0", p.random_candidates);
  require(p.lambda_reg >= 0, "lambda_reg", "a value >= 0", p.lambda_reg);
  require(p.lambda_barr >= 0, "lambda_barr", "a value >= 0", p.lambda_barr);
  require(p.gamma >= 0, "gamma", "a value >= 0", p.gamma);
  require(p.a0 > 0 && p.a0 <= 1, "a0", "a value in (0, 1]", p.a0);
}

ProfileBlend run_kbmpp(const BssrdfTable& table, const std::vector<double>& knots_mm,
                       const KbmppParams& params, const KbmppCallback& callback) {
  check(params);
  PARIAN_CHECK(knots_mm.size() >= 2);
  const Stopwatch whole;
  const kbmpp::Pairs pairs = kbmpp::make_pairs(table, knots_mm);
  const std::vector<std::uint8_t> mask = kbmpp::make_pair_mask(pairs);
  kbmpp::Solver solver = kbmpp::make_solver(pairs, params);
  KbmppRound round;
  double paused = 0, solving = 0;
  const int rounds = params.run_iterations > 0 ? std::min(params.run_iterations, params.iterations)
                                               : params.iterations;
  // a0 p^i = 1 at i = N_iter / 2
  const double p = std::pow(1 / params.a0, 2.0 / params.iterations);
  for (int i = 0; i < rounds; ++i) {
    Stopwatch watch;
    round.largest_constraint = kbmpp::solve(solver);
    solving += watch.lap();
    const double probability = std::min(params.a0 * std::pow(p, i), 1.0);
    round.replaced =
        kbmpp::sweep(pairs, mask, {i, probability, params.random_candidates, params.seed},
                     solver.model, solver.work);
    kbmpp::read_model(solver);
    round.seconds_match += watch.lap();
    if (!callback) continue;
    round.iteration = i + 1;
    round.seconds = whole.seconds() - paused;
    round.evaluations = solver.evaluations;
    round.seconds_evaluations = solver.seconds_evaluations;
    round.seconds_solver = solving - solver.seconds_evaluations;
    round.energy = kbmpp::eval_feasible_energy(solver);
    callback(round);
    paused += watch.lap();
  }
  return make_blend(table, knots_mm, solver);
}

double eval_kbmpp_energy(const BssrdfTable& table, const ProfileBlend& blend, double lambda_reg) {
  double energy = lambda_reg * eval_curvature(blend);
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
    const Offset d = table.header.offsets[i];
    const double r = length_px(d);
    if (r * table.header.pixel_pitch_mm > blend.knots_mm.back() * (1 + 1e-9)) continue;
    const double phi = pair_count(table.header, d) / (1 + r * r);
    for (int c = 0; c < blend.channels; ++c)
      energy += phi * eval_slice_energy(table, blend, c, static_cast<int>(i));
  }
  return energy;
}

}  // namespace parian

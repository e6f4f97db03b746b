// A map of 1024 x 1024 pixels: time and memory.
#include <fmt/format.h>

#include <cmath>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/random.h"
#include "bench/common/timing.h"
#include "bench/compression/study.h"
#include "material/dipole.h"

namespace parian::compression {
namespace {

constexpr int side = 1024, knots = 25;
constexpr double pitch_mm = 0.25;

// Smooth noise in [0, 1]: bilinear between hashed values, three octaves.
double eval_noise(double x, double y, std::uint64_t seed) {
  double sum = 0, weight = 0;
  for (int octave = 0; octave < 3; ++octave) {
    const double scale = 1.0 / (64 >> (2 * octave)), u = x * scale, v = y * scale;
    const double fx = u - std::floor(u), fy = v - std::floor(v);
    const auto corner = [&](int dx, int dy) {
      const auto i = static_cast<std::uint64_t>(std::floor(u) + dx);
      const auto j = static_cast<std::uint64_t>(std::floor(v) + dy);
      return hash_to_uniform(hash_u64(hash_u64(seed + static_cast<std::uint64_t>(octave), i), j));
    };
    sum += std::ldexp((1 - fy) * ((1 - fx) * corner(0, 0) + fx * corner(1, 0)) +
                          fy * ((1 - fx) * corner(0, 1) + fx * corner(1, 1)),
                      -octave);
    weight += std::ldexp(1, -octave);
  }
  return sum / weight;
}

// Dipoles whose coefficients are images.
ProfileMap make_map() {
  std::vector<double> knots_mm;
  knots_mm.reserve(knots);
  for (int k = 0; k < knots; ++k) knots_mm.push_back(pitch_mm * k);
  ProfileMap map = make_profile_map(side, side, 3, pitch_mm, knots_mm);
  map.eta = 1.5;
  parian::parallel_for(side, [&](std::size_t y) {
    for (std::size_t x = 0; x < side; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto u = static_cast<double>(x), v = static_cast<double>(y);
        const DipoleCoefficients medium{
            0.004 * std::exp(3 * eval_noise(u, v, 1 + 10 * static_cast<std::uint64_t>(c))),
            0.8 * std::exp(1.5 * eval_noise(u, v, 2))};
        for (int k = 0; k < knots; ++k)
          knot_plane(map, c, k)[y * side + x] = static_cast<float>(
              std::log(eval_dipole(medium, map.eta, knots_mm[static_cast<std::size_t>(k)])));
      }
  });
  return map;
}

}  // namespace

void study_large(const Page& page) {
  ProfileMap map = make_map();
  CompressState state;
  const double seconds = best_seconds(1, [&] {
    state = make_compress_state(map, make_blend_objective(map, nullptr, Objective::balanced),
                                make_params(128, 2));
    map = {};
    while (!state.done) advance(state);
  });
  const CompressErrors errors = estimate_errors(state);
  write_table(page, "large",
              "1024 x 1024 pixels, 25 knots, radius 24 pixels, K = 2, M = 128 "
              "(`./run bench compress large`)",
              {{"", "s", "peak memory GB", "kB", "relative error", "albedo error"},
               {{"", fmt::format("{:.0f}", seconds),
                 fmt::format("{:.2f}", static_cast<double>(peak_memory()) / 1e9),
                 format_kb(paper_bytes(make_blend(state))), fmt::format("{:.4f}", errors.relative),
                 fmt::format("{:.4f}", errors.albedo)}}});
}

}  // namespace parian::compression

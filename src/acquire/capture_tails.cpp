#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/capture_tails_internal.h"

namespace parian {
namespace {

// Every pixel with every dot of the disc of half the lattice, in a fixed order.
template <typename Body>
void for_each_pair(const CaptureMeta& meta, const DotResponses& responses, int channel,
                   const Body& body) {
  const double limit = (meta.lattice_px - 1) / 2.0;
  const auto width = static_cast<std::size_t>(meta.width);
  const std::size_t pixels = width * static_cast<std::size_t>(meta.height);
  for (const Offset half : half_disc_offsets(limit))
    for (const int sign : {1, -1}) {
      if (half == Offset{} && sign < 0) continue;
      const Offset d{sign * half.dx, sign * half.dy};
      for (int y = std::max(0, -d.dy); y < std::min(meta.height, meta.height - d.dy); ++y)
        for (int x = std::max(0, -d.dx); x < std::min(meta.width, meta.width - d.dx); ++x) {
          const std::size_t from =
              static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
          const std::size_t frame = response_index(meta, (x + d.dx) % meta.lattice_px,
                                                   (y + d.dy) % meta.lattice_px, channel);
          const float value = responses.value[frame * pixels + from];
          if (!std::isnan(value)) body(from, length_px(d), static_cast<double>(value));
        }
    }
}

// ln T = a - decay r over the outer half of the rings, where T is above 0.
double fit_decay(const std::vector<double>& mean) {
  double n = 0, sum_r = 0, sum_rr = 0, sum_y = 0, sum_ry = 0;
  for (std::size_t k = mean.size() / 2; k < mean.size(); ++k) {
    if (!(mean[k] > 0)) return std::numeric_limits<double>::infinity();
    const auto r = static_cast<double>(k);
    const double y = std::log(mean[k]);
    n += 1, sum_r += r, sum_rr += r * r, sum_y += y, sum_ry += r * y;
  }
  const double determinant = n * sum_rr - sum_r * sum_r;
  const double decay = determinant > 0 ? -(n * sum_ry - sum_r * sum_y) / determinant : 0;
  return decay > 0 ? decay : std::numeric_limits<double>::infinity();
}

}  // namespace

double eval_tail(const TailModel& tail, double r_px) {
  const auto last = static_cast<double>(tail.mean.size() - 1);
  if (r_px >= last) {
    const double end = std::max(0.0, tail.mean.back());
    return r_px == last ? end : end * std::exp(-tail.decay_per_px * (r_px - last));
  }
  const auto k = static_cast<std::size_t>(r_px);
  const double t = r_px - static_cast<double>(k);
  const double a = std::max(0.0, tail.mean[k]), b = std::max(0.0, tail.mean[k + 1]);
  return a > 0 && b > 0 ? std::pow(a, 1 - t) * std::pow(b, t) : (1 - t) * a + t * b;
}

TailModel make_tail_model(const CaptureMeta& meta, const DotResponses& responses, int channel) {
  const std::size_t rings = static_cast<std::size_t>((meta.lattice_px - 1) / 2) + 1;
  std::vector<double> sum(rings), count(rings);
  for_each_pair(meta, responses, channel, [&](std::size_t, double r, double value) {
    const auto k = static_cast<std::size_t>(std::lround(r));
    if (k < rings) sum[k] += value, count[k] += 1;
  });
  TailModel tail{.mean = std::vector<double>(rings)};
  for (std::size_t k = 0; k < rings; ++k) tail.mean[k] = count[k] > 0 ? sum[k] / count[k] : 0;
  tail.decay_per_px = fit_decay(tail.mean);
  const std::size_t pixels =
      static_cast<std::size_t>(meta.width) * static_cast<std::size_t>(meta.height);
  std::vector<double> own(pixels), expected(pixels);
  for_each_pair(meta, responses, channel, [&](std::size_t pixel, double r, double value) {
    if (4 * r < meta.lattice_px) return;
    own[pixel] += value;
    expected[pixel] += eval_tail(tail, r);
  });
  tail.factor.resize(pixels);
  for (std::size_t k = 0; k < pixels; ++k)
    tail.factor[k] = expected[k] > 0 ? std::clamp(own[k] / expected[k], 0.0, 10.0) : 1;
  return tail;
}

}  // namespace parian

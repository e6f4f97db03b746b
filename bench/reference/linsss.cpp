#include "bench/reference/linsss.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "bench/reference/linsss_internal.h"

namespace parian {
namespace {

constexpr std::size_t sampled_pixels = 64;
constexpr std::size_t pixel_block = 256;
constexpr int sweeps = 40;  // of coordinate descent on a pixel's weights

// R about one pixel: mean and number of values per ring.
struct LocalResponse {
  std::vector<double> mean, count;
};

LocalResponse gather_response(const BssrdfTable& table, int channel, const std::vector<Ring>& rings,
                              int x, int y) {
  const TableHeader& header = table.header;
  LocalResponse local;
  for (const Ring& ring : rings) {
    double sum = 0, count = 0;
    for (const int i : ring.offsets) {
      const Offset d = header.offsets[static_cast<std::size_t>(i)];
      const PixelRange range = pairs_in_grid(header, d);
      for (const int back : {0, 1}) {
        const int px = x - back * d.dx, py = y - back * d.dy;
        if (px < range.x0 || px >= range.x1 || py < range.y0 || py >= range.y1) continue;
        const float r = slice_of(table, channel, i)[py * header.width + px];
        if (std::isnan(r)) continue;
        sum += static_cast<double>(r);
        count += 1;
      }
    }
    local.mean.push_back(count > 0 ? sum / count : 0);
    local.count.push_back(count);
  }
  return local;
}

// Relative squared error of the best non-negative sum of the Gaussians.
double fit_error(const LocalResponse& local, const std::vector<Ring>& rings,
                 const std::vector<double>& sigma) {
  const std::size_t n = sigma.size();
  std::vector<double> a(n * n, 0.0), b(n, 0.0), w(n, 0.0), g(n);
  double squares = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    for (std::size_t i = 0; i < n; ++i)
      g[i] = std::exp(-0.5 * rings[r].radius2 / (sigma[i] * sigma[i]));
    for (std::size_t i = 0; i < n; ++i) {
      b[i] += local.count[r] * g[i] * local.mean[r];
      for (std::size_t j = 0; j < n; ++j) a[i * n + j] += local.count[r] * g[i] * g[j];
    }
    squares += local.count[r] * local.mean[r] * local.mean[r];
  }
  double error = squares;
  for (int sweep = 0; sweep < 100; ++sweep)
    for (std::size_t i = 0; i < n; ++i) {
      double rest = b[i];
      for (std::size_t j = 0; j < n; ++j) rest -= a[i * n + j] * w[j];
      if (a[i * n + i] > 0) w[i] = std::max(0.0, w[i] + rest / a[i * n + i]);
    }
  for (std::size_t i = 0; i < n; ++i) {
    double product = -2 * b[i];
    for (std::size_t j = 0; j < n; ++j) product += a[i * n + j] * w[j];
    error += w[i] * product;
  }
  return squares > 0 ? error / squares : 0;
}

std::vector<double> space_widths(double low, double high, std::size_t count) {
  std::vector<double> sigma;
  for (std::size_t i = 0; i < count; ++i)
    sigma.push_back(count == 1 ? std::sqrt(low * high)
                               : low * std::pow(high / low, static_cast<double>(i) /
                                                                static_cast<double>(count - 1)));
  return sigma;
}

// The pair of extreme widths that suits some pixels' responses best.
std::vector<double> choose_widths(const BssrdfTable& table, int channel,
                                  const std::vector<Ring>& rings, const LinsssParams& params) {
  Rng rng = make_rng(params.seed, static_cast<std::uint64_t>(channel));
  std::vector<LocalResponse> local;
  for (std::size_t i = 0; i < sampled_pixels; ++i) {
    const int x = static_cast<int>(sample_uniform(rng) * table.header.width);
    const int y = static_cast<int>(sample_uniform(rng) * table.header.height);
    local.push_back(gather_response(table, channel, rings, x, y));
  }
  std::vector<std::vector<double>> candidates;
  const double radius = std::max(2.0, radius_px(table.header));
  for (const double low : {0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0})
    for (const double part : {0.1, 0.15, 0.22, 0.33, 0.5, 0.75, 1.1})
      if (part * radius > low)
        candidates.push_back(space_widths(low, part * radius, params.gaussians));
  std::vector<double> error(candidates.size());
  parallel_for(candidates.size(), [&](std::size_t i) {
    for (const LocalResponse& response : local)
      error[i] += fit_error(response, rings, candidates[i]);
  });
  PARIAN_CHECK(!candidates.empty());
  return candidates[static_cast<std::size_t>(std::min_element(error.begin(), error.end()) -
                                             error.begin())];
}

// From `at` with gradient `slope`: the non-negative weights with the lowest bound
// slope^T d + 1/2 d^T bound d, pixel by pixel.
Plane minimise_bound(const LinsssProblem& p, const Plane& at, const Plane& slope) {
  const std::size_t n = p.gaussians, pixels = p.u.size();
  Plane out(at.size());
  parallel_for_blocks(pixels, pixel_block, [&](std::size_t begin, std::size_t end) {
    std::vector<float> w(n), q(n);
    for (std::size_t x = begin; x < end; ++x) {
      const float* m = &p.bound[x * n * n];
      for (std::size_t i = 0; i < n; ++i) {
        w[i] = at[i * pixels + x];
        q[i] = slope[i * pixels + x];
      }
      for (int sweep = 0; sweep < sweeps; ++sweep)
        for (std::size_t i = 0; i < n; ++i) {
          if (!(m[i * n + i] > 0)) continue;
          const float step = std::max(0.0f, w[i] - q[i] / m[i * n + i]) - w[i];
          w[i] += step;
          for (std::size_t j = 0; j < n; ++j) q[j] += step * m[i * n + j];
        }
      for (std::size_t i = 0; i < n; ++i) out[i * pixels + x] = std::max(0.0f, w[i]);
    }
  });
  return out;
}

// F from the gradient: c + 1/2 W^T (H W - 2 b)
double evaluate(const LinsssProblem& p, const Plane& w, const Plane& gradient) {
  return p.c + 0.5 * parallel_sum(w.size(), 4096, [&](std::size_t begin, std::size_t end) {
                 double sum = 0;
                 for (std::size_t i = begin; i < end; ++i)
                   sum += static_cast<double>(w[i]) *
                          (static_cast<double>(gradient[i]) - static_cast<double>(p.b[i]));
                 return sum;
               });
}

// a + factor (a - b)
Plane extrapolate(const Plane& a, const Plane& b, double factor) {
  Plane out(a.size());
  const auto f = static_cast<float>(factor);
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] + f * (a[i] - b[i]);
  return out;
}

struct Iterate {
  Plane weight, gradient;
  double objective = 0;
};

Iterate step_from(const LinsssProblem& p, const Plane& at, const Plane& slope) {
  Iterate next;
  next.weight = minimise_bound(p, at, slope);
  next.gradient = linsss_gradient(p, next.weight);
  next.objective = evaluate(p, next.weight, next.gradient);
  return next;
}

// Nesterov's acceleration with a restart whenever F would rise. F is quadratic: the gradient at an
// extrapolated point is the extrapolated gradient.
LinsssChannel minimise(const LinsssProblem& p, int iterations) {
  LinsssChannel channel;
  const Plane zero(p.b.size(), 0.0f);
  Plane slope(p.b.size());
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = -p.b[i];
  Iterate now = step_from(p, zero, slope), before = now;
  channel.objective.push_back(now.objective);
  double t = 1;
  for (int i = 0; i < iterations; ++i) {
    const double t_next = 0.5 * (1 + std::sqrt(1 + 4 * t * t)), momentum = (t - 1) / t_next;
    Iterate next = step_from(p, extrapolate(now.weight, before.weight, momentum),
                             extrapolate(now.gradient, before.gradient, momentum));
    t = t_next;
    if (next.objective > now.objective) {
      next = step_from(p, now.weight, now.gradient);
      t = 1;
    }
    if (next.objective > now.objective) break;  // only rounding is left
    before = std::exchange(now, std::move(next));
    channel.objective.push_back(now.objective);
  }
  channel.weight = std::move(now.weight);
  return channel;
}

class LinsssSource : public SliceSource {
 public:
  LinsssSource(TableHeader header, std::vector<LinsssChannel> channels)
      : header_(std::move(header)), channels_(std::move(channels)) {}
  const TableHeader& header() const override { return header_; }
  std::string name() const override { return "LinSSS"; }
  void read_slice(int channel, int offset_index, float* slice) const override {
    const LinsssChannel& model = channels_[static_cast<std::size_t>(channel)];
    const Offset d = header_.offsets[static_cast<std::size_t>(offset_index)];
    const double r = length_px(d);
    Plane sum(header_.pixels(), 0.0f);
    for (std::size_t h = 0; h < model.sigma_px.size(); ++h) {
      const auto g =
          static_cast<float>(std::exp(-0.5 * r * r / (model.sigma_px[h] * model.sigma_px[h])));
      for (std::size_t x = 0; x < sum.size(); ++x) sum[x] += g * model.weight[h * sum.size() + x];
    }
    std::fill_n(slice, sum.size(), std::numeric_limits<float>::quiet_NaN());
    const PixelRange range = pairs_in_grid(header_, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const int at = y * header_.width + x, to = at + d.dy * header_.width + d.dx;
        slice[at] = 0.5f * (sum[static_cast<std::size_t>(at)] + sum[static_cast<std::size_t>(to)]);
      }
  }

 private:
  TableHeader header_;
  std::vector<LinsssChannel> channels_;
};

}  // namespace

std::vector<LinsssChannel> fit_linsss(const BssrdfTable& table, const LinsssParams& params) {
  const std::vector<Ring> rings = find_rings(table.header);
  const Plane u = make_pixel_weights(table);
  std::vector<LinsssChannel> channels;
  for (int c = 0; c < table.header.channels; ++c) {
    const std::vector<double> sigma = choose_widths(table, c, rings, params);
    channels.push_back(minimise(make_linsss_problem(table, c, rings, u, sigma), params.iterations));
    channels.back().sigma_px = sigma;
  }
  return channels;
}

Rival compress_linsss(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed) {
  const Stopwatch watch;
  const std::size_t plane =
      sizeof(float) * static_cast<std::size_t>(table.header.channels) * table.header.pixels();
  LinsssParams params;
  params.seed = seed;
  params.gaussians = std::min<std::size_t>(8, bytes / plane);
  Rival rival{.name = "LinSSS", .bytes = params.gaussians * plane};
  if (params.gaussians == 0) return rival;
  rival.slices = std::make_unique<LinsssSource>(table.header, fit_linsss(table, params));
  rival.seconds = watch.seconds();
  return rival;
}

}  // namespace parian

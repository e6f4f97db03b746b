#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hot.h"
#include "base/parallel.h"
#include "material/dilated_slices_internal.h"

namespace parian {
namespace {

struct PlaneView {
  const float* log_profile;  // [knot][pixel]
  const float* inverse_dilation;
  const float* shift;
  const float* support;
  const float* tail_slope;
  const float* knots;
  const int* segment_of_bin;
  float bins_per_mm;
  int last_segment;
  std::size_t pixels;
};

PARIAN_HOT void eval_pixels(const PlaneView* view, float r, float* PARIAN_RESTRICT out,
                            std::size_t begin, std::size_t end) {
  const float last = view->knots[view->last_segment + 1];
  const std::size_t pixels = view->pixels;
  for (std::size_t i = begin; i < end; ++i) {
    const float u = r * view->inverse_dilation[i];
    const float inside = u < last ? u : last;
    int k = view->segment_of_bin[static_cast<int>(inside * view->bins_per_mm)];
    k += k < view->last_segment && inside >= view->knots[k + 1] ? 1 : 0;
    const float w = (inside - view->knots[k]) / (view->knots[k + 1] - view->knots[k]);
    const float a = view->log_profile[static_cast<std::size_t>(k) * pixels + i];
    const float b = view->log_profile[static_cast<std::size_t>(k + 1) * pixels + i];
    const float y = a + w * (b - a) + (u - inside) * view->tail_slope[i] + view->shift[i];
    out[i] = u <= view->support[i] ? y : -std::numeric_limits<float>::infinity();
  }
}

// The segment at the start of each bin; a bin is no longer than the shortest segment, so at most
// one knot lies inside it.
void fill_bins(DilatedMap& dilated) {
  const std::vector<double>& knots = dilated.map->knots_mm;
  dilated.knots.assign(knots.begin(), knots.end());
  double shortest = knots.back();
  for (std::size_t k = 1; k < knots.size(); ++k)
    shortest = std::min(shortest, knots[k] - knots[k - 1]);
  const double bins = std::clamp(std::ceil(1.01 * knots.back() / shortest), 1.0, 1e6);
  dilated.bins_per_mm = static_cast<float>(bins / knots.back());
  std::size_t segment = 0;
  dilated.segment_of_bin.reserve(static_cast<std::size_t>(bins) + 2);
  for (int b = 0; b < static_cast<int>(bins) + 2; ++b) {
    const float start = static_cast<float>(b) / dilated.bins_per_mm;
    while (segment + 2 < knots.size() && dilated.knots[segment + 1] <= start) ++segment;
    dilated.segment_of_bin.push_back(static_cast<int>(segment));
  }
}

}  // namespace

DilatedMap make_dilated_map(const ProfileMap& map) {
  DilatedMap dilated;
  dilated.map = &map;
  fill_bins(dilated);
  const std::size_t values = map.pixels() * static_cast<std::size_t>(map.channels);
  for (std::vector<float>* plane :
       {&dilated.inverse_dilation, &dilated.shift, &dilated.support, &dilated.tail_slope})
    plane->resize(values);
  parallel_for_blocks(values, 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<double> row(map.knots_mm.size());
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t c = i / map.pixels(), pixel = i % map.pixels();
      for (std::size_t k = 0; k < row.size(); ++k)
        row[k] =
            static_cast<double>(knot_plane(map, static_cast<int>(c), static_cast<int>(k))[pixel]);
      const double gain = map.gain.empty() ? 1 : static_cast<double>(map.gain[i]);
      const double dilation = map.dilation.empty() ? 1 : static_cast<double>(map.dilation[i]);
      dilated.inverse_dilation[i] = static_cast<float>(1 / dilation);
      dilated.shift[i] = static_cast<float>(std::log(gain) - 2 * std::log(dilation));
      dilated.support[i] = static_cast<float>(profile_support(map.knots_mm, row));
      dilated.tail_slope[i] = static_cast<float>(tail_slope(map.knots_mm, row));
    }
  });
  return dilated;
}

void eval_log_plane(const DilatedMap& dilated, int channel, double r_mm, float* out) {
  const ProfileMap& map = *dilated.map;
  const std::size_t first = static_cast<std::size_t>(channel) * map.pixels();
  const PlaneView view{.log_profile = knot_plane(map, channel, 0),
                       .inverse_dilation = &dilated.inverse_dilation[first],
                       .shift = &dilated.shift[first],
                       .support = &dilated.support[first],
                       .tail_slope = &dilated.tail_slope[first],
                       .knots = dilated.knots.data(),
                       .segment_of_bin = dilated.segment_of_bin.data(),
                       .bins_per_mm = dilated.bins_per_mm,
                       .last_segment = static_cast<int>(dilated.knots.size()) - 2,
                       .pixels = map.pixels()};
  eval_pixels(&view, static_cast<float>(r_mm), out, 0, map.pixels());
}

}  // namespace parian

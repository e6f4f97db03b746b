// Raw appearance vectors of profiles (on common radii) and of measured scattering.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/hot.h"
#include "base/parallel.h"
#include "base/random.h"
#include "edit/features_internal.h"
#include "math/fast_math.h"

namespace parian {
namespace {

constexpr double log_floor = -16;

// A radius at which all profiles are compared: there, ln P = y_k + w (y_{k+1} - y_k), or beyond
// the last knot ln P = y_n + w slope.
struct Node {
  double r_mm = 0;
  float weight = 0;  // sqrt(c)
  std::size_t knot = 0;
  float w = 0;
  bool tail = false;
};

void place(const std::vector<double>& knots, Node& node) {
  const std::size_t last = knots.size() - 1;
  node.tail = node.r_mm >= knots[last];
  node.knot = last;
  node.w = static_cast<float>(node.r_mm - knots[last]);
  if (node.tail) return;
  node.knot = static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), node.r_mm) -
                                       knots.begin()) -
              1;
  node.w = static_cast<float>((node.r_mm - knots[node.knot]) /
                              (knots[node.knot + 1] - knots[node.knot]));
}

// Two Gauss nodes between each two cuts; the weight contains r unless `logarithm`.
std::vector<Node> make_nodes(const std::vector<double>& knots, const std::vector<double>& cuts,
                             bool logarithm) {
  std::vector<Node> nodes;
  nodes.reserve(2 * cuts.size());
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double half = (cuts[k + 1] - cuts[k]) / 2, centre = (cuts[k + 1] + cuts[k]) / 2;
    for (const double side : {-1.0, 1.0}) {
      Node node;
      node.r_mm = centre + side * half / std::sqrt(3.0);
      node.weight = static_cast<float>(
          std::sqrt((logarithm ? half : half * node.r_mm) / (cuts.back() * cuts.back())));
      place(knots, node);
      nodes.push_back(node);
    }
  }
  return nodes;
}

// Where common radii are cut: at the knots, as the least dilated pixel has them and then, farther
// out, as the most dilated; with `tail` on to 4 times the last.
std::vector<double> make_cuts(const ProfileMap& map, bool tail) {
  double least = 1, most = 1;
  if (!map.dilation.empty()) {
    const auto [low, high] = std::minmax_element(map.dilation.begin(), map.dilation.end());
    least = static_cast<double>(*low);
    most = static_cast<double>(*high);
  }
  std::vector<double> cuts;
  cuts.reserve(2 * map.knots_mm.size() + 2);
  for (const double knot : map.knots_mm) cuts.push_back(knot * least);
  for (const double knot : map.knots_mm)
    if (knot * most > cuts.back()) cuts.push_back(knot * most);
  if (cuts.size() < 2) return {0, 1};  // a single knot at 0: the profile has no support
  const double last = cuts.back();
  if (tail) cuts.insert(cuts.end(), {2 * last, support_limit * last});
  return cuts;
}

PARIAN_HOT void blend_knots(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b, float w,
                            const float* PARIAN_RESTRICT shift, float* PARIAN_RESTRICT out,
                            std::size_t count) {
  const float v = 1 - w;
  for (std::size_t i = 0; i < count; ++i) out[i] = v * a[i] + w * b[i] + shift[i];
}

// Beyond the last knot, with tail_slope.
PARIAN_HOT void extend_tail(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                            float inverse_h, float steepest, float w,
                            const float* PARIAN_RESTRICT shift, float* PARIAN_RESTRICT out,
                            std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float slope = (b[i] - a[i]) * inverse_h;
    out[i] = b[i] + w * (slope < steepest ? slope : steepest) + shift[i];
  }
}

PARIAN_HOT void clamp_and_scale(float low, float high, float factor, float* values,
                                std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    float v = values[i] < low ? low : values[i];
    v = v > high ? high : v;
    values[i] = v * factor;
  }
}

struct ProfileFill {
  const ProfileMap& map;
  std::vector<Node> nodes;
  bool logarithm = false;
  std::vector<float> shift;  // [channel][pixel]: ln gain - 2 ln dilation - ln of the map's largest

  void undilated(std::size_t channel, const Node& node, std::size_t begin, std::size_t count,
                 float* out) const;
  void dilated(std::size_t channel, std::size_t pixel, std::size_t stride, float* out) const;
  void operator()(std::size_t begin, std::size_t count, float* out) const;
};

const float* plane_at(const ProfileMap& map, std::size_t channel, std::size_t knot) {
  return knot_plane(map, static_cast<int>(channel), static_cast<int>(knot));
}

void ProfileFill::undilated(std::size_t channel, const Node& node, std::size_t begin,
                            std::size_t count, float* out) const {
  const float* row_shift = shift.data() + channel * map.pixels() + begin;
  const std::size_t last = map.knots_mm.size() - 1;
  if (!node.tail)
    return blend_knots(plane_at(map, channel, node.knot) + begin,
                       plane_at(map, channel, node.knot + 1) + begin, node.w, row_shift, out,
                       count);
  const float* end = plane_at(map, channel, last) + begin;
  if (last == 0) return blend_knots(end, end, 0, row_shift, out, count);
  const double h = map.knots_mm[last] - map.knots_mm[last - 1];
  extend_tail(plane_at(map, channel, last - 1) + begin, end, static_cast<float>(1 / h),
              static_cast<float>(-min_tail_decay / map.knots_mm[last]), node.w, row_shift, out,
              count);
}

// Nodes come in order of radius, so the pixel's own knots are walked once.
void ProfileFill::dilated(std::size_t channel, std::size_t pixel, std::size_t stride,
                          float* out) const {
  const std::vector<double>& knots = map.knots_mm;
  const std::size_t last = knots.size() - 1, at = channel * map.pixels() + pixel;
  const double inverse = 1 / static_cast<double>(map.dilation[at]);
  const auto value = [&](std::size_t k) {
    return static_cast<double>(plane_at(map, channel, k)[pixel]);
  };
  double slope = last > 0 ? -min_tail_decay / knots[last] : 0;
  if (last > 0)
    slope = std::min(slope, (value(last) - value(last - 1)) / (knots[last] - knots[last - 1]));
  std::size_t k = 0;
  for (std::size_t q = 0; q < nodes.size(); ++q) {
    const double r = nodes[q].r_mm * inverse;
    while (k < last && knots[k + 1] <= r) ++k;
    double y = value(k);
    if (k == last)
      y += slope * (r - knots[last]);
    else
      y += (r - knots[k]) / (knots[k + 1] - knots[k]) * (value(k + 1) - y);
    out[q * stride] = static_cast<float>(y) + shift[at];
  }
}

void ProfileFill::operator()(std::size_t begin, std::size_t count, float* out) const {
  for (std::size_t c = 0; c < static_cast<std::size_t>(map.channels); ++c) {
    float* planes = out + c * nodes.size() * count;
    if (map.dilation.empty())
      for (std::size_t q = 0; q < nodes.size(); ++q)
        undilated(c, nodes[q], begin, count, planes + q * count);
    else
      for (std::size_t i = 0; i < count; ++i) dilated(c, begin + i, count, planes + i);
    if (!logarithm) exp_array(planes, planes, nodes.size() * count);
    for (std::size_t q = 0; q < nodes.size(); ++q)
      clamp_and_scale(logarithm ? static_cast<float>(log_floor) : 0, 1, nodes[q].weight,
                      planes + q * count, count);
  }
}

// ln of gain / dilation^2, less the largest ln P of all pixels and channels.
std::vector<float> make_shift(const ProfileMap& map) {
  const std::size_t planes = static_cast<std::size_t>(map.channels);
  std::vector<float> shift(planes * map.pixels(), 0.0F), other(map.dilation.size());
  if (!map.gain.empty()) log_array(map.gain.data(), shift.data(), shift.size());
  if (!map.dilation.empty()) log_array(map.dilation.data(), other.data(), other.size());
  for (std::size_t i = 0; i < other.size(); ++i) shift[i] -= 2 * other[i];
  std::vector<float> top(planes * map.height, -std::numeric_limits<float>::infinity());
  parallel_for(top.size(), [&](std::size_t row) {
    const auto width = static_cast<std::size_t>(map.width);
    const std::size_t c = row / static_cast<std::size_t>(map.height);
    const std::size_t begin = row % static_cast<std::size_t>(map.height) * width;
    for (std::size_t k = 0; k < map.knots_mm.size(); ++k) {
      const float* plane = plane_at(map, c, k) + begin;
      const float* s = shift.data() + c * map.pixels() + begin;
      for (std::size_t x = 0; x < width; ++x) top[row] = std::max(top[row], plane[x] + s[x]);
    }
  });
  const float largest = *std::max_element(top.begin(), top.end());
  for (float& s : shift) s -= largest;
  return shift;
}

Features make_features_of(const ProfileMap& map, bool logarithm, int dims) {
  check(map, {});
  const ProfileFill fill{.map = map,
                         .nodes = make_nodes(map.knots_mm, make_cuts(map, !logarithm), logarithm),
                         .logarithm = logarithm,
                         .shift = make_shift(map)};
  return reduce_features(
      map.width, map.height, map.channels * static_cast<int>(fill.nodes.size()), dims,
      [&](std::size_t begin, std::size_t count, float* out) { fill(begin, count, out); });
}

constexpr std::size_t projected = 32;

// out[j] += sign[j] in, for values that were measured
PARIAN_HOT void add_projected(const float* PARIAN_RESTRICT in, const float* PARIAN_RESTRICT sign,
                              float* PARIAN_RESTRICT out, std::size_t stride, std::size_t count) {
  for (std::size_t j = 0; j < projected; ++j)
    for (std::size_t i = 0; i < count; ++i) out[j * stride + i] += sign[j] * in[i];
}

std::array<float, projected> random_signs(std::uint64_t seed, std::uint64_t stream) {
  std::array<float, projected> signs{};
  const std::uint64_t bits = hash_u64(seed, stream);
  for (std::size_t j = 0; j < projected; ++j) signs[j] = (bits >> j) & 1u ? 1.0F : -1.0F;
  return signs;
}

// Adds the slice of offset d, each value at its pixel moved by `to`, to raw [projected][pixel].
void add_slice(const TableHeader& header, Offset d, Offset to, const float* slice,
               const std::array<float, projected>& signs, std::vector<float>& raw) {
  const PixelRange range = pairs_in_grid(header, d);
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return;
  const auto count = static_cast<std::size_t>(range.x1 - range.x0);
  const auto width = static_cast<std::size_t>(header.width);
  parallel_for_blocks(
      static_cast<std::size_t>(range.y1 - range.y0), 16, [&](std::size_t y0, std::size_t y1) {
        std::vector<float> row(count);
        for (std::size_t y = y0; y < y1; ++y) {
          const std::size_t from =
              (static_cast<std::size_t>(range.y0) + y) * width + static_cast<std::size_t>(range.x0);
          for (std::size_t i = 0; i < count; ++i)
            row[i] = std::isfinite(slice[from + i]) ? slice[from + i] : 0.0F;
          const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(from) +
                                    to.dy * static_cast<std::ptrdiff_t>(width) + to.dx;
          add_projected(row.data(), signs.data(), raw.data() + at, header.pixels(), count);
        }
      });
}

}  // namespace

Features make_profile_features(const ProfileMap& map, int dims) {
  return make_features_of(map, false, dims);
}

Features make_log_profile_features(const ProfileMap& map, int dims) {
  return make_features_of(map, true, dims);
}

Features make_bssrdf_features(const SliceSource& source, int dims, std::uint64_t seed) {
  const TableHeader& header = source.header();
  const std::size_t pixels = header.pixels();
  std::vector<float> raw(projected * pixels, 0.0F);
  for_each_slice(source, {}, "features", [&](int channel, int index, const float* slice) {
    const std::uint64_t stream = 2 * (static_cast<std::uint64_t>(channel) * header.offsets.size() +
                                      static_cast<std::uint64_t>(index));
    const Offset d = header.offsets[static_cast<std::size_t>(index)];
    // R(x, x + d) belongs to x, and the same value as R(x + d, x) to x + d.
    add_slice(header, d, {}, slice, random_signs(seed, stream), raw);
    if (pair_count(header, d) == 2)
      add_slice(header, d, d, slice, random_signs(seed, stream + 1), raw);
  });
  const auto [low, high] = std::minmax_element(raw.begin(), raw.end());
  const float largest = std::max(-*low, *high);
  const float scale = largest > 0 ? 1 / largest : 1;
  return reduce_features(header.width, header.height, static_cast<int>(projected), dims,
                         [&](std::size_t begin, std::size_t count, float* out) {
                           for (std::size_t j = 0; j < projected; ++j)
                             for (std::size_t i = 0; i < count; ++i)
                               out[j * count + i] = scale * raw[j * pixels + begin + i];
                         });
}

}  // namespace parian

#include "bench/reference/lsp_clusters.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "bench/reference/matrix_product.h"
#include "fit/fit.h"
#include "material/material.h"

namespace parian {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMap = Eigen::Map<const Matrix>;
constexpr std::size_t row_block = 256;
constexpr std::size_t centre_block = 512;
constexpr std::size_t one_by_one = 1024;  // centres picked by k-means++; the rest all at once
constexpr double step_work = 2e11;        // multiplications spent on Lloyd's iterations

Eigen::Index index(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

float squared_distance(const float* a, const float* b, std::size_t dimension) {
  return (Eigen::Map<const Eigen::VectorXf>(a, index(dimension)) -
          Eigen::Map<const Eigen::VectorXf>(b, index(dimension)))
      .squaredNorm();
}

struct Rows {
  const std::vector<float>& values;
  std::size_t dimension;
  std::size_t count() const { return values.size() / dimension; }
  const float* operator[](std::size_t i) const { return values.data() + i * dimension; }
};

// The remaining centres without replacement, by squared distance to those that are there: the
// largest u^(1 / distance) (Efraimidis and Spirakis 2006).
void pick_remaining(const std::vector<float>& distance, std::size_t count, Rng& rng,
                    std::vector<std::size_t>& picked) {
  std::vector<std::pair<double, std::size_t>> keys;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const double uniform = sample_uniform(rng);
    if (distance[i] > 0)
      keys.emplace_back(-std::log(1 - uniform) / static_cast<double>(distance[i]), i);
  }
  const std::size_t more = std::min(count - picked.size(), keys.size());
  std::partial_sort(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(more), keys.end());
  for (std::size_t i = 0; i < more; ++i) picked.push_back(keys[i].second);
}

std::vector<std::size_t> pick_centres(const Rows& rows, std::size_t count, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<float> distance(rows.count(), std::numeric_limits<float>::max());
  std::vector<std::size_t> picked{
      std::min(rows.count() - 1,
               static_cast<std::size_t>(sample_uniform(rng) * static_cast<double>(rows.count())))};
  while (true) {
    const float* last = rows[picked.back()];
    parallel_for_blocks(rows.count(), row_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        distance[i] = std::min(distance[i], squared_distance(rows[i], last, rows.dimension));
    });
    if (picked.size() == count) return picked;
    if (picked.size() == one_by_one) {
      pick_remaining(distance, count, rng, picked);
      return picked;
    }
    double total = 0;
    for (const float value : distance) total += static_cast<double>(value);
    double left = sample_uniform(rng) * total;
    std::size_t next = rows.count();
    for (std::size_t i = 0; i < rows.count() && left >= 0; ++i) {
      if (!(distance[i] > 0)) continue;
      left -= static_cast<double>(distance[i]);
      next = i;
    }
    if (next == rows.count()) return picked;  // every row is a centre
    picked.push_back(next);
  }
}

// Nearest centre of each row; returns the sum of squared distances.
double assign(const Rows& rows, Clusters& clusters) {
  const std::size_t count = clusters.centre.size() / rows.dimension;
  const ConstMap centres(clusters.centre.data(), index(count), index(rows.dimension));
  const Eigen::VectorXf norm = centres.rowwise().squaredNorm();
  return parallel_sum(rows.count(), row_block, [&](std::size_t begin, std::size_t end) {
    std::vector<float> lowest(end - begin, std::numeric_limits<float>::max());
    Matrix product;
    for (std::size_t first = 0; first < count; first += centre_block) {
      const std::size_t width = std::min(centre_block, count - first);
      product.resize(index(end - begin), index(width));
      multiply_block_by_transposed(rows[begin], end - begin, rows.dimension,
                                   &clusters.centre[first * rows.dimension], width, product.data());
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t j = 0; j < width; ++j) {
          const float value = norm[index(first + j)] - 2 * product(index(i - begin), index(j));
          if (value >= lowest[i - begin]) continue;
          lowest[i - begin] = value;
          clusters.index[i] = static_cast<std::uint16_t>(first + j);
        }
    }
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      sum += static_cast<double>(squared_distance(
          rows[i], &clusters.centre[clusters.index[i] * rows.dimension], rows.dimension));
    return sum;
  });
}

// Every centre becomes the mean of its rows; those without rows stay.
void move_centres(const Rows& rows, Clusters& clusters) {
  std::vector<double> sum(clusters.centre.size(), 0.0);
  std::vector<double> count(clusters.centre.size() / rows.dimension, 0.0);
  for (std::size_t i = 0; i < rows.count(); ++i) {
    const std::size_t j = clusters.index[i];
    count[j] += 1;
    for (std::size_t k = 0; k < rows.dimension; ++k)
      sum[j * rows.dimension + k] += static_cast<double>(rows[i][k]);
  }
  for (std::size_t j = 0; j < count.size(); ++j)
    for (std::size_t k = 0; count[j] > 0 && k < rows.dimension; ++k)
      clusters.centre[j * rows.dimension + k] =
          static_cast<float>(sum[j * rows.dimension + k] / count[j]);
}

// [pixel][channel][knot]
std::vector<float> gather_profiles(const ProfileMap& map) {
  const std::size_t dimension = static_cast<std::size_t>(map.channels) * map.knots_mm.size();
  std::vector<float> rows(map.pixels() * dimension);
  for (std::size_t i = 0; i < dimension; ++i)
    for (std::size_t x = 0; x < map.pixels(); ++x)
      rows[x * dimension + i] = map.log_profile[i * map.pixels() + x];
  return rows;
}

// Slices of the clustered profiles, written out as a map.
class ClusterSource : public SliceSource {
 public:
  ClusterSource(ProfileMap map, const TableHeader& like, std::string name)
      : material_(std::move(map)), slices_(make_slices(material_, like, std::move(name))) {}
  const TableHeader& header() const override { return slices_->header(); }
  std::string name() const override { return slices_->name(); }
  void read_slice(int channel, int offset_index, float* slice) const override {
    slices_->read_slice(channel, offset_index, slice);
  }

 private:
  Material material_;
  std::unique_ptr<SliceSource> slices_;
};

ProfileMap write_out(const ProfileBlend& blend, ProfileMap map) {
  const std::size_t dimension = static_cast<std::size_t>(map.channels) * map.knots_mm.size();
  for (std::size_t x = 0; x < map.pixels(); ++x)
    for (std::size_t i = 0; i < dimension; ++i)
      map.log_profile[i * map.pixels() + x] =
          blend.base_log_profile[blend.index[x] * dimension + i];
  return map;
}

}  // namespace

Clusters cluster_rows(const std::vector<float>& values, std::size_t dimension, std::size_t count,
                      int steps, std::uint64_t seed) {
  const Rows rows{values, dimension};
  PARIAN_CHECK_LE(count, static_cast<std::size_t>(max_bases));
  PARIAN_CHECK_LT(std::size_t{0}, std::min(count, rows.count()));
  Clusters clusters;
  for (const std::size_t i : pick_centres(rows, std::min(count, rows.count()), seed))
    clusters.centre.insert(clusters.centre.end(), rows[i], rows[i] + dimension);
  clusters.index.assign(rows.count(), 0);
  clusters.objective.push_back(assign(rows, clusters));
  for (int step = 0; step < steps && clusters.objective.back() > 0; ++step) {
    const std::vector<std::uint16_t> before = clusters.index;
    move_centres(rows, clusters);
    clusters.objective.push_back(assign(rows, clusters));
    if (clusters.index == before) break;
  }
  return clusters;
}

ProfileBlend cluster_profiles(const ProfileMap& map, std::size_t bases, std::uint64_t seed) {
  std::vector<float> rows = gather_profiles(map);
  const std::size_t dimension = static_cast<std::size_t>(map.channels) * map.knots_mm.size();
  const double work = static_cast<double>(rows.size()) * static_cast<double>(bases);
  const int steps = static_cast<int>(std::clamp(step_work / work, 2.0, 50.0));
  const Clusters clusters = cluster_rows(rows, dimension, bases, steps, seed);
  ProfileBlend blend;
  blend.width = map.width;
  blend.height = map.height;
  blend.channels = map.channels;
  blend.per_pixel = 1;
  blend.pixel_pitch_mm = map.pixel_pitch_mm;
  blend.boundary = map.boundary;
  blend.eta = map.eta;
  blend.knots_mm = map.knots_mm;
  blend.base_log_profile = clusters.centre;
  blend.index = clusters.index;
  return blend;
}

std::size_t count_clusters(const ProfileMap& map, std::size_t bytes) {
  const std::size_t base =
      sizeof(float) * static_cast<std::size_t>(map.channels) * map.knots_mm.size();
  const std::size_t most = std::min<std::size_t>(map.pixels(), max_bases);
  const std::size_t narrow = bytes > map.pixels() ? (bytes - map.pixels()) / base : 0;
  const std::size_t wide = bytes > 2 * map.pixels() ? (bytes - 2 * map.pixels()) / base : 0;
  return std::min(most, std::max(std::min<std::size_t>(narrow, 256), wide));
}

Rival compress_lsp_clusters(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed) {
  const Stopwatch watch;
  FitParams params;
  params.fill_unmeasured = true;
  ProfileMap map = fit_profiles(*make_slices(table), params).map;
  const std::size_t bases = count_clusters(map, bytes);
  Rival rival{.name = "LSP clusters"};
  if (bases == 0) return rival;
  const ProfileBlend blend = cluster_profiles(map, bases, seed);
  const std::size_t found = blend.base_log_profile.size() /
                            (map.knots_mm.size() * static_cast<std::size_t>(map.channels));
  rival.bytes = sizeof(float) * blend.base_log_profile.size() +
                map.pixels() * (found <= 256 ? std::size_t{1} : std::size_t{2});
  rival.slices =
      std::make_unique<ClusterSource>(write_out(blend, std::move(map)), table.header, rival.name);
  rival.seconds = watch.seconds();
  return rival;
}

}  // namespace parian

// Weighted sample elimination (Yuksel 2015, section 3): the candidate with the most and nearest
// neighbours goes, again and again, until the wanted number remains. Weights are integers, so that
// sums do not depend on their order, and a queue by buckets of weight replaces the heap.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "mesh/sample_elimination_internal.h"

namespace parian {
namespace {

constexpr std::size_t block = 2048;
// Two surface points see each other when their normals are less than about 107 degrees apart:
// across the edges of a box, but not from one side of a thin sheet to the other.
constexpr float least_cosine = -0.3f;

// Candidates in rows along the box's longest axis, sorted along it within each row: neighbours are
// short runs of nine rows.
struct Rows {
  int along = 0;   // axis of the rows
  int across = 1;  // the two others
  int up = 2;
  float lower_across = 0;
  float lower_up = 0;
  float cell_across = 1;
  float cell_up = 1;
  int count_across = 1;
  int count_up = 1;
  std::vector<std::uint32_t> begin;  // [count_up * count_across + 1]
};

Rows make_rows(const std::vector<Candidate>& candidates, float radius) {
  Bounds3 box;
  for (const Candidate& c : candidates) extend(box, c.position);
  const Vec3 size = extent(box);
  Rows rows;
  rows.along = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  rows.across = (rows.along + 1) % 3;
  rows.up = (rows.along + 2) % 3;
  // Cells no smaller than the radius; larger where the pieces of a mesh lie far apart.
  const auto limit =
      static_cast<float>(std::sqrt(2.0 * static_cast<double>(candidates.size())) + 8);
  rows.cell_across = std::max(radius, component(size, rows.across) / limit);
  rows.cell_up = std::max(radius, component(size, rows.up) / limit);
  rows.lower_across = component(box.lower, rows.across);
  rows.lower_up = component(box.lower, rows.up);
  rows.count_across = static_cast<int>(component(size, rows.across) / rows.cell_across) + 1;
  rows.count_up = static_cast<int>(component(size, rows.up) / rows.cell_up) + 1;
  return rows;
}

int cell_of(float value, float lower, float size, int count) {
  return std::clamp(static_cast<int>((value - lower) / size), 0, count - 1);
}

// Sorts the candidates by row and along it, and fills rows.begin.
void sort_into_rows(Rows& rows, std::vector<Candidate>& candidates) {
  const std::size_t count = candidates.size();
  std::vector<std::uint32_t> row(count);
  rows.begin.assign(static_cast<std::size_t>(rows.count_across) * rows.count_up + 2, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = candidates[i].position;
    const int up = cell_of(component(p, rows.up), rows.lower_up, rows.cell_up, rows.count_up);
    row[i] = static_cast<std::uint32_t>(
        up * rows.count_across +
        cell_of(component(p, rows.across), rows.lower_across, rows.cell_across, rows.count_across));
    ++rows.begin[std::size_t{row[i]} + 2];
  }
  std::partial_sum(rows.begin.begin(), rows.begin.end(), rows.begin.begin());
  std::vector<std::pair<float, std::uint32_t>> order(count);
  for (std::size_t i = 0; i < count; ++i)
    order[rows.begin[std::size_t{row[i]} + 1]++] = {component(candidates[i].position, rows.along),
                                                    static_cast<std::uint32_t>(i)};
  rows.begin.pop_back();
  parallel_for_blocks(rows.begin.size() - 1, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r)
      std::sort(order.begin() + rows.begin[r], order.begin() + rows.begin[r + 1]);
  });
  std::vector<Candidate> sorted(count);
  for (std::size_t i = 0; i < count; ++i) sorted[i] = candidates[order[i].second];
  candidates = std::move(sorted);
}

// What a candidate at distance d adds to its neighbour's weight: (1 - d / 2 r_max)^8, d at least
// r_min, in units of 2^-16.
struct Weighting {
  float squared_radius = 0;  // (2 r_max)^2
  float scale = 0;           // 1 / (2 r_max)
  float least_distance = 0;  // r_min
};

Weighting make_weighting(std::size_t candidates, std::size_t count, double area) {
  const auto n = static_cast<double>(count);
  const double r_max = std::sqrt(area / (2 * std::sqrt(3.0) * n));
  // Equation 4 with beta = 0.65, gamma = 1.5: keeps the remaining points from clumping.
  const double r_min = r_max * (1 - std::pow(n / static_cast<double>(candidates), 1.5)) * 0.65;
  return {static_cast<float>(4 * r_max * r_max), static_cast<float>(0.5 / r_max),
          static_cast<float>(r_min)};
}

std::uint32_t pair_weight(const Weighting& weighting, float squared_distance) {
  const float d = std::max(std::sqrt(squared_distance), weighting.least_distance);
  const float a = std::max(0.0f, 1 - d * weighting.scale);
  const float a4 = a * a * a * a;
  return static_cast<std::uint32_t>(a4 * a4 * 65536);
}

// What the search for neighbours reads of a candidate: 16 bytes, in the order of the rows.
struct Point {
  float along = 0;
  float across = 0;
  float up = 0;
  std::uint32_t normal = 0;  // 10 bits per component
};

std::uint32_t pack_normal(Vec3 n) {
  const auto bits = [](float v) { return static_cast<std::uint32_t>(std::lround((v + 1) * 511)); };
  return bits(n.x) | bits(n.y) << 10u | bits(n.z) << 20u;
}

float packed_cosine(std::uint32_t a, std::uint32_t b) {
  const auto value = [](std::uint32_t word, unsigned shift) {
    return static_cast<int>(word >> shift & 1023u) - 511;
  };
  const int sum =
      value(a, 0) * value(b, 0) + value(a, 10) * value(b, 10) + value(a, 20) * value(b, 20);
  return static_cast<float>(sum) * (1.0f / (511 * 511));
}

struct Field {
  std::vector<Point> points;
  Rows rows;
  Weighting weighting;
};

// How far a coordinate is from cell `cell` of its axis; zero inside.
float distance_to_cell(float value, float lower, float size, int cell) {
  const float begin = lower + size * static_cast<float>(cell);
  return std::max({0.0f, begin - value, value - (begin + size)});
}

// Calls visit(j, weight) for the candidates that see candidate i, in a fixed order.
template <typename Visit>
void visit_neighbours(const Field& field, std::size_t i, const Visit& visit) {
  const Rows& rows = field.rows;
  const Point c = field.points[i];
  const float limit = field.weighting.squared_radius;
  const int x = cell_of(c.across, rows.lower_across, rows.cell_across, rows.count_across);
  const int y = cell_of(c.up, rows.lower_up, rows.cell_up, rows.count_up);
  for (int v = std::max(0, y - 1); v <= std::min(rows.count_up - 1, y + 1); ++v) {
    const float up = distance_to_cell(c.up, rows.lower_up, rows.cell_up, v);
    for (int u = std::max(0, x - 1); u <= std::min(rows.count_across - 1, x + 1); ++u) {
      const float across = distance_to_cell(c.across, rows.lower_across, rows.cell_across, u);
      // A little more than what is left of the sphere: cells' ends are rounded.
      const float left = limit * 1.001f - up * up - across * across;
      if (left <= 0) continue;
      const float reach = std::sqrt(left);
      const std::size_t row = static_cast<std::size_t>(v) * rows.count_across + u;
      const Point* end = field.points.data() + rows.begin[row + 1];
      const Point* at =
          std::lower_bound(field.points.data() + rows.begin[row], end, c.along - reach,
                           [](const Point& p, float value) { return p.along < value; });
      for (; at != end && at->along <= c.along + reach; ++at) {
        const float dx = at->along - c.along, dy = at->across - c.across, dz = at->up - c.up;
        const float squared = dx * dx + dy * dy + dz * dz;
        if (squared >= limit || packed_cosine(at->normal, c.normal) <= least_cosine) continue;
        const auto j = static_cast<std::size_t>(at - field.points.data());
        if (j != i) visit(j, pair_weight(field.weighting, squared));
      }
    }
  }
}

std::vector<std::uint32_t> sum_weights(const Field& field, std::size_t count) {
  std::vector<std::uint32_t> weights(count);
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint64_t sum = 0;
      visit_neighbours(field, i, [&](std::size_t, std::uint32_t weight) { sum += weight; });
      weights[i] = static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, ~0u));
    }
  });
  return weights;
}

// Candidates by weight. Weights only fall, so that a candidate found in a bucket above its own is
// moved down when it is met.
class BucketQueue {
 public:
  explicit BucketQueue(const std::vector<std::uint32_t>& weights)
      : head_(bucket_count, none), next_(weights.size(), none) {
    for (std::size_t i = weights.size(); i-- > 0;) push(i, weights[i]);
  }
  // The candidate of the largest weight, within a bucket's width; removed from the queue.
  std::size_t pop(const std::vector<std::uint32_t>& weights) {
    while (true) {
      while (head_[top_] == none) --top_;
      const std::uint32_t i = head_[top_];
      head_[top_] = next_[i];
      if (bucket_of(weights[i]) == top_) return i;
      push(i, weights[i]);
    }
  }

 private:
  static constexpr std::uint32_t none = ~0u;
  static constexpr std::size_t bucket_count = std::size_t{1} << 16u;
  static std::size_t bucket_of(std::uint32_t weight) {
    return std::min<std::size_t>(weight / 16, bucket_count - 1);
  }
  void push(std::size_t i, std::uint32_t weight) {
    std::uint32_t& head = head_[bucket_of(weight)];
    next_[i] = head;
    head = static_cast<std::uint32_t>(i);
  }

  std::vector<std::uint32_t> head_;
  std::vector<std::uint32_t> next_;
  std::size_t top_ = bucket_count - 1;
};

// How many candidates may go from each group.
std::vector<std::uint32_t> find_surplus(const std::vector<Candidate>& candidates, std::size_t count,
                                        std::size_t per_group) {
  std::vector<std::uint32_t> surplus;
  for (const Candidate& c : candidates) {
    if (c.group >= surplus.size()) surplus.resize(std::size_t{c.group} + 1, 0);
    ++surplus[c.group];
  }
  for (std::size_t g = 0; g < surplus.size(); ++g)
    surplus[g] -= static_cast<std::uint32_t>(std::min(per_group, count - g * per_group));
  return surplus;
}

std::vector<char> eliminate(const Field& field, const std::vector<Candidate>& candidates,
                            std::size_t count, std::size_t per_group, const Progress& progress) {
  const std::size_t size = candidates.size();
  std::vector<std::uint32_t> surplus = find_surplus(candidates, count, per_group);
  std::vector<std::uint32_t> weights = sum_weights(field, size);
  advance_progress(progress, "samples", 0.4);
  BucketQueue queue(weights);
  std::vector<char> alive(size, 1);
  for (std::size_t left = size; left > count; --left) {
    std::size_t i = queue.pop(weights);
    // What its group cannot spare stays for good.
    while (surplus[candidates[i].group] == 0) i = queue.pop(weights);
    --surplus[candidates[i].group];
    alive[i] = 0;
    visit_neighbours(field, i, [&](std::size_t j, std::uint32_t weight) {
      weights[j] -= std::min(weights[j], weight);
    });
    if (left % 65536 == 0)
      advance_progress(
          progress, "samples",
          0.4 + 0.6 * static_cast<double>(size - left) / static_cast<double>(size - count));
  }
  return alive;
}

}  // namespace

void eliminate_samples(std::vector<Candidate>& candidates, std::size_t count, double area,
                       std::size_t per_group, const Progress& progress) {
  const Weighting weighting = make_weighting(candidates.size(), count, area);
  Rows rows = make_rows(candidates, std::sqrt(weighting.squared_radius));
  sort_into_rows(rows, candidates);
  std::vector<Point> points(candidates.size());
  parallel_for_blocks(points.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p = candidates[i].position;
      points[i] = {component(p, rows.along), component(p, rows.across), component(p, rows.up),
                   pack_normal(candidates[i].normal)};
    }
  });
  const Field field{std::move(points), std::move(rows), weighting};
  const std::vector<char> alive = eliminate(field, candidates, count, per_group, progress);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < alive.size(); ++i)
    if (alive[i] != 0) candidates[kept++] = candidates[i];
  candidates.resize(kept);
}

}  // namespace parian

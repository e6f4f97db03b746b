// One set of knots for the profiles of several materials.
#include <algorithm>
#include <cmath>
#include <limits>

#include "transport/layered_field.h"

namespace parian {
namespace {

constexpr int probes_per_side = 4;
constexpr float same_knot = 1e-5f;  // relative

std::vector<float> merge_knots(const std::vector<const ProfileField*>& fields) {
  std::vector<float> all;
  for (const ProfileField* field : fields)
    all.insert(all.end(), field->knots_mm.begin(), field->knots_mm.end());
  std::sort(all.begin(), all.end());
  const auto is_same = [](float a, float b) { return b - a <= same_knot * b; };
  const float last = all.back();
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
  all.back() = last;
  return all;
}

// A profile's half logarithm at the knots, on with its last slope.
struct Probe {
  std::vector<float> half_log;
  float support_mm = 0;
};

Probe probe_row(const std::vector<float>& own, const float* row, float support,
                const std::vector<float>& knots) {
  Probe probe{{}, support};
  probe.half_log.reserve(knots.size());
  std::size_t k = 0;
  for (const float knot : knots) {
    while (k + 2 < own.size() && own[k + 1] <= knot) ++k;
    const float t = (knot - own[k]) / (own[k + 1] - own[k]);
    probe.half_log.push_back((1 - t) * row[3 * k] + t * row[3 * k + 3]);
  }
  return probe;
}

// A few profiles of each field.
std::vector<Probe> probe_profiles(const std::vector<const ProfileField*>& fields,
                                  const std::vector<float>& knots) {
  std::vector<Probe> probes;
  for (const ProfileField* field : fields) {
    const int columns = std::min(probes_per_side, field->width);
    const int lines = std::min(probes_per_side, field->height);
    std::vector<float> row(field->row());
    for (int i = 0; i < columns * lines; ++i) {
      const int column = i % columns, line = i / columns;
      float support[3];
      field->eval((column + 0.5) * field->width / columns - 0.5,
                  (line + 0.5) * field->height / lines - 0.5, row.data(), support);
      for (std::size_t c = 0; c < 3; ++c)
        probes.push_back(probe_row(field->knots_mm, &row[c], support[c], knots));
    }
  }
  return probes;
}

// Without the knots whose loss changes the probes least, one after another, the first and the last
// staying.
std::vector<float> thin_knots(const std::vector<float>& knots, const std::vector<Probe>& probes,
                              std::size_t limit) {
  const std::size_t n = knots.size();
  std::vector<std::size_t> before(n), after(n);
  std::vector<float> cost(n, std::numeric_limits<float>::infinity());
  const auto find_cost = [&](std::size_t i) {
    const std::size_t a = before[i], b = after[i];
    const float t = (knots[i] - knots[a]) / (knots[b] - knots[a]);
    float largest = 0;
    for (const Probe& probe : probes) {
      if (knots[a] >= probe.support_mm) continue;
      const std::vector<float>& y = probe.half_log;
      largest = std::max(largest, std::abs((1 - t) * y[a] + t * y[b] - y[i]));
    }
    return largest;
  };
  for (std::size_t i = 0; i < n; ++i) before[i] = i - 1, after[i] = i + 1;
  for (std::size_t i = 1; i + 1 < n; ++i) cost[i] = find_cost(i);
  std::vector<char> is_gone(n, 0);
  for (std::size_t count = n; count > limit; --count) {
    const auto i =
        static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    is_gone[i] = 1;
    cost[i] = std::numeric_limits<float>::infinity();
    after[before[i]] = after[i];
    before[after[i]] = before[i];
    for (const std::size_t j : {before[i], after[i]})
      if (j > 0 && j + 1 < n) cost[j] = find_cost(j);
  }
  std::vector<float> kept;
  kept.reserve(limit);
  for (std::size_t i = 0; i < n; ++i)
    if (is_gone[i] == 0) kept.push_back(knots[i]);
  return kept;
}

// Halves the widest segments, in units of their distance plus that of the first knot.
void refine_knots(std::vector<float>& knots, std::size_t count) {
  const float first = knots[1];
  while (knots.size() < count) {
    std::size_t widest = 1;
    float most = 0;
    for (std::size_t k = 1; k < knots.size(); ++k) {
      const float width = (knots[k] - knots[k - 1]) / (knots[k] + knots[k - 1] + first);
      if (width > most) most = width, widest = k;
    }
    const float middle = knots[widest - 1] + (knots[widest] - knots[widest - 1]) / 2;
    knots.insert(knots.begin() + static_cast<std::ptrdiff_t>(widest), middle);
  }
}

}  // namespace

std::vector<float> make_common_knots(const std::vector<const ProfileField*>& fields, bool refined) {
  std::size_t limit = layered_knots;
  for (const ProfileField* field : fields) limit = std::max(limit, field->knots());
  std::vector<float> knots = merge_knots(fields);
  if (knots.size() > limit) knots = thin_knots(knots, probe_profiles(fields, knots), limit);
  if (refined) refine_knots(knots, layered_knots);
  return knots;
}

}  // namespace parian

#include "mesh/flaps_internal.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "mesh/topology_internal.h"

namespace parian {
namespace {

// Sorts three places; true when that took an odd number of exchanges.
bool sort_places(std::uint32_t* v) {
  bool odd = false;
  for (const auto& [i, j] : {std::pair{0, 1}, {1, 2}, {0, 1}}) {
    if (v[i] <= v[j]) continue;
    std::swap(v[i], v[j]);
    odd = !odd;
  }
  return odd;
}

}  // namespace

std::size_t cancel_flaps(TriangleMesh& mesh, std::span<const std::uint32_t> weld) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint32_t> places(3 * count);
  std::vector<char> odd(count), removed(count, 0);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) places[3 * t + k] = weld[mesh.triangles[t][k]];
    odd[t] = sort_places(&places[3 * t]) ? 1 : 0;
  }
  const std::vector<std::uint32_t> first = find_first_equals(places.data(), count, 3);
  // Faces of a group that have no opposite yet; the first waits from the beginning.
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> waiting;
  std::size_t total = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (first[t] == t) continue;
    std::vector<std::uint32_t>& group = waiting.try_emplace(first[t], 1, first[t]).first->second;
    if (!group.empty() && odd[group.back()] != odd[t]) {
      removed[group.back()] = removed[t] = 1;
      group.pop_back();
      total += 2;
    } else {
      group.push_back(t);
    }
  }
  if (2 * total > count) return 0;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < count; ++t)
    if (removed[t] == 0) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
  return total;
}

}  // namespace parian

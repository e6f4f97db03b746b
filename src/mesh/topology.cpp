// Hashing of equal vertices and grouping of edges, both linear in the mesh's size.
#include <algorithm>
#include <bit>
#include <cstring>

#include "base/random.h"
#include "mesh/topology_internal.h"

namespace parian {

std::vector<std::uint32_t> find_first_equals(const std::uint32_t* keys, std::size_t count,
                                             std::size_t words) {
  constexpr std::uint32_t empty = ~std::uint32_t{0};
  std::vector<std::uint32_t> table(std::bit_ceil(2 * count + 1), empty);
  const std::size_t mask = table.size() - 1;
  std::vector<std::uint32_t> first(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t* key = keys + i * words;
    std::uint64_t hash = 0;
    for (std::size_t w = 0; w < words; ++w) hash = hash_u64(hash ^ key[w]);
    std::size_t slot = hash & mask;
    while (table[slot] != empty &&
           std::memcmp(keys + table[slot] * words, key, words * sizeof *key) != 0)
      slot = (slot + 1) & mask;
    if (table[slot] == empty) table[slot] = static_cast<std::uint32_t>(i);
    first[i] = table[slot];
  }
  return first;
}

std::vector<std::uint32_t> weld_positions(std::span<const Vec3> positions) {
  std::vector<std::uint32_t> keys;
  keys.reserve(3 * positions.size());
  for (const Vec3& p : positions)
    for (const float value : {p.x, p.y, p.z})
      keys.push_back(std::bit_cast<std::uint32_t>(value + 0.0f));  // -0 + 0 = +0
  return find_first_equals(keys.data(), positions.size(), 3);
}

namespace detail {

EdgeCorners group_edges(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld) {
  const auto ends = [&](std::size_t corner) {
    const Triangle& t = triangles[corner / 3];
    return std::minmax(weld[t[corner % 3]], weld[t[(corner + 1) % 3]]);
  };
  const std::size_t corners = 3 * triangles.size();
  EdgeCorners edges;
  edges.begin.assign(weld.size() + 2, 0);
  edges.others.resize(corners);
  for (std::size_t c = 0; c < corners; ++c) ++edges.begin[std::size_t{ends(c).first} + 2];
  for (std::size_t v = 2; v < edges.begin.size(); ++v) edges.begin[v] += edges.begin[v - 1];
  for (std::size_t c = 0; c < corners; ++c) {
    const auto [low, high] = ends(c);
    edges.others[edges.begin[std::size_t{low} + 1]++] = {high, static_cast<std::uint32_t>(c)};
  }
  edges.begin.pop_back();
  for (std::size_t v = 0; v + 1 < edges.begin.size(); ++v)
    std::sort(edges.others.begin() + edges.begin[v], edges.others.begin() + edges.begin[v + 1]);
  return edges;
}

}  // namespace detail
}  // namespace parian

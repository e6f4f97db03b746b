#include "math/isotonic.h"

#include <algorithm>
#include <cstddef>

namespace parian {
namespace {

struct Pool {
  double sum = 0, weight = 0;
  std::size_t count = 0;
};

}  // namespace

bool make_non_increasing(std::vector<double>& values, const std::vector<double>& weights) {
  if (std::is_sorted(values.rbegin(), values.rend())) return false;
  std::vector<Pool> pools;
  for (std::size_t k = 0; k < values.size(); ++k) {
    pools.push_back({values[k] * weights[k], weights[k], 1});
    while (pools.size() > 1) {
      const Pool last = pools.back();
      Pool& before = pools[pools.size() - 2];
      if (before.sum * last.weight >= last.sum * before.weight) break;
      before = {before.sum + last.sum, before.weight + last.weight, before.count + last.count};
      pools.pop_back();
    }
  }
  std::size_t k = 0;
  for (const Pool& pool : pools)
    for (std::size_t i = 0; i < pool.count; ++i) values[k++] = pool.sum / pool.weight;
  // Quotients of neighbouring pools may round to a rise of one unit in the last place.
  for (k = 1; k < values.size(); ++k) values[k] = std::min(values[k], values[k - 1]);
  return true;
}

}  // namespace parian

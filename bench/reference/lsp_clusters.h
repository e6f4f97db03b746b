// LSP clusters, the baseline of the 2019 paper (section 3.1): the local scattering profiles of a
// SubEdit fit, all knots and channels of a pixel as one vector of logarithms, clustered by k-means.
#pragma once

#include <cstdint>

#include "bench/reference/rival.h"
#include "material/bssrdf_table.h"
#include "material/profile_blend.h"

namespace parian {

struct Clusters {
  std::vector<float> centre;         // [cluster][dimension]
  std::vector<std::uint16_t> index;  // of each row
  std::vector<double> objective;     // sum of squared distances after each assignment
};

// Lloyd's iterations from k-means++ (Arthur and Vassilvitskii 2007), until nothing changes or
// `steps`. At most `count` clusters: no more than there are distinct rows.
Clusters cluster_rows(const std::vector<float>& rows, std::size_t dimension, std::size_t count,
                      int steps, std::uint64_t seed);

// One base profile per pixel out of `bases`.
ProfileBlend cluster_profiles(const ProfileMap& map, std::size_t bases, std::uint64_t seed);

// The largest M with 4 C M S + N b <= bytes (b = 1 for M <= 256, else 2); 0 if there is none.
std::size_t count_clusters(const ProfileMap& map, std::size_t bytes);

Rival compress_lsp_clusters(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed = 1);

}  // namespace parian

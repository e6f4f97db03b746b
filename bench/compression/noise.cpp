// Compression of noisy tables: what a fit and blends made from one miss of the table without noise.
#include <fmt/format.h>

#include <cmath>

#include "bench/compression/study.h"
#include "material/test_noise.h"

namespace parian::compression {
namespace {

std::string show(const CompareReport& errors) {
  return fmt::format("{:.4f} / {:.4f}", errors.relative_error.mean, errors.albedo_error_mean);
}

// Against the clean table, of a table in the place of a model.
CompareReport judge_table(const BssrdfTable& clean, const BssrdfTable& noisy) {
  return compare(*make_slices(clean), *make_slices(noisy));
}

}  // namespace

void study_noise(const Page& page) {
  MarkdownTable table{{"photons per pixel", "the noisy table", "its fit", "balanced", "paper"}, {}};
  Sample clean = load_sample("artificial-stone");
  for (const double photons : {0.0, 1e6, 1e5, 1e4, 1e3}) {
    Sample sample = clean;
    if (photons > 0) {
      add_noise(sample.table, photon_gain(clean.table, photons), 0, 3);
      sample.map = fit_profiles(*make_slices(sample.table), {}).map;
    }
    std::vector<std::string> row{
        photons > 0 ? fmt::format("10^{:.0f}", std::log10(photons)) : "no noise",
        photons > 0 ? show(judge_table(clean.table, sample.table)) : "",
        show(judge(clean, Material(sample.map)))};
    for (const Objective objective : {Objective::balanced, Objective::paper}) {
      const Compressed compressed = compress_sample(sample, make_params(64, 2, objective));
      row.push_back(show(judge(clean, Material(compressed.blend))));
    }
    table.rows.push_back(std::move(row));
  }
  write_table(page, "noise",
              "Artificial stone with photon noise, K = 2, M = 64: mean relative / albedo error "
              "against the table without noise (`./run bench compress noise`).",
              table);
}

}  // namespace parian::compression

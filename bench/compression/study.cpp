#include "bench/compression/study.h"

#include <fmt/format.h>

#include <cstdio>

#include "bench/common/bench_table.h"
#include "bench/common/timing.h"
#include "io/hdf5/table_file.h"

namespace parian::compression {

Sample load_sample(const std::string& name) {
  Sample sample{name, read_table(*open_table(make_bench_table(name))), {}, 0};
  sample.fit_seconds =
      best_seconds(1, [&] { sample.map = fit_profiles(*make_slices(sample.table, name), {}).map; });
  return sample;
}

CompressParams make_params(int bases, int per_pixel, Objective objective) {
  CompressParams params;
  params.bases = bases;
  params.per_pixel = per_pixel;
  params.objective = objective;
  return params;
}

CompareReport judge(const Sample& sample, const Material& material) {
  return compare(*make_slices(sample.table, sample.name),
                 *make_slices(material, sample.table.header));
}

Compressed compress_sample(const Sample& sample, const CompressParams& params) {
  std::fprintf(stderr, "%s, K = %d, M = %d\n", sample.name.c_str(), params.per_pixel, params.bases);
  Compressed compressed;
  const auto source = make_slices(sample.table, sample.name);
  compressed.blend = compress_profiles(sample.map, source.get(), params, {}, &compressed.report);
  compressed.seconds = sample.fit_seconds + compressed.report.seconds;
  compressed.errors = judge(sample, compressed.blend);
  compressed.bytes = paper_bytes(compressed.blend);
  return compressed;
}

std::string format_kb(std::size_t bytes) {
  return fmt::format("{:.1f}", static_cast<double>(bytes) / 1e3);
}

}  // namespace parian::compression

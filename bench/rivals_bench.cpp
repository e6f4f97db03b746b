// Bytes against error of the rival compressions on two of our samples.
//
//   bench_rivals [SAMPLE ...]
#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <vector>

#include "base/error.h"
#include "base/memory.h"
#include "bench/common/bench_table.h"
#include "bench/reference/linsss.h"
#include "bench/reference/lsp_clusters.h"
#include "bench/reference/peers_2006.h"
#include "bench/reference/truncated_svd.h"
#include "bench/reference/tucker.h"
#include "io/hdf5/table_file.h"
#include "judge/compare.h"

namespace parian {
namespace {

using Compress = std::function<Rival(const BssrdfTable&, std::size_t)>;

std::vector<Compress> all_rivals() {
  const auto with_seed = [](auto compress) {
    return [compress](const BssrdfTable& table, std::size_t bytes) {
      return compress(table, bytes, 1);
    };
  };
  const auto peers = [](PeersForm form) {
    return [form](const BssrdfTable& table, std::size_t bytes) {
      return compress_peers_2006(table, bytes, 1, form);
    };
  };
  return {with_seed(compress_lsp_clusters), peers(PeersForm::plain),
          peers(PeersForm::symmetrised),    peers(PeersForm::half_plane),
          with_seed(compress_linsss),       with_seed(compress_truncated_svd),
          with_seed(compress_tucker)};
}

void measure(const std::string& sample) {
  const BssrdfTable table = read_table(*open_table(make_bench_table(sample)));
  const auto source = make_slices(table, sample);
  fmt::print("{}: {} x {}, {} offsets, {:.1f} MB\n", sample, table.header.width,
             table.header.height, table.header.offsets.size(),
             static_cast<double>(4 * table.reflectance.size()) / 1e6);
  fmt::print("{:<26}{:>10}{:>9}{:>10}{:>10}{:>9}{:>9}{:>9}\n", "method", "kB", "s", "relative",
             "albedo", "uniform", "disc", "line");
  for (const Compress& compress : all_rivals()) {
    std::size_t before = 0;
    for (const std::size_t budget : {30, 100, 300, 1000, 3000, 10'000}) {
      const Rival rival = compress(table, budget * 1000);
      if (!rival.slices || rival.bytes == before) continue;
      before = rival.bytes;
      const CompareReport report = compare(*source, *rival.slices);
      fmt::print("{:<26}{:>10.1f}{:>9.2f}{:>10.4f}{:>10.4f}{:>9.2f}{:>9.2f}{:>9.2f}\n", rival.name,
                 static_cast<double>(rival.bytes) / 1e3, rival.seconds, report.relative_error.mean,
                 report.albedo_error_mean, report.psnr_db.uniform, report.psnr_db.disc,
                 report.psnr_db.line);
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace parian

int main(int argc, char** argv) {
  parian::keep_freed_memory();
  try {
    for (int i = 1; i < argc; ++i) parian::measure(argv[i]);
    if (argc == 1)
      for (const char* sample : {"artificial-stone", "veined-marble-small"})
        parian::measure(sample);
  } catch (const parian::Error& error) {
    fmt::print(stderr, "bench: error: {}\n", error.what());
    return 1;
  }
}

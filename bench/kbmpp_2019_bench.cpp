// Energy against time of the 2019 paper's optimiser on one of our samples.
//
//   bench_kbmpp_2019 [SAMPLE [K [M [ROUNDS [INNER [CANDIDATES]]]]]]
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "base/memory.h"
#include "bench/common/bench_table.h"
#include "bench/reference/kbmpp_2019.h"
#include "fit/reduced_system.h"
#include "io/hdf5/table_file.h"
#include "judge/compare.h"
#include "material/material.h"

namespace parian {
namespace {

int int_argument(int argc, char** argv, int at, int standard) {
  return at < argc ? static_cast<int>(std::strtol(argv[at], nullptr, 10)) : standard;
}

void print_round(const KbmppRound& round) {
  fmt::print("{:>5}{:>10.2f}{:>14.6g}{:>9.2f}{:>9.2f}{:>9.2f}{:>7}{:>10}{:>11.1e}\n",
             round.iteration, round.seconds, round.energy, round.seconds_evaluations,
             round.seconds_solver, round.seconds_match, round.evaluations, round.replaced,
             round.largest_constraint);
  std::fflush(stdout);
}

void measure(int argc, char** argv) {
  const std::string sample = argc > 1 ? argv[1] : "artificial-stone";
  KbmppParams params;
  params.per_pixel = int_argument(argc, argv, 2, params.per_pixel);
  params.bases = int_argument(argc, argv, 3, params.bases);
  params.run_iterations = int_argument(argc, argv, 4, 0);
  params.inner = int_argument(argc, argv, 5, params.inner);
  params.random_candidates = int_argument(argc, argv, 6, params.random_candidates);
  const BssrdfTable table = read_table(*open_table(make_bench_table(sample)));
  const std::vector<double> knots = make_knots(table.header, FitParams{});
  fmt::print("{}: {} x {}, {} offsets, {} knots; K = {}, M = {}, {} iterations a round\n", sample,
             table.header.width, table.header.height, table.header.offsets.size(), knots.size(),
             params.per_pixel, params.bases, inner_iterations(params));
  fmt::print("{:>5}{:>10}{:>14}{:>9}{:>9}{:>9}{:>7}{:>10}{:>11}\n", "round", "s", "energy",
             "gradient", "L-BFGS-B", "sweeps", "evals", "replaced", "max |c|");
  const ProfileBlend blend = run_kbmpp(table, knots, params, print_round);
  const Material material = blend;
  const auto model = make_slices(material, table.header);
  const CompareReport report = compare(*make_slices(table, sample), *model);
  fmt::print("relative error {:.4f}, albedo error {:.4f}, PSNR {:.2f} dB, {} bytes\n",
             report.relative_error.mean, report.albedo_error_mean, report.psnr_db.uniform,
             paper_bytes(blend));
}

}  // namespace
}  // namespace parian

int main(int argc, char** argv) {
  parian::keep_freed_memory();
  try {
    parian::measure(argc, argv);
  } catch (const parian::Error& error) {
    fmt::print(stderr, "bench: error: {}\n", error.what());
    return 1;
  }
}

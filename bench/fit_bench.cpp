// Speed of the fit on the chessboard (222 x 222, 3 channels, radius 24 pixels, 24 segments): beside
// the fastest read of the same file with its logarithms, and beside the 2009 paper's own fit with
// its rows assembled (about 3 GB) and made on the fly.
//
//   ./run bench fit
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <vector>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "bench/common/bench_table.h"
#include "bench/common/ratios.h"
#include "bench/reference/subedit_2009.h"
#include "fit/fit.h"
#include "io/hdf5/table_file.h"
#include "math/fast_math.h"

namespace parian {
namespace {

constexpr double tolerance = 1e-5;
constexpr int segments = 24;

const std::string& table_path() {
  static const std::string path = make_bench_table("chessboard");
  return path;
}
// 24 segments over 17 pixels, as in the 2009 paper's other samples: knots finer than pixels.
const std::string& stone_path() {
  static const std::string path = make_bench_table("artificial-stone");
  return path;
}

// One channel of a table, so that a long reference need not run on all three.
class OneChannel : public SliceSource {
 public:
  explicit OneChannel(const SliceSource& source) : source_(source), header_(source.header()) {
    header_.channels = 1;
  }
  const TableHeader& header() const override { return header_; }
  std::string name() const override { return source_.name(); }
  void read_slice(int channel, int offset_index, float* slice) const override {
    source_.read_slice(channel, offset_index, slice);
  }

 private:
  const SliceSource& source_;
  TableHeader header_;
};

// The physical limit: every byte of the file read once from the page cache, in blocks that stay in
// the second-level cache, and the logarithm of every float, on all threads.
void read_and_log(benchmark::State& state) {
  constexpr std::size_t floats = std::size_t{1} << 15u;
  const int file = open(table_path().c_str(), O_RDONLY);
  struct stat info {};
  if (file < 0 || fstat(file, &info) != 0) return state.SkipWithError("cannot open the table");
  const auto bytes = static_cast<std::size_t>(info.st_size);
  const std::size_t part = 16 * floats * sizeof(float);  // what a task reads, block by block
  for ([[maybe_unused]] auto iteration : state) {
    parallel_for((bytes + part - 1) / part, [&](std::size_t task) {
      alignas(64) thread_local float block[floats], logs[floats];
      for (std::size_t at = task * part; at < std::min(bytes, (task + 1) * part);
           at += sizeof(block)) {
        const ssize_t got = pread(file, block, sizeof(block), static_cast<off_t>(at));
        if (got <= 0) return;
        log_array(block, logs, static_cast<std::size_t>(got) / sizeof(float));
        benchmark::DoNotOptimize(logs[0]);
        benchmark::ClobberMemory();
      }
    });
  }
  close(file);
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes) *
                          static_cast<std::int64_t>(state.iterations()));
}

FitParams fit_params() {
  FitParams params;
  params.segments = segments;
  params.tolerance = tolerance;
  return params;
}

void fit_unconstrained(benchmark::State& state) {
  FitParams params = fit_params();
  params.monotone = false;
  for ([[maybe_unused]] auto iteration : state) {
    const auto table = open_table(table_path());
    const FitResult result = fit_profiles(*table, params);
    state.counters["stream_s"] = result.report.seconds_stream;
    state.counters["solve_s"] = result.report.seconds_solve;
    state.counters["iterations"] = result.report.channels[0].iterations;
    state.counters["residual"] = result.report.channels[0].relative_residual;
  }
}

void fit_with_monotone_profiles(benchmark::State& state) {
  for ([[maybe_unused]] auto iteration : state) {
    const auto table = open_table(table_path());
    const FitResult result = fit_profiles(*table, fit_params());
    state.counters["monotone_s"] = result.report.seconds_monotone;
    state.counters["touched"] = static_cast<double>(result.report.channels[0].profiles_touched);
  }
}

// The same equations as the reference solves: uniform weight, lambda = 0.01.
void fit_one_channel_of(benchmark::State& state, const std::string& path) {
  FitParams params = fit_params();
  params.monotone = false;
  params.weight = PairWeight::uniform;
  for ([[maybe_unused]] auto iteration : state) {
    const auto table = open_table(path);
    const FitResult result = fit_profiles(OneChannel(*table), params);
    state.counters["iterations"] = result.report.channels[0].iterations;
    state.counters["residual"] = result.report.channels[0].relative_residual;
  }
}
// The check of the result is not timed.
void reference_one_channel_of(benchmark::State& state, const std::string& path,
                              decltype(fit_subedit_2009_assembled) fit) {
  ReferenceParams params;
  params.segments = segments;
  params.tolerance = tolerance;
  for ([[maybe_unused]] auto iteration : state) {
    const auto table = open_table(path);
    const ReferenceResult result = fit(*table, 0, params);
    state.PauseTiming();
    state.counters["iterations"] = result.iterations;
    state.counters["assembly_s"] = result.seconds_assembly;
    state.counters["matrix_MB"] = static_cast<double>(result.matrix_bytes) / 1e6;
    state.counters["residual"] = relative_residual(*table, 0, params, result);
    state.ResumeTiming();
  }
}
void fit_one_channel(benchmark::State& state) {
  fit_one_channel_of(state, table_path());
}
void fit_one_channel_stone(benchmark::State& state) {
  fit_one_channel_of(state, stone_path());
}
void reference_assembled(benchmark::State& state) {
  reference_one_channel_of(state, table_path(), fit_subedit_2009_assembled);
}
void reference_assembled_stone(benchmark::State& state) {
  reference_one_channel_of(state, stone_path(), fit_subedit_2009_assembled);
}
void reference_on_the_fly(benchmark::State& state) {
  reference_one_channel_of(state, table_path(), fit_subedit_2009_on_the_fly);
}
void reference_on_the_fly_stone(benchmark::State& state) {
  reference_one_channel_of(state, stone_path(), fit_subedit_2009_on_the_fly);
}

BENCHMARK(read_and_log)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(10);
BENCHMARK(fit_unconstrained)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(10);
BENCHMARK(fit_with_monotone_profiles)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);
BENCHMARK(fit_one_channel)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);
BENCHMARK(reference_assembled)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);
BENCHMARK(reference_on_the_fly)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);
BENCHMARK(fit_one_channel_stone)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);
BENCHMARK(reference_assembled_stone)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);
BENCHMARK(reference_on_the_fly_stone)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);

}  // namespace
}  // namespace parian

int main(int argc, char** argv) {
  parian::keep_freed_memory();
  try {
    return parian::run_benchmarks(
        argc, argv,
        {{"fit / read and logarithms (3 channels)", "fit_unconstrained", "read_and_log", "<= 4"},
         {"fit with monotone profiles / without", "fit_with_monotone_profiles", "fit_unconstrained",
          ""},
         {"2009, rows assembled as a sparse matrix / fit", "reference_assembled", "fit_one_channel",
          ">= 200"},
         {"2009, rows made on the fly, vectorised / fit", "reference_on_the_fly", "fit_one_channel",
          ""},
         {"assembled / fit, 24 segments over 17 pixels", "reference_assembled_stone",
          "fit_one_channel_stone", ""},
         {"on the fly / fit, 24 segments over 17 pixels", "reference_on_the_fly_stone",
          "fit_one_channel_stone", ""}});
  } catch (const parian::Error& error) {
    fmt::print(stderr, "bench: error: {}\n", error.what());
    return 1;
  }
}

#include "bench/common/ratios.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace parian {
namespace {

class MinimumReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.error_occurred || run.run_type != Run::RT_Iteration) continue;
      const double seconds = run.real_accumulated_time / static_cast<double>(run.iterations);
      const auto [entry, is_new] = seconds_.emplace(run.run_name.function_name, seconds);
      if (!is_new) entry->second = std::min(entry->second, seconds);
    }
    ConsoleReporter::ReportRuns(runs);
  }

  std::map<std::string, double> seconds_;
};

}  // namespace

int run_benchmarks(int argc, char** argv, const std::vector<Ratio>& ratios) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  MinimumReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  fmt::print("\n{:<52} {:>10}  {}\n", "ratio of minima", "measured", "target");
  for (const Ratio& ratio : ratios) {
    const auto over = reporter.seconds_.find(ratio.over),
               under = reporter.seconds_.find(ratio.under);
    if (over == reporter.seconds_.end() || under == reporter.seconds_.end()) continue;
    fmt::print("{:<52} {:>10.2f}  {}\n", ratio.text, over->second / under->second, ratio.target);
  }
  return 0;
}

}  // namespace parian

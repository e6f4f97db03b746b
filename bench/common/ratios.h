// Google Benchmark's table, followed by ratios between its rows beside their targets.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace parian {

struct Ratio {
  std::string text;         // "fit / reading and logarithms"
  std::string over, under;  // names of the two benchmarks
  std::string target;       // "<= 4", may be empty
};

// Runs what --benchmark_filter selects; prints the ratios both of whose benchmarks ran. Repeated
// runs count with their minimum.
int run_benchmarks(int argc, char** argv, const std::vector<Ratio>& ratios);

}  // namespace parian

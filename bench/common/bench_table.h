// Tables that benchmarks work on: simulated once from a sample description and kept on disk.
#pragma once

#include <string>

namespace parian {

// Path of the table of data/samples/<sample>.json in out/bench/, made there if it is not.
std::string make_bench_table(const std::string& sample);

}  // namespace parian

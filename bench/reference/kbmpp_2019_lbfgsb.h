// L-BFGS-B 3.0 (Zhu, Byrd, Lu, Nocedal) through its reverse communication.
#pragma once

#include <functional>
#include <vector>

namespace parian::kbmpp {

struct Box {
  std::vector<double> lower, upper;
  std::vector<int> kind;  // 0: unbounded, 2: both bounds
};

// Value and gradient at x.
using Objective = std::function<double(const double* x, double* gradient)>;

// At most `max_iterations` iterations from x, in place, without tests of convergence but for a line
// search that finds nothing. The last call of `objective` is at the result. Returns iterations.
int minimise_lbfgsb(std::vector<double>& x, const Box& box, int memory, int max_iterations,
                    const Objective& objective);

}  // namespace parian::kbmpp

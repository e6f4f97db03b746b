#include "bench/reference/kbmpp_2019_lbfgsb.h"

#include <array>
#include <cstddef>
#include <string_view>

#include "base/check.h"

// The library has no header: Fortran calling convention, lengths of strings last.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" void setulb_(const int* n, const int* m, double* x, const double* lower,
                        const double* upper, const int* kind, double* f, double* gradient,
                        const double* factr, const double* pgtol, double* work, int* int_work,
                        char* task, const int* iprint, char* csave, int* lsave, int* isave,
                        double* dsave, std::size_t task_length, std::size_t csave_length);

namespace parian::kbmpp {
namespace {

struct LbfgsbState {
  std::array<char, 60> task{}, csave{};
  std::array<int, 4> lsave{};
  std::array<int, 44> isave{};
  std::array<double, 29> dsave{};
  std::vector<double> work;
  std::vector<int> int_work;

  bool is(std::string_view name) const {
    return std::string_view(task.data(), task.size()).substr(0, name.size()) == name;
  }
};

LbfgsbState make_lbfgsb_state(std::size_t n, std::size_t m) {
  LbfgsbState s;
  s.task.fill(' ');
  s.csave.fill(' ');
  for (std::size_t i = 0; i < 5; ++i) s.task[i] = "START"[i];
  s.work.assign(2 * m * n + 5 * n + 11 * m * m + 8 * m, 0.0);
  s.int_work.assign(3 * n, 0);
  return s;
}

}  // namespace

int minimise_lbfgsb(std::vector<double>& x, const Box& box, int memory, int max_iterations,
                    const Objective& objective) {
  PARIAN_CHECK_EQ(box.lower.size(), x.size());
  const int n = static_cast<int>(x.size()), silent = -1;
  const double none = 0;
  LbfgsbState s = make_lbfgsb_state(x.size(), static_cast<std::size_t>(memory));
  std::vector<double> gradient(x.size());
  double f = 0;
  for (int iterations = 0;;) {
    setulb_(&n, &memory, x.data(), box.lower.data(), box.upper.data(), box.kind.data(), &f,
            gradient.data(), &none, &none, s.work.data(), s.int_work.data(), s.task.data(), &silent,
            s.csave.data(), s.lsave.data(), s.isave.data(), s.dsave.data(), s.task.size(),
            s.csave.size());
    if (s.is("FG")) {
      f = objective(x.data(), gradient.data());
    } else if (s.is("NEW_X")) {
      if (++iterations >= max_iterations) return iterations;
    } else {
      PARIAN_CHECK(!s.is("ERROR"));
      objective(x.data(), gradient.data());  // x was put back to the best point
      return iterations;
    }
  }
}

}  // namespace parian::kbmpp

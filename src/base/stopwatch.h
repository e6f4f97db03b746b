// Wall-clock time between laps.
#pragma once

#include <chrono>

namespace parian {

class Stopwatch {
 public:
  // Since the last lap, or since it was made.
  double seconds() const { return std::chrono::duration<double>(Clock::now() - last_).count(); }
  // The same, and begins the next lap.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace parian

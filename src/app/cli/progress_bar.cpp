#include "app/cli/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace parian {

ProgressBar::ProgressBar(bool wanted)
    : is_shown_(wanted && isatty(STDERR_FILENO)), next_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
  if (is_drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::show(std::string_view stage, double done) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  if (!is_shown_ || now < next_) return;
  next_ = now + 50ms;
  is_drawn_ = true;
  constexpr int width = 30;
  const double part = std::isfinite(done) ? std::clamp(done, 0.0, 1.0) : 0.0;
  const int full = static_cast<int>(part * width);
  fmt::print(stderr, "\r\033[K{} [{:=<{}}{:{}}] {:3.0f} %", stage, "", full, "", width - full,
             100 * part);
  std::fflush(stderr);
}

}  // namespace parian

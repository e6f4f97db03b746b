// One line of progress on standard error, where that is a terminal.
#pragma once

#include <chrono>
#include <string_view>

namespace parian {

class ProgressBar {
 public:
  // Draws nothing when not wanted or when standard error is not a terminal.
  explicit ProgressBar(bool wanted);
  // Clears the line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::string_view stage, double done);

 private:
  bool is_shown_;
  bool is_drawn_ = false;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace parian

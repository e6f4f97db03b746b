// Long work beside the window: each job on a thread of its own, with progress and cancel.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"

namespace parian {

struct JobView {
  std::string name, stage;
  double done = 0;
};

// All functions are called from one thread (the window's).
class Jobs {
 public:
  Jobs();
  ~Jobs();  // cancels all and waits
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  // `work` runs on a thread of its own and returns what to do with its result on the window's. A
  // job of the same name that runs is cancelled, and its result dropped.
  using Finish = std::function<void()>;
  using Work = std::function<Finish(const Progress&)>;
  void start(std::string name, Work work);
  void cancel(const std::string& name);
  bool is_running(const std::string& name) const;
  std::vector<JobView> views() const;

  // Finishes what is done; returns the messages of what failed.
  std::vector<std::string> poll();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

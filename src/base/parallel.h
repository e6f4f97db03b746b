// Parallel loops whose results do not depend on the number of threads: work is cut into blocks
// that depend on the problem alone, and partial results are combined in block order.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace parian {

// Calls body(i) for i in [0, count), each exactly once, from several threads, in no fixed order.
// An exception thrown by a body is rethrown here. Bodies must write to disjoint places.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

// Calls body(begin, end) on consecutive ranges of `block` items (the last may be shorter).
void parallel_for_blocks(std::size_t count, std::size_t block,
                         const std::function<void(std::size_t, std::size_t)>& body);

// Sum of body(begin, end) over fixed blocks, added in block order: the same bits for any number
// of threads.
double parallel_sum(std::size_t count, std::size_t block,
                    const std::function<double(std::size_t, std::size_t)>& body);

// Limits the threads of all parallel loops while it lives. 0 means one per processor.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Threads that parallel loops may use now.
int thread_count();

}  // namespace parian

#include "transport/live_transport.h"

#include <utility>

#include "base/check.h"

namespace parian {

LiveTransport::LiveTransport(const Scene& scene, const RayTracer& tracer,
                             const PrecomputeParams& params)
    : precompute_(scene, tracer, params), thread_([this] { work(); }) {}

LiveTransport::~LiveTransport() {
  {
    const std::lock_guard lock(mutex_);
    is_leaving_ = true;
    give_up_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void LiveTransport::request(std::size_t index, const Light& light) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.insert_or_assign(index, light);
    done_.erase(index);
    if (working_on_ == index) give_up_ = true;
  }
  wake_.notify_one();
}

bool LiveTransport::poll(HomogeneousTransport& transport) {
  std::map<std::size_t, LightTransport> done;
  {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    done.swap(done_);
  }
  for (auto& [index, light] : done) {
    PARIAN_CHECK(index < transport.lights.size());
    transport.lights[index] = std::move(light);
  }
  return !done.empty();
}

bool LiveTransport::is_busy() const {
  const std::lock_guard lock(mutex_);
  return working_on_.has_value() || !waiting_.empty() || !done_.empty();
}

void LiveTransport::work() {
  const Progress progress{.report = {}, .is_cancelled = [this] { return give_up_.load(); }};
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return is_leaving_ || !waiting_.empty(); });
    if (is_leaving_) return;
    const auto [index, light] = *waiting_.begin();
    waiting_.erase(waiting_.begin());
    working_on_ = index;
    give_up_ = false;
    lock.unlock();
    std::optional<LightTransport> made;
    std::exception_ptr failure;
    try {
      made = precompute_.compute(index, light, progress);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    working_on_.reset();
    // A newer request may have come in after the last look at give_up_.
    if (give_up_) continue;
    if (failure) failure_ = failure;
    if (made) done_.insert_or_assign(index, std::move(*made));
  }
}

}  // namespace parian

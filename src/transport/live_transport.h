// Transport of which a light changes while the rest is in use: an environment that is turned, a
// light that is moved. The new transport is made on a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "transport/precompute.h"

namespace parian {

// Scene and tracer must outlive it. All members are called from one thread.
class LiveTransport {
 public:
  // Throws as Precompute.
  LiveTransport(const Scene& scene, const RayTracer& tracer, const PrecomputeParams& params);
  // Gives up what is under way.
  ~LiveTransport();
  LiveTransport(const LiveTransport&) = delete;
  LiveTransport& operator=(const LiveTransport&) = delete;

  // Light `index` is to become `light`. A later request for it takes the place of one not yet done.
  void request(std::size_t index, const Light& light);
  // Puts a finished light into `transport` (with the lights of the scene). True: something changed.
  // Rethrows what the work has thrown.
  bool poll(HomogeneousTransport& transport);
  bool is_busy() const;

 private:
  void work();

  Precompute precompute_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::size_t, Light> waiting_;  // by index; guarded, as all below
  std::map<std::size_t, LightTransport> done_;
  std::optional<std::size_t> working_on_;
  std::exception_ptr failure_;
  bool is_leaving_ = false;
  std::atomic<bool> give_up_{false};
  std::thread thread_;
};

}  // namespace parian

// The still picture while nothing moves: the CPU renderer's, better from pass to pass up to the sum
// over every sample (render/refinement.h), over the splatted one where it has not come yet.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>

#include "app/studio/pictures.h"
#include "base/progress.h"
#include "render/refinement.h"

namespace parian {

struct RefineRequest {
  std::shared_ptr<const Picture> under;  // what it refines, of the same size; gives the id
  std::shared_ptr<const Stage> stage;
  std::shared_ptr<const Material> material;
  StageLayers layers;
  Lighting lighting;
  Camera camera;
  double exposure = 0;  // stops
};

class Refiner {
 public:
  explicit Refiner(const RefinementParams& params = {}) : params_(params) {}

  // Until the last pass is done; throws on cancellation and as Refinement does. One run at a time:
  // another thread's waits for the end of the one before. What did not change since the last run on
  // the same stage is kept.
  void run(const RefineRequest& request, const Progress& progress);

  // Null before the first; from any thread.
  std::shared_ptr<const Picture> latest() const;

 private:
  void prepare(const RefineRequest& request);
  void publish(const RefineRequest& request);

  RefinementParams params_;
  std::mutex run_mutex_;
  std::unique_ptr<Refinement> refinement_;
  RefineRequest last_;

  mutable std::mutex latest_mutex_;
  std::shared_ptr<const Picture> latest_;
};

struct Studio;
// Starts the job when the fine picture is there and nothing has moved for a while; once a frame.
void update_refiner(Studio& studio);
// Of the picture that was asked for last, where the choice says so: its first pass is done.
bool is_refined(const Studio& studio);
void stop_refining(Studio& studio);

}  // namespace parian

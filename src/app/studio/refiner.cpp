#include "app/studio/refiner.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/studio/studio.h"
#include "base/stopwatch.h"

namespace parian {
namespace {

constexpr double rest_s = 1.0;     // without changes, until it starts
constexpr double publish_s = 0.3;  // between pictures

bool may_refine(const Studio& studio) {
  return studio.still == Still::exact && studio.mode == ViewMode::shaded &&
         shown_mask(studio) == nullptr && shown_layer_mask(studio) == nullptr;
}

}  // namespace

void Refiner::prepare(const RefineRequest& request) {
  const bool is_new = refinement_ == nullptr || last_.stage != request.stage;
  if (is_new) {
    refinement_.reset();
    refinement_ =
        std::make_unique<Refinement>(make_scene(*request.stage, *request.material, request.layers,
                                                request.lighting, request.camera),
                                     params_);
  } else {
    if (last_.layers != request.layers)
      refinement_->set_material(*request.material, copy_layers(request.layers));
    else if (last_.material != request.material)
      refinement_->set_material(*request.material);
    if (!(last_.lighting == request.lighting))
      refinement_->set_lights(make_lights(request.lighting));
    if (!(last_.camera == request.camera)) refinement_->set_camera(request.camera);
  }
  if (last_.exposure != request.exposure || is_new) refinement_->set_exposure(request.exposure);
  last_ = request;
}

void Refiner::publish(const RefineRequest& request) {
  const Image& image = refinement_->image();
  const RefinementReport& report = refinement_->report();
  auto picture = std::make_shared<Picture>();
  picture->id = request.under->id;
  picture->width = image.width;
  picture->height = image.height;
  picture->rgba = encode_picture(image);
  const std::vector<float>& half_width = refinement_->half_width();
  for (std::size_t i = 0; i < half_width.size(); ++i)
    if (half_width[i] == Refinement::nothing_yet)
      std::copy_n(&request.under->rgba[4 * i], 4, &picture->rgba[4 * i]);
  picture->seconds = report.seconds;
  picture->is_fine = true;
  picture->passes_done = report.pass + (report.done == 1 ? 1 : 0);
  picture->half_width = report.max_half_width;
  const std::lock_guard lock(latest_mutex_);
  latest_ = std::move(picture);
}

void Refiner::run(const RefineRequest& request, const Progress& progress) {
  const std::lock_guard lock(run_mutex_);
  try {
    prepare(request);
  } catch (...) {
    refinement_.reset();  // it may hold a part of the request
    throw;
  }
  const RefinementReport& report = refinement_->report();
  if (report.done > 0) publish(request);  // nothing moved, or only the exposure
  Stopwatch watch;
  double since_s = 0;
  while (!refinement_->is_done()) {
    const int passes = std::max(1, report.passes);
    advance_progress(progress, fmt::format("pass {} of {}", report.pass + 1, passes),
                     (report.pass + report.done) / passes);
    refinement_->advance({{}, progress.is_cancelled});
    since_s += watch.lap();
    if (report.done == 1 || (report.done > 0 && since_s > publish_s)) {
      publish(request);
      since_s = 0;
    }
  }
}

std::shared_ptr<const Picture> Refiner::latest() const {
  const std::lock_guard lock(latest_mutex_);
  return latest_;
}

void update_refiner(Studio& studio) {
  if (auto latest = studio.refiner.latest(); latest != nullptr && latest->id == studio.request_id)
    studio.refined = std::move(latest);
  const bool shows_fine = studio.picture != nullptr && studio.picture->id == studio.request_id &&
                          studio.request_is_fine && !studio.is_stale;
  if (!may_refine(studio) || !shows_fine || studio.refining_id == studio.request_id ||
      studio.now_s - studio.last_change_s < rest_s || studio.jobs.is_running("transport"))
    return;
  studio.refining_id = studio.request_id;
  RefineRequest request{.under = studio.picture,
                        .stage = studio.stage,
                        .material = studio.material,
                        .layers = shown_layers(studio),
                        .lighting = studio.lighting,
                        .camera = make_view_camera(studio, 1),
                        .exposure = studio.exposure};
  studio.jobs.start("refine",
                    [&refiner = studio.refiner,
                     request = std::move(request)](const Progress& progress) -> Jobs::Finish {
                      refiner.run(request, progress);
                      return [] {};
                    });
}

bool is_refined(const Studio& studio) {
  if (!may_refine(studio)) return true;
  return studio.refined != nullptr && studio.refined->id == studio.request_id &&
         studio.refined->passes_done > 0;
}

void stop_refining(Studio& studio) {
  studio.jobs.cancel("refine");
  studio.refining_id = 0;
}

}  // namespace parian

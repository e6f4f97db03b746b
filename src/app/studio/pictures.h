// Pictures of the stage on a thread with a graphics context of its own: the newest request is
// drawn, the window shows the newest picture and never waits. What did not change between requests
// is kept.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/studio/stage.h"
#include "app/studio/transport_job.h"
#include "edit/mask.h"
#include "gl/live_renderer.h"
#include "gl/splat_renderer.h"
#include "material/material.h"

namespace parian {

enum class ViewMode { shaded, albedo, range, irradiance, difference, wireframe };
const std::vector<std::string>& view_mode_names();

struct PictureRequest {
  std::shared_ptr<const Stage> stage;
  std::shared_ptr<const Material> material;
  StageLayers layers;                               // over it
  std::shared_ptr<const Material> before;           // for ViewMode::difference; may be null
  std::shared_ptr<const Mask> mask;                 // shown in red; may be null
  std::shared_ptr<const SurfaceLayer> layer_mask;   // its mask, likewise
  std::shared_ptr<const ReadyTransport> transport;  // of this stage and lighting; may be null
  std::vector<Rgb> light_scales;                    // of its lights
  Lighting lighting;                                // those that are on
  Camera camera;                                    // with the size to be drawn
  ViewMode mode = ViewMode::shaded;
  double exposure = 0;  // stops
  bool fine = true;     // more samples; given up for a newer request
};

struct Picture {
  std::uint64_t id = 0;  // of the request
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // sRGB-encoded, row 0 on top
  double seconds = 0;
  bool is_fine = false;
  SplatReport report;    // of a splatted picture
  bool is_live = false;  // from precomputed transport
  LiveReport live;
  int passes_done = 0;     // of a refined picture (refiner.h)
  double half_width = -1;  // its largest certified one; -1: none yet
};

// Linear radiance, encoded for the screen.
std::vector<std::uint8_t> encode_picture(const Image& image);

class PictureThread {
 public:
  PictureThread();
  ~PictureThread();
  PictureThread(const PictureThread&) = delete;
  PictureThread& operator=(const PictureThread&) = delete;

  // Called from the thread whenever a picture is there; set before the first request.
  void set_wake(std::function<void()> wake);
  std::uint64_t request(PictureRequest request);
  std::shared_ptr<const Picture> latest() const;  // null before the first
  bool is_busy() const;
  std::uint64_t last_failed() const;  // id of a request that gave an error; 0: none
  std::optional<std::string> take_error();
  // Until the newest request is drawn. For scripted runs and tests.
  void wait();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

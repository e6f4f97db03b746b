#include "app/studio/pictures.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "app/studio/property_picture.h"
#include "base/error.h"
#include "base/parallel.h"
#include "image/color.h"

namespace parian {
namespace {

constexpr double difference_gain = 4;  // of the difference mode
constexpr int fine_samples = 16000;    // where light enters, at rest

// Splatting of one stage; remade for another one.
struct Splatter {
  std::shared_ptr<const Stage> stage;
  std::shared_ptr<const Material> material;
  Lighting lighting;
  Camera camera;
  std::unique_ptr<SplatRenderer> renderer;
};

Image splat(Splatter& splatter, const GlLimits& limits, const PictureRequest& request,
            const std::shared_ptr<const Material>& material, const Progress& progress) {
  if (splatter.renderer == nullptr || splatter.stage != request.stage) {
    SplatParams params = make_interactive_params();
    if (request.fine) {
      params.samples = fine_samples;
    } else {  // less than half of the splats' area
      params.octave = 3.5;
      params.texel = 1;
    }
    Scene scene = request.stage->scene;
    scene.material = *material;
    scene.layers.clear();
    scene.lights = make_lights(request.lighting);
    scene.camera = request.camera;
    scene.exposure = 0;
    splatter.renderer.reset();
    splatter.renderer = std::make_unique<SplatRenderer>(limits, scene, params);
    splatter.stage = request.stage;
  } else {
    if (splatter.material != material) splatter.renderer->set_material(*material);
    if (!(splatter.lighting == request.lighting))
      splatter.renderer->set_lights(make_lights(request.lighting));
    if (!(splatter.camera == request.camera)) splatter.renderer->set_camera(request.camera);
  }
  splatter.camera = request.camera;
  splatter.material = material;
  splatter.lighting = request.lighting;
  splatter.renderer->draw(true, progress);
  return splatter.renderer->read();
}

Image difference_of(Image after, const Image& before) {
  for (std::size_t i = 0; i < after.values.size(); ++i)
    after.values[i] =
        static_cast<float>(difference_gain) * std::abs(after.values[i] - before.values[i]);
  return after;
}

Image draw(Splatter& splatter, const GlLimits& limits, const PictureRequest& request,
           const Progress& progress) {
  Image image;
  switch (request.mode) {
    case ViewMode::difference:
      if (request.before != nullptr) {
        const Image before = splat(splatter, limits, request, request.before, progress);
        image = difference_of(splat(splatter, limits, request, request.material, progress), before);
        break;
      }
      [[fallthrough]];
    case ViewMode::shaded:
    case ViewMode::wireframe:
      image = splat(splatter, limits, request, request.material, progress);
      break;
    case ViewMode::albedo:
    case ViewMode::range:
      image = draw_property(*request.stage, *request.material, request.camera,
                            request.mode == ViewMode::albedo);
      break;
    case ViewMode::irradiance:
      image = draw_irradiance(*request.stage, *request.material, make_lights(request.lighting),
                              request.camera);
      break;
  }
  if (request.mode == ViewMode::wireframe) draw_wireframe(*request.stage, request.camera, image);
  if (request.mask != nullptr && !request.mask->weight.empty())
    draw_mask(*request.stage, *request.material, *request.mask, request.camera, image);
  return image;
}

}  // namespace

const std::vector<std::string>& view_mode_names() {
  static const std::vector<std::string> names{"shaded",     "albedo",     "range",
                                              "irradiance", "difference", "wireframe"};
  return names;
}

std::vector<std::uint8_t> encode_picture(const Image& image, double exposure) {
  // The curve over the square root, which spreads its steep start.
  static const std::vector<std::uint8_t> codes = [] {
    std::vector<std::uint8_t> table(4097);
    for (std::size_t i = 0; i < table.size(); ++i) {
      const float root = static_cast<float>(i) / 4096.0f;
      table[i] = static_cast<std::uint8_t>(std::lround(255 * encode_srgb(root * root)));
    }
    return table;
  }();
  const auto scale = static_cast<float>(std::exp2(exposure));
  const std::size_t pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<std::uint8_t> rgba(4 * pixels);
  parallel_for_blocks(pixels, 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = scale * image.values[i * channels + std::min(c, channels - 1)];
        // Not a number becomes black.
        const float root = value > 0 ? std::sqrt(std::min(value, 1.0f)) : 0.0f;
        rgba[4 * i + c] = codes[static_cast<std::size_t>(root * 4096.0f + 0.5f)];
      }
      rgba[4 * i + 3] = 255;
    }
  });
  return rgba;
}

struct PictureThread::Impl {
  mutable std::mutex mutex;
  std::condition_variable wake, idle;
  std::optional<PictureRequest> next;
  std::uint64_t requested = 0;
  bool stops = false, works = false;
  std::shared_ptr<const Picture> latest;
  std::optional<std::string> error;
  std::thread thread;

  void run();
};

void PictureThread::Impl::run() {
  std::unique_ptr<OffscreenContext> context;
  Splatter coarse, fine;
  std::unique_lock lock(mutex);
  while (true) {
    wake.wait(lock, [this] { return stops || next.has_value(); });
    if (stops) break;
    const PictureRequest request = std::move(*next);
    const std::uint64_t id = requested;
    next.reset();
    works = true;
    lock.unlock();
    auto picture = std::make_shared<Picture>();
    std::optional<std::string> message;
    try {
      const auto start = std::chrono::steady_clock::now();
      if (context == nullptr) context = std::make_unique<OffscreenContext>();
      Splatter& splatter = request.fine ? fine : coarse;
      const Progress progress{.is_cancelled = [this, &request] {
        const std::scoped_lock guard(mutex);
        return stops || (request.fine && next.has_value());
      }};
      const Image image = draw(splatter, context->limits(), request, progress);
      picture->rgba = encode_picture(image, request.exposure);
      picture->width = image.width;
      picture->height = image.height;
      if (splatter.renderer != nullptr) picture->report = splatter.renderer->report();
      picture->seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    } catch (const Error& caught) {
      if (caught.kind != ErrorKind::cancelled) message = caught.what();
      picture.reset();
    } catch (const std::exception& caught) {
      message = caught.what();
      picture.reset();
    }
    if (message) {
      coarse = {};
      fine = {};
    }
    lock.lock();
    works = false;
    if (message) error = message;
    if (picture != nullptr) {
      picture->id = id;
      latest = std::move(picture);
    }
    if (!next) idle.notify_all();
  }
  lock.unlock();
  coarse.renderer.reset();  // before their context
  fine.renderer.reset();
}

PictureThread::PictureThread() : impl_(std::make_unique<Impl>()) {
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
}

PictureThread::~PictureThread() {
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->stops = true;
  }
  impl_->wake.notify_all();
  impl_->thread.join();
}

std::uint64_t PictureThread::request(PictureRequest request) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->next = std::move(request);
  impl_->wake.notify_all();
  return ++impl_->requested;
}

std::shared_ptr<const Picture> PictureThread::latest() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->latest;
}

bool PictureThread::is_busy() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->works || impl_->next.has_value();
}

std::optional<std::string> PictureThread::take_error() {
  const std::scoped_lock lock(impl_->mutex);
  return std::exchange(impl_->error, std::nullopt);
}

void PictureThread::wait() {
  std::unique_lock lock(impl_->mutex);
  impl_->idle.wait(lock, [this] { return !impl_->works && !impl_->next; });
}

}  // namespace parian

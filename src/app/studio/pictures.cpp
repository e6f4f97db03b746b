#include "app/studio/pictures.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "app/studio/picture_drawer.h"
#include "base/error.h"
#include "base/parallel.h"
#include "image/color.h"

namespace parian {

const std::vector<std::string>& view_mode_names() {
  static const std::vector<std::string> names{"shaded",     "albedo",     "range",
                                              "irradiance", "difference", "wireframe"};
  return names;
}

std::vector<std::uint8_t> encode_picture(const Image& image) {
  // The curve over the square root, which spreads its steep start.
  static const std::vector<std::uint8_t> codes = [] {
    std::vector<std::uint8_t> table(4097);
    for (std::size_t i = 0; i < table.size(); ++i) {
      const float root = static_cast<float>(i) / 4096.0f;
      table[i] = static_cast<std::uint8_t>(std::lround(255 * encode_srgb(root * root)));
    }
    return table;
  }();
  const std::size_t pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<std::uint8_t> rgba(4 * pixels);
  parallel_for_blocks(pixels, 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = image.values[i * channels + std::min(c, channels - 1)];
        // Not a number becomes black.
        const float root = value > 0 ? std::sqrt(std::min(value, 1.0f)) : 0.0f;
        rgba[4 * i + c] = codes[static_cast<std::size_t>(std::lrint(root * 4096.0f))];
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
  std::uint64_t requested = 0, failed = 0;
  bool stops = false, works = false;
  std::shared_ptr<const Picture> latest;
  std::optional<std::string> error;
  std::function<void()> on_ready;
  std::thread thread;

  void run();
  std::shared_ptr<Picture> make_picture(PictureDrawer& drawer, const PictureRequest& request,
                                        std::optional<std::string>& message);
};

// Null, with a message, where it could not be drawn; without one where it was given up.
std::shared_ptr<Picture> PictureThread::Impl::make_picture(PictureDrawer& drawer,
                                                           const PictureRequest& request,
                                                           std::optional<std::string>& message) {
  auto picture = std::make_shared<Picture>();
  try {
    const auto start = std::chrono::steady_clock::now();
    const Progress progress{.is_cancelled = [this, &request] {
      const std::scoped_lock guard(mutex);
      return stops || (request.fine && next.has_value());
    }};
    const Image image = drawer.draw(request, progress, *picture);
    picture->rgba = encode_picture(image);
    picture->is_fine = request.fine;
    picture->width = image.width;
    picture->height = image.height;
    picture->seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return picture;
  } catch (const Error& caught) {
    if (caught.kind != ErrorKind::cancelled) message = caught.what();
  } catch (const std::bad_alloc&) {
    message = "there is not enough memory for the picture: make the window smaller";
  } catch (const std::exception& caught) {
    message = caught.what();
  }
  if (message) drawer.reset();
  return nullptr;
}

void PictureThread::Impl::run() {
  PictureDrawer drawer;
  std::unique_lock lock(mutex);
  while (true) {
    wake.wait(lock, [this] { return stops || next.has_value(); });
    if (stops) break;
    const PictureRequest request = std::move(*next);
    const std::uint64_t id = requested;
    next.reset();
    works = true;
    lock.unlock();
    std::optional<std::string> message;
    std::shared_ptr<Picture> picture = make_picture(drawer, request, message);
    if (std::string warning = drawer.take_warning(); !warning.empty()) message = warning;
    lock.lock();
    works = false;
    if (message) error = message;
    if (picture != nullptr) {
      picture->id = id;
      latest = std::move(picture);
    } else if (message) {
      failed = id;
    }
    if (!next) idle.notify_all();
    if (on_ready) on_ready();
  }
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

void PictureThread::set_wake(std::function<void()> wake) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->on_ready = std::move(wake);
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

std::uint64_t PictureThread::last_failed() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->failed;
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

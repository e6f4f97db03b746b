#include "io/capture/capture_folder.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/error.h"
#include "io/image/image_file.h"
#include "io/json/json.h"

namespace parian {
namespace {

namespace fs = std::filesystem;

std::string path_of(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}

std::string describe_size(int width, int height, int channels) {
  return fmt::format("{} x {} pixels of {} channel{}", width, height, channels,
                     channels == 1 ? "" : "s");
}

// Whole groups of missing frames get a message of their own.
void check_frames(const std::string& folder, const CaptureMeta& meta) {
  const std::vector<FrameName> frames = list_frames(meta);
  const auto is_there = [&](const FrameName& frame) {
    return fs::exists(path_of(folder, frame_file(meta, frame)));
  };
  bool any_dark = false;
  std::vector<bool> any_of_exposure(meta.exposures_s.size());
  const FrameName* missing = nullptr;
  for (const FrameName& frame : frames) {
    if (!is_there(frame)) {
      if (missing == nullptr) missing = &frame;
      continue;
    }
    if (frame.role == FrameRole::dark) any_dark = true;
    any_of_exposure[static_cast<std::size_t>(frame.exposure)] = true;
  }
  if (missing == nullptr) return;
  if (!any_dark)
    throw Error({.file = folder,
                 .expected = fmt::format("dark frames, {} and so on",
                                         frame_file(meta, {.role = FrameRole::dark})),
                 .found = "none"});
  for (std::size_t e = 0; e < any_of_exposure.size(); ++e)
    if (!any_of_exposure[e])
      throw Error({.file = folder,
                   .expected = fmt::format("frames of exposure {}, {} s", e, meta.exposures_s[e]),
                   .found = "none"});
  throw Error(
      {.file = path_of(folder, frame_file(meta, *missing)),
       .expected = fmt::format("a frame of {} s",
                               meta.exposures_s[static_cast<std::size_t>(missing->exposure)]),
       .found = "no such file"});
}

}  // namespace

CaptureMeta open_capture(const std::string& folder) {
  CaptureMeta meta = read_capture_meta(load_document(path_of(folder, "meta.json")));
  check_frames(folder, meta);
  return meta;
}

FrameLoader make_frame_loader(const std::string& folder, const CaptureMeta& meta) {
  return [folder, meta](const FrameName& frame) {
    const std::string path = path_of(folder, frame_file(meta, frame));
    Image image = load_raw_image(path);
    if (image.width != meta.camera_width || image.height != meta.camera_height ||
        image.channels != meta.channels)
      throw Error({path, "size",
                   describe_size(meta.camera_width, meta.camera_height, meta.channels),
                   describe_size(image.width, image.height, image.channels)});
    return image;
  };
}

void save_capture_meta(const std::string& folder, const CaptureMeta& meta) {
  save_document(path_of(folder, "meta.json"), write_capture_meta(meta));
}

void save_frame(const std::string& folder, const CaptureMeta& meta, const FrameName& frame,
                const Image& codes) {
  const std::string path = path_of(folder, frame_file(meta, frame));
  if (meta.format == FrameFormat::exr) {
    save_image(path, codes);
  } else {
    save_raw_png(path, codes, meta.format == FrameFormat::png8 ? 8 : 16);
  }
}

}  // namespace parian

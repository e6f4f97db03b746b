// What the editor's tests share.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <thread>

#include "app/studio/studio_files.h"
#include "app/studio/tools.h"
#include "render/render.h"

namespace parian {

inline ProfileMap make_map() {
  ProfileMap map = make_profile_map(12, 10, 3, 0.5, {0, 1, 2, 3});
  for (std::size_t k = 0; k < 4; ++k)
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < map.pixels(); ++i)
        knot_plane(map, c, static_cast<int>(k))[i] =
            -1.5f * static_cast<float>(k) - (i % 12 < 6 ? 1.0f : 2.0f);
  return map;
}

inline Document make_adjust(double range_scale) {
  Document layer = make_default_layer("adjust", "range");
  set(layer, "range_scale", range_scale);
  return layer;
}

// Of this process: tests run beside each other.
struct StateFolder {
  std::string path =
      (std::filesystem::temp_directory_path() / ("parian-studio-test-" + std::to_string(getpid())))
          .string();
  StateFolder() { std::filesystem::remove_all(path); }
  ~StateFolder() { std::filesystem::remove_all(path); }
};

// As the window does, until all is done.
inline void run(Studio& studio) {
  for (int i = 0; i < 12000; ++i) {
    update(studio, 0.01 * i + studio.last_change_s);
    if (is_settled(studio)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  FAIL() << "the studio does not come to rest";
}

// Without exact pictures, and small ones.
inline void make_small(Studio& studio) {
  studio.still = Still::fine;
  studio.view_width = 64;
  studio.view_height = 48;
}

// As the program does, with its state in `folder`.
inline void start_small(Studio& studio, const StateFolder& folder) {
  start_studio(studio, {folder.path, PARIAN_SOURCE_DIR "/data"});
  make_small(studio);
}
// The same, with pictures that stay drafts.
inline void start_draft(Studio& studio, const StateFolder& folder) {
  start_small(studio, folder);
  studio.still = Still::draft;
}

// Of pictures that the CPU makes of both.
inline Image render_small(const Scene& scene) {
  RenderParams params;
  params.samples = 3000;
  params.rays = 8;
  params.antialias = 1;
  params.method = GatherMethod::brute;
  return render(scene, params).image;
}
inline double largest_difference(const Scene& a, const Scene& b) {
  const Image one = render_small(a), other = render_small(b);
  EXPECT_EQ(one.values.size(), other.values.size());
  double most = 0;
  for (std::size_t i = 0; i < one.values.size(); ++i)
    most = std::max(most, static_cast<double>(std::abs(one.values[i] - other.values[i])));
  return most;
}

}  // namespace parian

// Draws what a picture request asks for: by splatting, from precomputed transport, or, where the
// graphics device cannot, by the CPU renderer. What did not change between requests is kept.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/studio/pictures.h"
#include "base/progress.h"
#include "gl/context.h"

namespace parian {

// For the thread that it was made in.
class PictureDrawer {
 public:
  PictureDrawer();
  ~PictureDrawer();
  PictureDrawer(const PictureDrawer&) = delete;
  PictureDrawer& operator=(const PictureDrawer&) = delete;

  // Linear radiance times 2^exposure but for a plain background, as render() has it; `picture` gets
  // the reports. Throws Error.
  Image draw(const PictureRequest& request, const Progress& progress, Picture& picture);
  // Why pictures come from the CPU from now on; empty after it was taken, and where they do not.
  std::string take_warning();
  // Forgets what is kept, after an error.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

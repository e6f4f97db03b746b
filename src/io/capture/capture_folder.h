// Folders of photographs: meta.json and one image for each frame (docs/capture.md).
#pragma once

#include <string>

#include "acquire/capture_meta.h"

namespace parian {

// Reads meta.json and checks that every frame is there, dark ones and whole exposures first; errors
// name the folder, or the file that is missing.
CaptureMeta open_capture(const std::string& folder);

// Codes of 8 or 16 bits as [0, 1], EXR values as they are. Errors name the file: another size or
// number of channels than meta.json says, infinite and NaN pixels. From any thread.
FrameLoader make_frame_loader(const std::string& folder, const CaptureMeta& meta);

// The folder must exist.
void save_capture_meta(const std::string& folder, const CaptureMeta& meta);
void save_frame(const std::string& folder, const CaptureMeta& meta, const FrameName& frame,
                const Image& codes);

}  // namespace parian

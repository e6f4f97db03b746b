// The JSON header of a .kbm file.
#pragma once

#include "io/blend/blend_file.h"

namespace parian {

struct BlendHeader {
  ProfileBlend blend;  // without planes
  std::size_t bases = 0;
  bool has_gain = false, has_dilation = false;
  BlendEncoding encoding = BlendEncoding::paper;
};

std::string format_header(const ProfileBlend& blend, BlendEncoding encoding);
// Throws Error naming file and key for anything that is missing, unknown or out of range.
BlendHeader parse_header(std::string_view text, const std::string& name);

}  // namespace parian

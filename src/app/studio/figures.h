// Sizes as several panels and messages say them.
#pragma once

#include <cstddef>
#include <string>

#include "material/profile_map.h"

namespace parian {

std::size_t map_bytes(const ProfileMap& map);  // in memory
std::string bytes_text(std::size_t bytes);     // "12.3 kB", "4.56 MB"

}  // namespace parian

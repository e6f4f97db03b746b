// Profile maps in HDF5 (docs/formats.md).
#pragma once

#include <string>

#include "material/profile_map.h"

namespace parian {

ProfileMap load_profile_map(const std::string& path);
void save_profile_map(const std::string& path, const ProfileMap& map);

// The root attribute "format" of an HDF5 file, or empty when the file is not HDF5 or has none.
std::string read_format(const std::string& path);

}  // namespace parian

// The planes of a packed blend as integers.
#pragma once

#include "io/blend/sections_internal.h"
#include "material/profile_blend.h"

namespace parian {

// The same material with its bases renumbered, so that similar ones are neighbours, and the entries
// of each pixel sorted by falling weight, so that the last one, which is not stored, is small.
ProfileBlend sort_blend(const ProfileBlend& blend);

// Payloads of the sections; the blend's values lie on its grid.
std::string pack_profiles(const ProfileBlend& blend);
std::string pack_indices(const ProfileBlend& blend);
std::string pack_weights(const ProfileBlend& blend);

// The reverse: sizes and grid of the blend are set, `bases` its number of base profiles.
void unpack_profiles(ByteReader reader, std::size_t bases, ProfileBlend& blend);
void unpack_indices(ByteReader reader, std::size_t bases, ProfileBlend& blend);
void unpack_weights(ByteReader reader, ProfileBlend& blend);

}  // namespace parian

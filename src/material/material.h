// The closed set of material models, and the one interface through which everything that judges or
// renders evaluates them.
//
// To add a model: a struct and eval_slice of its own in a file of its own; a line in Material; a
// case in each function of material.cpp; a reader and a writer in io; its name in `parian info`.
#pragma once

#include <memory>
#include <variant>

#include "material/dipole.h"
#include "material/profile_blend.h"
#include "material/profile_map.h"
#include "material/slices.h"

namespace parian {

using Material = std::variant<ProfileMap, ProfileBlend, Dipole>;

// "profile map", "profile blend", "dipole"
std::string describe_kind(const Material& material);

// The profile of a pixel, of materials that have one for each pixel; `has_profiles` says which.
bool has_profiles(const Material& material);
Profile get_profile(const Material& material, int channel, int x, int y);
// Pairs that its fit held out; none for materials without a fit.
HoldOut hold_out_of(const Material& material);
Boundary boundary_of(const Material& material);
double eta_of(const Material& material);

// Distance in mm beyond which R_d is zero.
double support_mm(const Material& material);

// The offsets within the material's support at its own pitch, for materials with a grid; a dipole
// has none and needs a header.
TableHeader natural_header(const Material& material);

// The material as a table with the header's grid, pitch and offsets: what a measurement of the
// model would give. The material must outlive the source. Throws Error when grids or channels
// disagree with the material's own.
std::unique_ptr<SliceSource> make_slices(const Material& material, TableHeader like,
                                         std::string name = {});

}  // namespace parian

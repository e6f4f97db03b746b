// The profiles of a layered surface (SurfaceLayer) as gathers want them: a field whose grid has a
// pixel for each point. Every point has the one profile that its materials and masks mix to, so
//
//   R_d(i, o) = sqrt(P_i(r) P_o(r))
//
// stays symmetric wherever a mask puts its seams.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "material/profile_field.h"
#include "scene/scene.h"

namespace parian {

// Knots of a layered field: as many, unless one of its materials has more by itself.
inline constexpr std::size_t layered_knots = 128;

// Point i of the surface lies at (x, y) = layered_place(i) of the field: whole numbers that floats
// hold exactly.
inline constexpr std::size_t layered_width = 4096;
constexpr Vec2 layered_place(std::size_t index) {
  const std::size_t line = index / layered_width;
  return {static_cast<float>(index % layered_width), static_cast<float>(line)};
}

// Of the scene's material and layers at `count` points; get(i) is thread-safe. Profiles are
// evaluated when asked for, on knots that serve all materials. Null when no layer counts at any of
// the points: the material's own field is then exact. The scene's mesh must live until this
// returns; layers have been checked (check_layers).
std::optional<ProfileField> make_layered_field(const Scene& scene, std::size_t count,
                                               const std::function<SurfacePoint(std::size_t)>& get);

// Increasing, from 0 to the fields' last knot: all of their knots, where they are more than
// layered_knots without those that bend profiles least; `refined`: with more in the widest gaps, as
// mixtures have kinks of their own.
std::vector<float> make_common_knots(const std::vector<const ProfileField*>& fields, bool refined);

}  // namespace parian

// Where light enters, on several scales: area-uniform samples of the surface in an order in which
// every four neighbours form a group, every four groups a larger one, and so on.
//
// A level's distances between emitters double from one to the next, so the kernel is split by
// radius into one part per level (a partition of unity, one octave each) and every part is
// summed over emitters and picture texels of its own scale: Chen et al. 2012 with samples of the
// surface in place of a light's texels. These serve any number and kind of lights at once,
// environments too, see all of the object and not only what one light sees, and stand for the same
// area each.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mesh/mesh.h"
#include "mesh/surface_samples.h"

namespace parian {

// An order of the points such that points 4^k i, ..., 4^k (i + 1) - 1 are neighbours for every k:
// halved along the longest side of their box. Does not depend on threads.
std::vector<std::uint32_t> order_by_groups(const std::vector<SurfacePoint>& points);

// Emitters of level l: ceil(samples / 4^l).
std::size_t level_size(std::size_t samples, int level);

// Radii of the levels. Level l weighs distances around radius_mm 2^l: it takes over from the level
// before around radius / sqrt 2 and gives way to the next around radius sqrt 2, each within
// `overlap` octaves. Level 0 takes everything below, the last everything beyond.
struct RadialLevels {
  int count = 1;
  double radius_mm = 1;  // of level 0
  double overlap = 1;    // at most 1
  // Radii at which profiles are taken: 0, 1/4, 1/2, 1 / sqrt 2, 1, ... times radius_mm.
  std::vector<float> nodes;

  double level_radius(int level) const;
  // Between which a level's weight is not 0; the last one's end is where nodes end.
  double first_mm(int level) const;
  double last_mm(int level) const;
  // Factor and offset from r to the part of the rise, and to that of the fall.
  std::array<float, 4> weight_place(int level) const;
};
// As many levels as it takes to reach max_support_mm.
RadialLevels make_radial_levels(double radius_mm, double overlap, double max_support_mm);
// Part of the kernel that a level takes at distance r, smooth steps in r: they sum to 1 up to
// last_mm of the last one.
double level_weight(const RadialLevels& levels, int level, double r_mm);
// Indices of the five nodes over its range.
std::array<int, 5> level_nodes(int level);

}  // namespace parian

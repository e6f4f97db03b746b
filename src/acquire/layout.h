// Layouts: how base materials are spread over a sample's plane. Each gives every point weights over
// the materials that are >= 0 and sum to 1. Lengths are in mm, so that pitch and size can change
// without changing the sample.
//
// To add a layout: a struct here, its parameters in describe (layout.cpp), a fill_weights of its
// own, a line in Layout and in layout_kinds, its keys in data/schema/sample.schema.json, its
// section in docs/samples.md.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "base/document.h"
#include "base/params.h"
#include "image/image.h"

namespace parian {

// Loads an image that a description names, relative to the description's file.
using ImageLoader = std::function<Image(const std::string& path)>;

// One material everywhere.
struct UniformLayout {};

// Squares of all materials in turn.
struct ChessboardLayout {
  double tile_mm = 5;
  double rotation_deg = 0;
};

// Ellipses of the other materials, cut where they meet, in a matrix of the first one.
struct StonesLayout {
  double size_mm = 4;          // spacing of the stones, about their diameter
  double spread = 0.4;         // relative spread of their radii
  double elongation = 1.4;     // largest ratio of the axes
  double coverage = 0.9;       // part of the places that hold a stone
  double gap_mm = 0.2;         // matrix between neighbours
  double roughness = 0.1;      // displacement of the outlines, relative to the size
  std::vector<double> shares;  // relative frequency of materials 2, 3, ...; empty: equal
};

// Thin sheets of the other materials, cut by the plane, in the first one.
struct VeinsLayout {
  double spacing_mm = 10;
  double width_mm = 0.8;  // full width at half strength
  double angle_deg = 0;
  double stretch = 1.5;   // along the angle
  double presence = 0.8;  // part of the veins' length that is there at all
  int octaves = 4;
};

// Tilted bands of all materials in turn.
struct LayersLayout {
  double thickness_mm = 3;  // of one band, on average
  double angle_deg = 0;     // of the bands, against x
  double waviness_mm = 1;   // standard deviation of their displacement
  double wavelength_mm = 12;
  double irregularity = 0.3;   // of the thickness
  double softness_mm = 0.3;    // width of the transitions
  std::vector<double> shares;  // relative thickness; empty: equal
};

// Smooth mixing: the materials' weights are exp(sharpness noise), normalised.
struct MixingLayout {
  double wavelength_mm = 8;
  double sharpness = 2;
  int octaves = 4;
  std::vector<double> shares;  // factors of the weights; empty: equal
};

// A grey image stretched over the sample. Its linear luminance chooses: interpolated between the
// materials, which stand at equal distances from 0 to 1; with thresholds, the material whose
// interval it lies in. A stack of images, from the top down, shares the depth equally.
struct ImageLayout {
  std::string image;
  std::vector<double> thresholds;
  Image map;
  std::vector<Image> deeper;  // of a stack, the maps below the first
};

using Layout = std::variant<UniformLayout, ChessboardLayout, StonesLayout, VeinsLayout,
                            LayersLayout, MixingLayout, ImageLayout>;

// "uniform", "chessboard", ... in the order of Layout.
const std::vector<std::string>& layout_kinds();
Layout make_layout(const std::string& kind);
ParamList describe(Layout& layout);

// The description's "layout" object for this number of materials. Errors name the place.
Layout read_layout(const Document& object, int materials, const ImageLoader& load_image);

// The pixels or voxels that weights are made for. `width` x `height` pixels are the sample, over
// which images are stretched; a volume adds a margin around them and layers of depth.
struct LayoutGrid {
  int width = 1;
  int height = 1;
  double pixel_pitch_mm = 1;
  int materials = 1;
  std::uint64_t seed = 1;
  int margin = 0;      // pixels on every side
  int layers = 1;      // voxels of depth, cubes
  bool solid = false;  // the layout's random structures are made in space, not in the plane
  // The layout at depth z is shifted by z times this: it follows lines tilted from the vertical.
  double slant_x = 0;
  double slant_y = 0;
};

// Weights [material][z][y][x], means over points of each pixel or voxel: 4 x 4 in the plane, 2 x 2
// x 2 with depth.
std::vector<float> make_weights(const Layout& layout, const LayoutGrid& grid);

}  // namespace parian

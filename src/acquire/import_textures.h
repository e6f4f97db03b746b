// Albedo and mean-free-path textures, as artists have them, as a profile map: every pixel gets the
// profile of a homogeneous material with its numbers.
#pragma once

#include <cstddef>
#include <vector>

#include "acquire/layout.h"
#include "base/document.h"
#include "image/image.h"
#include "material/profile_map.h"

namespace parian {

enum class TextureModel {
  burley,  // normalised diffusion, Burley 2015
  dipole,  // Jensen et al. 2001; the albedo is inverted to alpha'
};
enum class TextureRadius {
  mean_free_path,          // l = 1 / sigma_t'
  diffuse_mean_free_path,  // 1 / sigma_tr
};

struct TextureImport {
  TextureModel model = TextureModel::burley;
  TextureRadius radius = TextureRadius::mean_free_path;
  double pixel_pitch_mm = 1;
  double eta = 1.3;  // of the dipole
  int segments = 24;
  Image albedo;     // total diffuse reflectance, linear, 1 or 3 channels
  Image radius_mm;  // of the same size, 1 or 3 channels
};

// Reads and checks a description (docs/formats.md, "Imports"). Images of colours go through
// load_image, of radii through load_data (values as stored), with paths resolved against the
// description's file.
TextureImport read_texture_import(const Document& document, const ImageLoader& load_image,
                                  const ImageLoader& load_data);

// Limits outside which values are moved to the limit.
inline constexpr double min_texture_albedo = 1e-3, max_texture_albedo = 0.999;

struct TextureMap {
  ProfileMap map;           // Boundary::included
  std::size_t limited = 0;  // values of albedo or radius that were moved
};

// ln P is the model's at the knots but the first, where it makes the innermost segment hold what
// the model has there (Burley's is infinite at r = 0); then all of it is scaled so that the albedo
// 2 pi int P r dr is the texture's to rounding. Radii below a quarter of the pitch count as that.
TextureMap make_texture_map(const TextureImport& import);

// The alpha' of which dipole_albedo is `albedo`, in (0, 1).
double invert_dipole_albedo(double albedo, double eta);

}  // namespace parian

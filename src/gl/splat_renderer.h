// The real-time renderer: multiresolution splatting (profile blending 2019, section 3.4, after Chen
// et al. 2012) of profile maps, blends and dipoles under any lights, with nothing beyond OpenGL ES
// 3.0, EXT_color_buffer_float and EXT_float_blend.
//
//   L(o) = T M(o) / pi + specular,   M(o) = sum_i a_o(r) a_i(r) flux_i,   a = sqrt P, r = |x_i -
//   x_o|
//
// The kernel is split by radius into octaves (gl/sample_levels.h). Octave l is summed from groups
// of 4^l samples, with their moments, over texels of 4^l times the area, without the pixel's own
// profile; every pixel takes the sums from the texels around it and applies its profile at their
// mean radius. The reflection is that of render/. All images are those of render/ up to these
// approximations.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "gl/context.h"
#include "image/image.h"
#include "scene/scene.h"

namespace parian {

// How directional and point lights reach the samples: by rays traced on the CPU, or by shadow maps,
// which follow a moving light at once. Environments are always traced, and kept until they change.
enum class LightMode { traced, mapped };

struct SplatParams {
  int samples = 50000;       // where light enters
  int rays = 128;            // per sample and environment light
  int antialias = 2;         // n x n pixels drawn per pixel
  double octave = 2.5;       // radius of the first level in spacings of the samples
  double overlap = 1;        // octaves within which a level gives way to the next
  double texel = 0.5;        // of the first level in spacings of the samples
  double group_texel = 0.3;  // of the others in spacings of their groups of samples
  LightMode lights = LightMode::traced;
  int shadow_size = 2048;    // texels of a shadow map's side
  int reflection_rays = 16;  // per pixel drawn and environment light
  std::uint64_t seed = 1;
};
ParamList describe(SplatParams& params);
// For an editor while something moves: few samples, shadow maps, one ray a pixel. Errors are two
// to four times those of the defaults; without a graphics device a view of 640 x 480 suits.
SplatParams make_interactive_params();

struct SplatReport {
  double sampling_s = 0, irradiance_s = 0, material_s = 0;  // when lights or material change
  double group_s = 0, view_s = 0, splat_s = 0, resolve_s = 0, shade_s = 0;  // of a picture
  double read_s = 0;
  std::size_t samples = 0, splats = 0;
  double sample_spacing_mm = 0;
  double area_mm2 = 0;           // of the mesh
  double escaping_fraction = 0;  // of rays sent inwards: holes in the mesh
  std::size_t targets = 0;       // pixels drawn
  int levels = 0;
  std::vector<int> blocks;                            // pixels of each level's texels
  std::vector<double> level_s;                        // of splat_s
  std::size_t texture_bytes = 0, material_bytes = 0;  // of all textures, of the material's
  std::string device;
  std::vector<std::string> warnings;
};

// A scene ready to be drawn. Needs the context that it was made in to be current.
class SplatRenderer {
 public:
  // Throws Error for a table without a fit, which only render/ draws, for layers as check_layers
  // does, and when textures exceed the device's limits.
  SplatRenderer(const GlLimits& limits, const Scene& scene, const SplatParams& params,
                const Progress& progress = {});
  ~SplatRenderer();
  SplatRenderer(SplatRenderer&&) noexcept;
  SplatRenderer& operator=(SplatRenderer&&) noexcept;

  // Each of these and then draw; what did not change is kept. The scene's layers lie over any
  // material until others come with one, which are checked as the first ones; their profiles are
  // found anew for each pixel when material, layers or camera change.
  void set_material(const Material& material);
  void set_material(const Material& material, const std::vector<SurfaceLayer>& layers);
  void set_lights(const std::vector<Light>& lights, const Progress& progress = {});
  void set_camera(const Camera& camera);
  void set_exposure(double stops);

  // Linear radiance times 2^exposure into textures of its own; read() copies it, averaged over the
  // n x n pixels. `timed`: waits after each stage, fills the report, and can be cancelled.
  void draw(bool timed = false, const Progress& progress = {});
  Image read();
  // Of the last picture: 1 where the mesh is seen by all n x n, 0 by none.
  const std::vector<float>& coverage() const;
  // Seconds that the device takes for all splats of the last picture when a constant is added in
  // place of what they are worth: the limit that splat_s is judged by. Draw again afterwards.
  double time_bare_splats();
  // Sum of the flux over the emitters of a level, W: the same for all of them.
  Rgb level_flux(int level) const;

  const SplatReport& report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

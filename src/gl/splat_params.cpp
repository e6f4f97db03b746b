#include "gl/shading.h"
#include "gl/splat_renderer.h"
#include "transport/irradiance.h"

namespace parian {

ParamList describe(SplatParams& params) {
  return {describe_samples(params.samples, 4'000'000),
          describe_rays(params.rays),
          describe_antialias(params.antialias),
          {.name = "octave",
           .help = "radius of the first level in spacings of the samples",
           .target = &params.octave,
           .min = 2,
           .max = 16},
          {.name = "overlap",
           .help = "octaves within which a level gives way to the next",
           .target = &params.overlap,
           .min = 0.1,
           .max = 1},
          {.name = "texel",
           .help = "size of the first level's texels in spacings of the samples",
           .target = &params.texel,
           .min = 0.125,
           .max = 4},
          {.name = "group-texel",
           .help = "size of the other levels' texels in spacings of their groups of samples",
           .target = &params.group_texel,
           .min = 0.125,
           .max = 4},
          {.name = "lights",
           .help = "how directional and point lights reach the surface: traced, or by shadow maps",
           .target = make_choice(params.lights, {"traced", "mapped"})},
          describe_shadow_size(params.shadow_size),
          describe_reflection_rays(params.reflection_rays),
          describe_seed(params.seed)};
}

SplatParams make_interactive_params() {
  SplatParams params;
  params.samples = 4000;
  params.texel = 0.75;
  params.rays = 32;
  params.antialias = 1;
  params.lights = LightMode::mapped;
  params.shadow_size = 1024;
  params.reflection_rays = 4;
  return params;
}

}  // namespace parian

#include "gl/splat_renderer.h"

namespace parian {

ParamList describe(SplatParams& params) {
  return {{.name = "samples",
           .help = "points of the surface at which light enters",
           .target = &params.samples,
           .min = 100,
           .max = 4'000'000},
          {.name = "rays",
           .help = "per sample and environment light",
           .target = &params.rays,
           .min = 2,
           .max = 65'536},
          {.name = "antialias",
           .help = "n x n pixels drawn per pixel",
           .target = &params.antialias,
           .min = 1,
           .max = 8,
           .symbol = "n"},
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
          {.name = "shadow-size",
           .help = "texels of a shadow map's side",
           .target = &params.shadow_size,
           .min = 64,
           .max = 16'384},
          {.name = "reflection-rays",
           .help = "per pixel drawn and environment light",
           .target = &params.reflection_rays,
           .min = 1,
           .max = 1024},
          {.name = "seed", .help = "of samples and rays", .target = &params.seed}};
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

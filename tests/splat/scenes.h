// Small scenes for the tests of splatting.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "gl/splat_renderer.h"
#include "mesh/shapes.h"
#include "scene/camera.h"
#include "scene/environment.h"

namespace parian::splat_scenes {

inline constexpr int samples = 40000, rays = 64;

// Two materials in a chequer of two, 16 x 16 pixels of 1 mm: mean free paths and albedos differ.
inline ProfileMap make_chequered_map(Boundary boundary = Boundary::included) {
  std::vector<double> knots;
  for (int k = 0; k <= 10; ++k) knots.push_back(0.9 * k);
  ProfileMap map = make_profile_map(16, 16, 3, 1.0, knots);
  map.boundary = boundary;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k <= 10; ++k)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const bool dark = ((x / 4) + (y / 4)) % 2 == 0;
          const double length = (dark ? 1.2 : 2.0) * (c == 0 ? 1.2 : c == 1 ? 1.0 : 0.8);
          const double albedo = dark ? 0.3 + 0.1 * c : 0.8 - 0.1 * c;
          knot_plane(map, c, k)[y * 16 + x] = static_cast<float>(
              std::log(albedo / (2 * 3.14159265358979 * length * length)) - 0.9 * k / length);
        }
  return map;
}

// Six bases from narrow to wide, two per pixel, mixed smoothly over the plane.
inline ProfileBlend make_mixed_blend() {
  ProfileBlend blend;
  blend.width = blend.height = 24;
  blend.pixel_pitch_mm = 0.8;
  blend.boundary = Boundary::included;
  for (int k = 0; k <= 10; ++k) blend.knots_mm.push_back(0.8 * k);
  for (int base = 0; base < 6; ++base)
    for (int c = 0; c < 3; ++c) {
      const double length = 0.9 + 0.3 * base - 0.1 * c, albedo = 0.35 + 0.08 * ((base + c) % 6);
      for (const double knot : blend.knots_mm)
        blend.base_log_profile.push_back(static_cast<float>(
            std::log(albedo / (2 * 3.14159265358979 * length * length)) - knot / length));
    }
  const std::size_t pixels = blend.pixels();
  blend.index.resize(2 * pixels);
  blend.weight.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::size_t row = i / 24;
    const double x = static_cast<double>(i % 24), y = static_cast<double>(row);
    blend.index[i] = static_cast<std::uint16_t>((i / 4) % 6);
    blend.index[pixels + i] = static_cast<std::uint16_t>((row / 3) % 6);
    blend.weight[i] = static_cast<float>(0.5 + 0.5 * std::sin(0.7 * x) * std::cos(0.5 * y));
  }
  check(blend, "test blend");
  return blend;
}

inline Dipole make_marble() {
  Dipole marble;
  marble.channels = {{0.0021, 2.19, 0}, {0.0041, 2.62, 0}, {0.0071, 3.0, 0}};
  marble.eta = 1.5;
  return marble;
}

inline Scene make_scene(TriangleMesh mesh, SurfaceMaterial material, std::vector<Light> lights) {
  Scene scene;
  clean_mesh(mesh, "test mesh");
  fit_to_size(mesh, 50);
  scene.mesh = std::move(mesh);
  scene.mesh_name = "test mesh";
  scene.material = std::move(material);
  scene.lights = std::move(lights);
  scene.camera.width = 200;
  scene.camera.height = 150;
  scene.camera.target = center(bounds(scene.mesh));
  scene.specular.enabled = false;
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

inline Light make_sun(Vec3 direction) {
  return DirectionalLight{normalize(direction), {3, 2.8f, 2.5f}};
}
inline Light make_sky() {
  EnvironmentLight light;
  light.image = make_sky_image(64, 32);
  return light;
}

inline SplatParams make_params() {
  SplatParams params;
  params.samples = samples;
  params.rays = rays;
  params.antialias = 1;
  return params;
}

}  // namespace parian::splat_scenes

// Small scenes for the tests of rendering.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "mesh/shapes.h"
#include "render/render.h"
#include "scene/camera.h"

namespace parian::testing_scenes {

inline constexpr float pi = std::numbers::pi_v<float>;

// exp(-r / length) with the albedo 2 pi C, the same everywhere. Grid of 8 x 8.
inline ProfileMap make_uniform_map(double length_mm, double albedo,
                                   Boundary boundary = Boundary::included) {
  std::vector<double> knots;
  for (int k = 0; k <= 8; ++k) knots.push_back(k * length_mm);
  ProfileMap map = make_profile_map(8, 8, 3, length_mm, knots);
  map.boundary = boundary;
  map.eta = 1.3;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k <= 8; ++k)
      std::fill_n(knot_plane(map, c, k), map.pixels(), static_cast<float>(-k));
  const double shift = std::log(albedo / diffuse_albedo(get_profile(map, 0, 0, 0)));
  for (float& value : map.log_profile) value += static_cast<float>(shift);
  return map;
}

// Stripes of two albedos.
inline ProfileMap make_striped_map(double length_mm) {
  ProfileMap map = make_uniform_map(length_mm, 0.8);
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k <= 8; ++k)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
          if (x % 4 < 2) knot_plane(map, c, k)[y * 8 + x] -= 0.5f * static_cast<float>(c + 1);
  return map;
}

inline EnvironmentLight white_environment(float radiance = 1) {
  EnvironmentLight light;
  light.image = make_image(16, 8, 3, radiance);
  return light;
}

inline Scene make_scene(TriangleMesh mesh, double size_mm, SurfaceMaterial material, int width = 40,
                        int height = 30) {
  Scene scene;
  if (mesh.triangles.size() > 2) clean_mesh(mesh, "test mesh");
  fit_to_size(mesh, size_mm);
  scene.mesh = std::move(mesh);
  scene.mesh_name = "test mesh";
  scene.material = std::move(material);
  scene.specular.enabled = false;
  scene.camera.width = width;
  scene.camera.height = height;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

inline RenderParams quick_params() {
  RenderParams params;
  params.samples = 4000;
  params.rays = 32;
  params.antialias = 1;
  params.method = GatherMethod::brute;
  return params;
}

}  // namespace parian::testing_scenes

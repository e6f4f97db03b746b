#include "bench/common/assets.h"
#include "bench/homogeneous/study.h"
#include "scene/camera.h"

namespace parian {

Scene make_dragon_scene(int width, int height, const Dipole& material) {
  Scene scene;
  scene.mesh = make_bench_mesh("dragon-22998.ply", 3, 60);
  scene.mesh_name = "dragon";
  scene.material = Material(material);
  scene.lights = {make_bench_environment()};
  scene.camera.width = width;
  scene.camera.height = height;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  scene.background = {0.03f, 0.03f, 0.035f};
  return scene;
}

}  // namespace parian

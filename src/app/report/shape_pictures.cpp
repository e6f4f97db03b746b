#include "app/report/shape_pictures.h"

#include <fmt/format.h>

#include <filesystem>

#include "app/report/html.h"
#include "app/report/pictures.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/mesh/mesh_file.h"
#include "mesh/shapes.h"
#include "render/render.h"
#include "scene/camera.h"
#include "scene/environment.h"

namespace parian {
namespace {

constexpr const char* mesh_file = "dragon-100250.ply";
constexpr const char* environment_file = "sunset.exr";
constexpr double size_mm = 80;
constexpr float amplification = 4;  // of the difference picture

struct Setting {
  Scene scene;
  std::string description;
};

bool has_asset(const std::string& assets, const char* file) {
  std::error_code ignored;
  return !assets.empty() && std::filesystem::exists(assets + "/" + file, ignored);
}

// The dragon under an evening sky and a lamp; built-in stand-ins where assets are missing.
Setting make_setting(const std::string& assets) {
  Setting setting;
  Scene& scene = setting.scene;
  EnvironmentLight sky;
  sky.scale = {0.6f, 0.6f, 0.6f};
  if (has_asset(assets, mesh_file)) {
    scene.mesh = load_mesh(assets + "/" + mesh_file);
    setting.description = "The Stanford dragon (Stanford 3D Scanning Repository)";
  } else {
    scene.mesh = make_shape("knot");
    setting.description =
        "Stanford's dragon was not fetched (./run assets), so this is a built-in shape";
  }
  scene.mesh_name = mesh_file;
  fit_to_size(scene.mesh, size_mm);
  if (has_asset(assets, environment_file)) {
    sky.image =
        make_environment_image(load_image(assets + "/" + environment_file), environment_file);
    setting.description +=
        fmt::format(", {} mm long, lit by the environment '{}'", size_mm, environment_file);
  } else {
    sky.image = make_sky_image();
    setting.description += fmt::format(", {} mm long, lit by a built-in sky", size_mm);
  }
  setting.description += " and by a lamp from the left.";
  DirectionalLight lamp;
  lamp.direction = normalize(Vec3{-0.7f, 0.9f, 0.8f});
  lamp.irradiance = {1.0f, 0.93f, 0.82f};
  scene.lights = {sky, lamp};
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  scene.background = {0.03f, 0.03f, 0.035f};
  return setting;
}

std::string seconds_of(const RenderReport& report) {
  return fmt::format("{:.1f} s for {} samples and {} targets", report.total_s, report.samples,
                     report.targets);
}

}  // namespace

std::string make_shape_pictures(const ShapePictures& pictures, const Progress& progress) {
  Setting setting = make_setting(pictures.assets);
  Scene& scene = setting.scene;
  const std::string stem = pictures.folder + "/shape";

  // Both at the table's resolution: without a fit every pair is looked up.
  RenderParams params;
  params.samples = pictures.small ? 4000 : 60000;
  params.rays = pictures.small ? 16 : 64;
  params.antialias = 2;
  scene.camera.width = pictures.small ? 120 : 480;
  scene.camera.height = pictures.small ? 90 : 360;
  scene.material = read_table(*open_table(pictures.table));
  scene.material_name = pictures.table;
  const RenderResult table = render(scene, params, progress);
  scene.material = Material(load_profile_map(pictures.map));
  scene.material_name = pictures.map;
  const RenderResult fit = render(scene, params, progress);
  save_image(stem + "-table.png", table.image);
  save_image(stem + "-fit.png", fit.image);
  save_image(stem + "-difference.png",
             scale(absolute_difference(fit.image, table.image), amplification));

  if (!pictures.small) {
    scene.camera.width = 960;
    scene.camera.height = 720;
    params = {};
  }
  const RenderResult large = render(scene, params, progress);
  save_image(stem + ".png", large.image);

  return html_heading("On a shape") +
         html_paragraph(setting.description +
                        " Two passes: irradiance at points spread evenly over the surface, then "
                        "for each pixel the light that arrives from all of them. The large picture "
                        "uses the moment tree.") +
         html_figures(
             {{"shape.png", fmt::format("From the fitted profiles: {}.", seconds_of(large.report)),
               false}},
             1) +
         html_paragraph(fmt::format(
             "The same picture without a fit: every pair of points is looked up in the table, at "
             "the displacement in the tangent plane. The table knows directions and ends at its "
             "window; the profiles know neither. Left the table ({}), then the fit ({}), then the "
             "difference times {}.",
             seconds_of(table.report), seconds_of(fit.report), amplification)) +
         html_figures({{"shape-table.png", "table", false},
                       {"shape-fit.png", "fit", false},
                       {"shape-difference.png", "difference", false}},
                      3);
}

}  // namespace parian

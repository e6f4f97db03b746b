#include "gl/shading.h"

#include <algorithm>
#include <cmath>

namespace parian {
namespace {

const Program& use_reflector(const Program& program, const PictureTargets& targets,
                             const ShadingInput& input) {
  const Specular& specular = input.scene.specular;
  use(program);
  bind_texture(program, "positions", 0, targets.geometry.positions);
  bind_texture(program, "normals", 1, targets.geometry.normals);
  bind_texture(program, "places", 2, targets.geometry.places);
  set_uniform(program, "viewer", input.camera.frame.position);
  set_uniform(program, "alpha",
              std::max(1e-3f, static_cast<float>(specular.roughness * specular.roughness)));
  set_uniform(program, "eta", static_cast<float>(specular.eta > 0 ? specular.eta : input.eta));
  return program;
}

float find_exposure(const ShadingInput& input) {
  return std::exp2(static_cast<float>(input.scene.exposure));
}

void draw_reflections(const PictureTargets& targets, const ShadingPrograms& programs,
                      const ShadingInput& input) {
  bind(targets.reflection_target);
  clear_color(0);
  set_additive_blending(true);
  for (const Lamp& lamp : input.lights.lamps) {
    bind_lamp(use_reflector(programs.reflection.of(lamp), targets, input), lamp, 3);
    draw_screen_on_surface();
  }
  for (const Sky& sky : input.lights.skies) {
    const Program& program = use_reflector(programs.sky_reflection, targets, input);
    set_uniform(program, "rays", input.reflection_rays);
    bind_sky(program, sky, 3);
    bind_self_occlusion(program, input.occlusion, 4);
    draw_screen_on_surface();
  }
  set_additive_blending(false);
  check_gl("reflections");
}

// Adds environments behind the object.
void draw_background(const PictureTargets& targets, const ShadingPrograms& programs,
                     const ShadingInput& input) {
  set_additive_blending(true);
  const Program& program = programs.sky_background;
  use(program);
  bind_texture(program, "positions", 0, targets.geometry.positions);
  set_uniform(program, "exposure", find_exposure(input));
  set_camera(program, input.camera);
  for (const Sky& sky : input.lights.skies) {
    bind_sky(program, sky, 1);
    draw_screen();
  }
  set_additive_blending(false);
}

}  // namespace

Param describe_antialias(int& antialias) {
  return {.name = "antialias",
          .help = "n x n pixels drawn per pixel",
          .target = &antialias,
          .min = 1,
          .max = 8,
          .symbol = "n"};
}

Param describe_shadow_size(int& shadow_size) {
  return {.name = "shadow-size",
          .help = "texels of a shadow map's side",
          .target = &shadow_size,
          .min = 64,
          .max = 16'384};
}

Param describe_reflection_rays(int& reflection_rays) {
  return {.name = "reflection-rays",
          .help = "per pixel drawn and environment light",
          .target = &reflection_rays,
          .min = 1,
          .max = 1024};
}

PictureTargets make_picture_targets(int width, int height) {
  PictureTargets targets;
  targets.geometry = make_geometry_buffer(width, height);
  const Attachment depth{&targets.geometry.depth};
  targets.exitance = make_texture(TexelFormat::rgba32f, width, height, "picture");
  targets.exitance_target = make_framebuffer({{&targets.exitance}}, "picture", depth);
  targets.reflections = make_texture(TexelFormat::rgba32f, width, height, "picture");
  targets.reflection_target = make_framebuffer({{&targets.reflections}}, "picture", depth);
  targets.radiance = make_texture(TexelFormat::rgba32f, width, height, "picture");
  targets.radiance_target = make_framebuffer({{&targets.radiance}}, "picture", depth);
  return targets;
}

LampProgram make_lamp_program(const std::vector<std::string_view>& fragment) {
  const std::vector<std::string_view> vertex{"screen_vertex.glsl"};
  return {make_program(vertex, fragment, {"SHADOW_VIEWS 1"}),
          make_program(vertex, fragment, {"SHADOW_VIEWS 6"})};
}

ShadingPrograms make_shading_programs() {
  ShadingPrograms programs;
  programs.shade = make_program({"screen_vertex.glsl"}, {"fresnel.glsl", "shade_fragment.glsl"});
  programs.reflection = make_lamp_program({"fresnel.glsl", "octahedral.glsl", "reflector.glsl",
                                           "lamp.glsl", "lamp_reflection_fragment.glsl"});
  programs.sky_reflection = make_program(
      {"screen_vertex.glsl"}, {"fresnel.glsl", "octahedral.glsl", "reflector.glsl", "sky.glsl",
                               "self_occlusion.glsl", "sky_reflection_fragment.glsl"});
  programs.sky_background = make_program(
      {"screen_vertex.glsl"}, {"camera.glsl", "sky.glsl", "sky_background_fragment.glsl"});
  return programs;
}

LightObjects make_light_objects(const std::vector<Light>& lights, const Scene& scene,
                                const MeshBuffers& mesh, int shadow_size, bool with_flux) {
  LightObjects objects;
  const bool reflects = scene.specular.enabled;
  for (const Light& light : lights) {
    if (const auto* sky = std::get_if<EnvironmentLight>(&light)) {
      if (reflects || scene.show_environment) objects.skies.push_back(make_sky(*sky));
    } else if (reflects || with_flux) {
      const auto* sun = std::get_if<DirectionalLight>(&light);
      objects.lamps.push_back(sun != nullptr
                                  ? make_lamp(*sun, mesh, shadow_size)
                                  : make_lamp(std::get<PointLight>(light), mesh, shadow_size));
    }
  }
  return objects;
}

bool reflects_environments(const Scene& scene) {
  const auto is_environment = [](const Light& light) {
    return std::holds_alternative<EnvironmentLight>(light);
  };
  return scene.specular.enabled &&
         std::any_of(scene.lights.begin(), scene.lights.end(), is_environment);
}

void shade(PictureTargets& targets, const ShadingPrograms& programs, const ShadingInput& input) {
  const bool reflects = input.scene.specular.enabled;
  if (reflects && targets.reflections_are_old) draw_reflections(targets, programs, input);
  targets.reflections_are_old = targets.reflections_are_old && !reflects;
  const Program& program = programs.shade;
  bind(targets.radiance_target);
  use(program);
  bind_texture(program, "positions", 0, targets.geometry.positions);
  bind_texture(program, "normals", 1, targets.geometry.normals);
  bind_texture(program, "exitances", 2, targets.exitance);
  bind_texture(program, "reflections", 3, targets.reflections);
  set_uniform(program, "is_reflecting", reflects ? 1 : 0);
  set_uniform(program, "is_transmitting", input.boundary == Boundary::excluded ? 1 : 0);
  set_uniform(program, "eta", static_cast<float>(input.eta));
  set_uniform(program, "exposure", find_exposure(input));
  set_uniform(program, "background", input.scene.show_environment ? Rgb{} : input.scene.background);
  draw_screen();
  if (input.scene.show_environment) draw_background(targets, programs, input);
  check_gl("picture");
}

Image read_picture(const Framebuffer& radiance, int antialias, std::vector<float>& coverage) {
  const std::vector<float> values = read_pixels(radiance);
  const int n = antialias;
  const int width = radiance.width / n, height = radiance.height / n;
  const float share = 1.0f / static_cast<float>(n * n);
  Image image = make_image(width, height, 3);
  coverage.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f);
  for (int y = 0; y < n * height; ++y)
    for (int x = 0; x < n * width; ++x) {
      const std::size_t from =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(n * width) +
               static_cast<std::size_t>(x));
      for (int c = 0; c < 3; ++c)
        at(image, x / n, y / n, c) += share * values[from + static_cast<std::size_t>(c)];
      coverage[static_cast<std::size_t>(y / n) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x / n)] += share * values[from + 3];
    }
  return image;
}

}  // namespace parian

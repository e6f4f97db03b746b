#include "gl/lamps.h"

#include <epoxy/gl.h>

#include <array>
#include <cmath>

namespace parian {
namespace {

// Device coordinates of a view from `origin`: rows of the matrix from linear forms a . p + b.
struct View {
  Vec3 origin, right, up, forward;
  float half = 1;  // half the extent, in mm (parallel) or at distance 1
  float near_mm = 0, far_mm = 1;
};

Mat4 to_matrix(const std::array<Vec3, 4>& a, const std::array<float, 4>& b) {
  Mat4 matrix{};
  for (std::size_t row = 0; row < 4; ++row) {
    matrix[row] = a[row].x;
    matrix[4 + row] = a[row].y;
    matrix[8 + row] = a[row].z;
    matrix[12 + row] = b[row];
  }
  return matrix;
}

Mat4 make_parallel(const View& v) {
  const float depth = v.far_mm - v.near_mm;
  const auto offset = [&](Vec3 axis) { return -dot(axis, v.origin); };
  return to_matrix({v.right / v.half, v.up / v.half, v.forward * (2 / depth), Vec3{}},
                   {offset(v.right) / v.half, offset(v.up) / v.half,
                    2 * (offset(v.forward) - v.near_mm) / depth - 1, 1});
}

Mat4 make_perspective(const View& v) {
  const float depth = v.far_mm - v.near_mm, sum = v.far_mm + v.near_mm;
  const auto offset = [&](Vec3 axis) { return -dot(axis, v.origin); };
  return to_matrix(
      {v.right / v.half, v.up / v.half, v.forward * (sum / depth), v.forward},
      {offset(v.right) / v.half, offset(v.up) / v.half,
       (sum * offset(v.forward) - 2 * v.far_mm * v.near_mm) / depth, offset(v.forward)});
}

void draw_depth(Lamp& lamp, const MeshBuffers& mesh, int size) {
  const Program program = make_program({"shadow_vertex.glsl"}, {"shadow_fragment.glsl"});
  lamp.depth = make_texture_array(TexelFormat::depth32f, size, size,
                                  static_cast<int>(lamp.views.size()), "shadow map");
  use(program);
  for (std::size_t i = 0; i < lamp.views.size(); ++i) {
    const Attachment layer{&lamp.depth, static_cast<int>(i)};
    const Framebuffer target = make_framebuffer({}, "shadow map", layer);
    bind(target);
    clear_depth(1);
    set_uniform(program, "shadow_view", std::vector<Mat4>{lamp.views[i]});
    set_additive_blending(false);
    draw_mesh(mesh, lamp.is_near ? std::optional(lamp.place) : std::nullopt);
  }
  check_gl("shadow map");
}

View look_along(Vec3 origin, Vec3 forward) {
  const Frame frame = make_frame(forward);
  return {.origin = origin, .right = frame.tangent, .up = frame.bitangent, .forward = forward};
}

}  // namespace

Lamp make_lamp(const DirectionalLight& light, const MeshBuffers& mesh, int size) {
  Lamp lamp;
  lamp.place = light.direction;
  lamp.power = light.irradiance;
  const float radius = 0.51f * diagonal(mesh.box);
  View view = look_along(center(mesh.box), -light.direction);
  view.half = radius;
  view.near_mm = -radius;
  view.far_mm = radius;
  lamp.views = {make_parallel(view)};
  lamp.texel = {{2 * radius / static_cast<float>(size), 0}};
  draw_depth(lamp, mesh, size);
  return lamp;
}

Lamp make_lamp(const PointLight& light, const MeshBuffers& mesh, int size) {
  Lamp lamp;
  lamp.place = light.position;
  lamp.is_near = true;
  lamp.power = light.intensity;
  const float radius = 0.51f * diagonal(mesh.box);
  const Vec3 towards = center(mesh.box) - light.position;
  const float far = length(towards);
  std::vector<View> views;
  if (far > 1.2f * radius) {
    views.push_back(look_along(light.position, towards / far));
    views[0].half = radius / std::sqrt(far * far - radius * radius);
    views[0].near_mm = far - radius;
  } else {
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0},
                            Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
      views.push_back(look_along(light.position, axis));
      views.back().near_mm = 1e-3f * radius;
    }
  }
  for (View& view : views) {
    view.far_mm = far + radius;
    lamp.views.push_back(make_perspective(view));
    lamp.texel.push_back({0, 2 * view.half / static_cast<float>(size)});
  }
  draw_depth(lamp, mesh, size);
  return lamp;
}

Sky make_sky(const EnvironmentLight& light) {
  return {make_picture_texture(light.image, "environment"),
          static_cast<float>(light.rotation_deg / 360), light.scale};
}

void bind_lamp(const Program& program, const Lamp& lamp, int unit) {
  bind_texture(program, "shadow_depth", unit, lamp.depth);
  set_uniform(program, "shadow_view", lamp.views);
  set_uniform(program, "shadow_texel", lamp.texel);
  set_uniform(program, "lamp", lamp.place);
  set_uniform(program, "lamp_is_near", lamp.is_near ? 1 : 0);
  set_uniform(program, "lamp_power", lamp.power);
}

void bind_sky(const Program& program, const Sky& sky, int unit) {
  bind_texture(program, "sky", unit, sky.picture);
  set_uniform(program, "sky_turn", sky.turn);
  set_uniform(program, "sky_scale", sky.scale);
}

}  // namespace parian

#include "gl/splat_levels.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "transport/near_term.h"

namespace parian {
namespace {

constexpr int tile = 8;  // texels of a side
// B is kept where it lies farther from A than this many texels' sides.
constexpr double layer_distance = 1.5;

int blocks_of(int pixels, int block) {
  return (pixels + block - 1) / block;
}

// Pixels of a side of a level's texels: the power of two that is nearest to what is wanted.
int choose_block(const SplatCamera& camera, double wanted_mm) {
  const double pixel_mm =
      2 * camera.frame.half_height / camera.frame.height * static_cast<double>(camera.middle_mm);
  int block = 1;
  while (std::numbers::sqrt2 * block * pixel_mm <= wanted_mm && block < 4096) block *= 2;
  return block;
}

ViewLevel make_view_level(int width, int height, int block, bool is_single, SplatFormat format) {
  ViewLevel level;
  level.block = block;
  level.layers = block == 1 ? 1 : 2;
  const auto make_layers = [&](TexelFormat texels) {
    return make_texture_array(texels, width, height, level.layers, "camera pyramid");
  };
  level.sums = make_layers(format.sums);
  if (is_single) {
    level.near = make_layers(format.sums);
    if (format.with_mean) level.mean = make_layers(format.sums);
  }
  for (int layer = 0; layer < level.layers; ++layer) {
    const auto make = [&](TexelFormat texels, int size) {
      return make_texture(texels, blocks_of(width, size), blocks_of(height, size),
                          "camera pyramid");
    };
    level.positions.push_back(make(TexelFormat::rgba32f, 1));
    level.depth.push_back(make(TexelFormat::depth32f, 1));
    level.represent.push_back(
        make_framebuffer({{&level.positions.back()}}, "camera pyramid", {&level.depth.back()}));
    level.tiles.push_back(make(TexelFormat::r32f, tile));
    level.tile.push_back(make_framebuffer({{&level.tiles.back()}}, "camera pyramid"));
    std::vector<Attachment> targets{{&level.sums, layer}};
    if (is_single) {
      targets.push_back({&level.near, layer});
      if (format.with_mean) targets.push_back({&level.mean, layer});
    }
    level.splat.push_back(make_framebuffer(targets, "splats", {&level.depth.back()}));
  }
  return level;
}

void represent(const ViewPyramid& pyramid, const ViewLevel& level, const SplatPrograms& programs,
               const GeometryBuffer& geometry, const SplatCamera& camera) {
  const bool is_full = level.block == 1;
  const Program& program = is_full ? programs.represent_pixels : programs.represent;
  const double texel = 2 * camera.frame.half_height / camera.frame.height * level.block;
  use(program);
  set_camera(program, camera);
  bind_texture(program, "positions", 0, geometry.positions);
  bind_texture(program, "normals", 1, geometry.normals);
  set_uniform(program, "apart", static_cast<float>(layer_distance * texel));
  if (!is_full) {
    std::size_t i = 0;
    for (int block = 2; block < level.block; block *= 2) ++i;
    bind_texture(program, "representatives", 2, pyramid.representatives[i]);
  }
  for (int layer = 0; layer < level.layers; ++layer) {
    bind(level.represent[static_cast<std::size_t>(layer)]);
    set_uniform(program, "layer", layer);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    glDepthMask(GL_TRUE);
    draw_triangle();
  }
  use(programs.tiles);
  for (std::size_t layer = 0; layer < level.tile.size(); ++layer) {
    bind(level.tile[layer]);
    bind_texture(programs.tiles, "depth", 0, level.depth[layer]);
    draw_screen();
  }
}

// The largest picture of a sphere of this radius around a point of the mesh, over the picture's
// height: at the nearest depth, at a corner of the view, where it is stretched most.
double largest_splat(const SplatCamera& camera, double radius) {
  const double depth = static_cast<double>(camera.near_mm);
  if (depth <= 1.1 * radius) return std::numeric_limits<double>::infinity();
  const double x = camera.frame.half_width, y = camera.frame.half_height;
  const double stretch = 1 + x * x + y * y;
  return 1.1 * stretch * radius / (std::sqrt(depth * depth - radius * radius) * y);
}

Program make_splat_program(SplatKind kind, bool on_software) {
  std::vector<std::string> defines{fmt::format("TILE {}", tile)};
  if (kind.is_single) defines.emplace_back("SINGLE");
  if (kind.with_mean) defines.emplace_back("MEAN");
  if (kind.is_bounded) defines.emplace_back("BOUNDED");
  if (kind.as_points) defines.emplace_back("POINTS");
  if (!on_software) defines.emplace_back("DISCARD");
  const std::string_view fragment = kind.is_bare ? "bare_fragment.glsl" : "splat_fragment.glsl";
  return make_program({"camera.glsl", "facing.glsl", "sources.glsl", "splat_vertex.glsl"},
                      {"camera.glsl", "facing.glsl", fragment}, defines);
}

// In the last level always, whose weight does not fall.
bool ends_within(const SplatInput& input, int level, double reach) {
  return level + 1 == input.radial.count ||
         std::ranges::any_of(input.reference.support_mm,
                             [&](float end) { return static_cast<double>(end) < reach; });
}

void bind_emitters(const Program& program, const Sources& sources, const SplatInput& input,
                   int level) {
  const SourceLevel& source = sources.levels[static_cast<std::size_t>(level)];
  set_uniform(program, "weight_place", std::vector<Vec4>{input.radial.weight_place(level)});
  bind_texture(program, "source_positions", 2, source.positions);
  bind_texture(program, "source_fit_0", 3, source.fit[0]);
  bind_texture(program, "source_fit_1", 4, source.fit[1]);
  bind_texture(program, "source_fit_2", 5, source.fit[2]);
  const auto& support = input.reference.support_mm;
  set_uniform(program, "support", Vec3{support[0], support[1], support[2]});
  if (level > 0) return;
  bind_texture(program, "source_fit_3", 6, source.fit[3]);
  bind_texture(program, "source_normals", 7, sources.normals);
  bind_texture(program, "source_flux", 8, sources.flux);
  const double near = input.near.near_mm, mean = input.near.mean_mm;
  set_uniform(program, "near_kernel", std::vector<Vec4>{input.near_kernel});
  set_uniform(program, "near_mm", static_cast<float>(near));
  set_uniform(program, "near_factor",
              Vec2{static_cast<float>(1 / (near * near)), static_cast<float>(1 / (mean * mean))});
  set_uniform(program, "area_mm2", static_cast<float>(sources.area_mm2));
}

}  // namespace

std::size_t ViewPyramid::bytes() const {
  std::size_t sum = 0;
  for (const Texture& texture : representatives) sum += byte_size(texture);
  for (const ViewLevel& level : levels) {
    for (const Texture* texture : {&level.sums, &level.near, &level.mean})
      if (texture->handle.get() != 0) sum += byte_size(*texture);
    for (const auto* textures : {&level.positions, &level.depth, &level.tiles})
      for (const Texture& texture : *textures) sum += byte_size(texture);
  }
  return sum;
}

double TexelSizes::wanted_mm(int level) const {
  return spacing_mm * (level == 0 ? samples : std::ldexp(groups, level));
}

ViewPyramid make_view_pyramid(const SplatCamera& camera, const RadialLevels& radial,
                              const TexelSizes& texels, SplatFormat format) {
  ViewPyramid pyramid;
  pyramid.width = camera.frame.width;
  pyramid.height = camera.frame.height;
  int largest = 1;
  for (int l = 0; l < radial.count; ++l) {
    const int block = choose_block(camera, texels.wanted_mm(l));
    largest = std::max(largest, block);
    pyramid.levels.push_back(make_view_level(
        blocks_of(pyramid.width, block), blocks_of(pyramid.height, block), block, l == 0, format));
  }
  for (int block = 2; block <= largest; block *= 2)
    pyramid.representatives.push_back(
        make_texture(TexelFormat::rgba16ui, blocks_of(pyramid.width, block),
                     blocks_of(pyramid.height, block), "camera pyramid"));
  return pyramid;
}

SplatPrograms make_splat_programs(bool on_software) {
  SplatPrograms programs;
  const std::vector<std::string_view> screen{"screen_vertex.glsl"};
  programs.reduce_first = make_program(screen, {"reduce_fragment.glsl"}, {"FIRST"});
  programs.reduce = make_program(screen, {"reduce_fragment.glsl"});
  programs.represent_pixels =
      make_program(screen, {"camera.glsl", "facing.glsl", "represent_fragment.glsl"}, {"FULL"});
  programs.represent =
      make_program(screen, {"camera.glsl", "facing.glsl", "represent_fragment.glsl"});
  programs.tiles = make_program(screen, {"tiles_fragment.glsl"}, {fmt::format("TILE {}", tile)});
  programs.on_software = on_software;
  programs.largest_point = largest_point_size();
  return programs;
}

const Program& get_splat_program(SplatPrograms& programs, SplatKind kind) {
  const std::size_t index = (kind.is_single ? 1u : 0u) + (kind.with_mean ? 2u : 0u) +
                            (kind.is_bounded ? 4u : 0u) + (kind.as_points ? 8u : 0u) +
                            (kind.is_bare ? 16u : 0u);
  Program& program = programs.splat[index];
  if (program.handle.get() == 0) program = make_splat_program(kind, programs.on_software);
  return program;
}

void draw_pyramid(const ViewPyramid& pyramid, const SplatPrograms& programs,
                  const GeometryBuffer& geometry, const SplatCamera& camera) {
  set_additive_blending(false);
  int block = 2;
  for (std::size_t i = 0; i < pyramid.representatives.size(); ++i, block *= 2) {
    const Program& program = i == 0 ? programs.reduce_first : programs.reduce;
    const Framebuffer target = make_framebuffer({{&pyramid.representatives[i]}}, "camera pyramid");
    bind(target);
    use(program);
    bind_texture(program, "positions", 0, geometry.positions);
    if (i > 0) bind_texture(program, "finer", 1, pyramid.representatives[i - 1]);
    set_uniform(program, "block", block);
    draw_screen();
  }
  for (const ViewLevel& level : pyramid.levels)
    represent(pyramid, level, programs, geometry, camera);
  check_gl("camera pyramid");
}

void set_level_nodes(const Program& program, const SplatInput& input, int first, int count) {
  std::vector<int> nodes;
  std::vector<Vec3> reference;
  for (int level = first; level < first + count; ++level)
    for (const int node : level_nodes(level)) {
      nodes.push_back(node);
      reference.push_back(
          eval_reference_node(input.reference, input.radial.nodes, static_cast<std::size_t>(node)));
    }
  set_uniform(program, "level_nodes", nodes);
  set_uniform(program, "reference_nodes", reference);
}

void splat_level(const ViewPyramid& pyramid, SplatPrograms& programs, const Sources& sources,
                 const SplatInput& input, const SplatCamera& camera, int level, bool is_bare) {
  const auto l = static_cast<std::size_t>(level);
  const ViewLevel& view = pyramid.levels[l];
  const SourceLevel& source = sources.levels[l];
  const int targets = level > 0 ? 1 : view.mean.handle.get() == 0 ? 2 : 3;
  const double reach = std::min(input.radial.last_mm(level), input.max_support_mm);
  const bool as_points = largest_splat(camera, reach) * view.sums.height <= programs.largest_point;
  const bool is_bounded = !is_bare && ends_within(input, level, reach);
  const Program& program =
      get_splat_program(programs, {level == 0, targets == 3, is_bounded, as_points, is_bare});
  use(program);
  set_camera(program, camera);
  set_uniform(program, "reach", static_cast<float>(reach));
  set_uniform(program, "level_size",
              Vec2{static_cast<float>(view.sums.width), static_cast<float>(view.sums.height)});
  bind_emitters(program, sources, input, level);
  for (int layer = 0; layer < view.layers; ++layer) {
    bind(view.splat[static_cast<std::size_t>(layer)]);
    for (int i = 0; i < targets; ++i) clear_color(i);
    bind_texture(program, "level_positions", 0, view.positions[static_cast<std::size_t>(layer)]);
    bind_texture(program, "tiles", 1, view.tiles[static_cast<std::size_t>(layer)]);
    set_additive_blending(true);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    as_points ? draw_points(source.count) : draw_squares(source.count);
  }
  set_additive_blending(false);
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  check_gl("splats");
}

}  // namespace parian

#include "gl/sources.h"

#include <fmt/format.h>

#include <cmath>

#include "base/check.h"

namespace parian {
namespace {

constexpr int line_width = 2048;  // the largest texture that every device has

int lines_of(std::size_t count) {
  return static_cast<int>((count + line_width - 1) / line_width);
}

// Four floats each, the last 1, padded to full lines.
std::vector<float> pack(std::size_t count, const auto& get) {
  std::vector<float> values(4 * line_width * static_cast<std::size_t>(lines_of(count)), 0.0f);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 value = get(i);
    values[4 * i] = value.x;
    values[4 * i + 1] = value.y;
    values[4 * i + 2] = value.z;
    values[4 * i + 3] = 1;
  }
  return values;
}

Texture make_line_texture(std::size_t count, int blocks, const char* what, const void* data) {
  return make_texture(TexelFormat::rgba32f, line_width, lines_of(count) * blocks, what, data);
}

void group_level(const Sources& sources, const SourceLevel& members, const SourceLevel& groups,
                 int level, const Program& sum, const Program& centre) {
  const bool is_single = level == 1;
  for (const bool positions : {false, true}) {
    const Program& program = positions ? centre : sum;
    const Framebuffer target =
        make_framebuffer({{positions ? &groups.positions : &groups.rows}}, "groups of samples");
    bind(target);
    use(program);
    set_uniform(program, "member_count", members.count);
    set_uniform(program, "member_lines", members.lines);
    set_uniform(program, "group_lines", groups.lines);
    set_uniform(program, "node", level_nodes(level)[2]);
    bind_texture(program, "member_rows", 0, members.rows);
    bind_texture(program, "member_positions", 1, members.positions);
    if (is_single) bind_texture(program, "member_flux", 2, sources.flux);
    draw_screen();
  }
}

}  // namespace

Sources make_sources(const std::vector<SurfacePoint>& samples, const std::vector<Vec2>& places,
                     double area_mm2, const RadialLevels& radial) {
  PARIAN_CHECK_EQ(samples.size(), places.size());
  Sources sources;
  sources.area_mm2 = area_mm2;
  const std::size_t count = samples.size();
  const auto position = pack(count, [&](std::size_t i) { return samples[i].position; });
  const int blocks = static_cast<int>(radial.nodes.size()) + 1;
  for (int l = 0; l < radial.count; ++l) {
    SourceLevel level;
    const std::size_t size = level_size(count, l);
    level.count = static_cast<int>(size);
    level.lines = lines_of(size);
    level.positions =
        make_line_texture(size, 1, "places of samples", l == 0 ? position.data() : nullptr);
    level.rows = make_line_texture(size, blocks, "profiles of samples", nullptr);
    for (int i = 0; i < (l == 0 ? 4 : 3); ++i)
      level.fit.push_back(make_line_texture(size, 1, "fits of samples", nullptr));
    sources.levels.push_back(std::move(level));
  }
  const auto place = pack(count, [&](std::size_t i) { return Vec3{places[i].x, places[i].y, 0}; });
  const auto normal = pack(count, [&](std::size_t i) { return samples[i].normal; });
  sources.normals = make_line_texture(count, 1, "normals of samples", normal.data());
  sources.places = make_line_texture(count, 1, "places of samples", place.data());
  sources.near = make_line_texture(count, 1, "near term of samples", nullptr);
  sources.flux = make_line_texture(count, 1, "flux of samples", nullptr);
  return sources;
}

Program make_rows_program(const MaterialTextures& material) {
  return make_program({"screen_vertex.glsl"}, {"material.glsl", "rows_fragment.glsl"},
                      material.defines);
}

void bake_profiles(Sources& sources, const Program& program, const MaterialTextures& material) {
  const SourceLevel& level = sources.levels.front();
  use(program);
  set_uniform(program, "row_lines", level.lines);
  bind_texture(program, "sample_places", 0, sources.places);
  bind_material(program, material, 1);
  set_additive_blending(false);
  for (const bool near : {false, true}) {
    const Framebuffer target =
        make_framebuffer({{near ? &sources.near : &level.rows}}, "profiles of samples");
    bind(target);
    set_uniform(program, "first_node", near ? static_cast<int>(material.nodes.size()) + 1 : 0);
    draw_screen();
  }
  check_gl("profiles of samples");
}

void set_flux(Sources& sources, const std::vector<Rgb>& flux) {
  PARIAN_CHECK_EQ(flux.size(), static_cast<std::size_t>(sources.levels.front().count));
  update_texture(sources.flux, pack(flux.size(), [&](std::size_t i) { return flux[i]; }).data());
}

SourcePrograms make_source_programs() {
  const auto make = [](std::string_view fragment, const std::vector<std::string>& defines) {
    return make_program({"screen_vertex.glsl"}, {"sources.glsl", fragment}, defines);
  };
  return {make("group_fragment.glsl", {"SINGLE"}), make("group_fragment.glsl", {}),
          make("centre_fragment.glsl", {"SINGLE"}), make("centre_fragment.glsl", {})};
}

void group_sources(Sources& sources, const SourcePrograms& programs) {
  set_additive_blending(false);
  for (std::size_t l = 1; l < sources.levels.size(); ++l)
    group_level(sources, sources.levels[l - 1], sources.levels[l], static_cast<int>(l),
                l == 1 ? programs.sum_samples : programs.sum_groups,
                l == 1 ? programs.centre_samples : programs.centre_groups);
  check_gl("groups of samples");
}

Rgb total_flux(const Sources& sources, int level) {
  const SourceLevel& source = sources.levels[static_cast<std::size_t>(level)];
  const Texture& texture = level == 0 ? sources.flux : source.rows;
  const std::vector<float> values = read_pixels(make_framebuffer({{&texture}}, "flux of sources"));
  const std::size_t lines = static_cast<std::size_t>(source.lines);
  const std::size_t first = values.size() - 4 * line_width * lines;  // the last node
  double sum[3] = {0, 0, 0};
  for (std::size_t i = 0; i < static_cast<std::size_t>(source.count); ++i)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(values[first + 4 * i + c]);
  return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

}  // namespace parian

// Every shader in every variant the renderers make, in both kinds of contexts; and nothing in them
// that a web page's WebGL 2 lacks.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gl/context.h"
#include "gl/objects.h"
#include "gl/shading.h"
#include "gl/sources.h"
#include "gl/splat_fit.h"
#include "gl/splat_levels.h"
#include "gl/splat_rate.h"

namespace parian {
namespace {

using Files = std::vector<std::string_view>;

// Materials: maps and blends of one or several pixels.
std::vector<std::vector<std::string>> material_variants() {
  std::vector<std::vector<std::string>> variants;
  for (const char* kind : {"", "BLEND 1", "BLEND 2", "BLEND 5"})
    for (const char* grid : {"", "UNIFORM", "GAIN"}) {
      variants.push_back({"NODES 15"});
      for (const char* define : {kind, grid})
        if (*define != '\0') variants.back().emplace_back(define);
    }
  return variants;
}

std::vector<std::string> with(std::vector<std::string> defines,
                              const std::vector<std::string>& more) {
  defines.insert(defines.end(), more.begin(), more.end());
  return defines;
}

// That it uses. WebGL 2 promises 16 texture units to a fragment shader.
int count_samplers(const Program& program) {
  GLint uniforms = 0;
  glGetProgramiv(program.handle.get(), GL_ACTIVE_UNIFORMS, &uniforms);
  int samplers = 0;
  for (GLuint i = 0; i < static_cast<GLuint>(uniforms); ++i) {
    GLint size = 0;
    GLenum type = 0;
    char name[64];
    glGetActiveUniform(program.handle.get(), i, sizeof(name), nullptr, &size, &type, name);
    for (const GLenum sampler : {GL_SAMPLER_2D, GL_SAMPLER_2D_ARRAY, GL_UNSIGNED_INT_SAMPLER_2D,
                                 GL_UNSIGNED_INT_SAMPLER_2D_ARRAY})
      samplers += type == sampler ? size : 0;
  }
  return samplers;
}

void compile_materials() {
  const Files screen{"screen_vertex.glsl"};
  for (const auto& variant : material_variants()) {
    EXPECT_NO_THROW((void)make_program(screen, {"material.glsl", "rows_fragment.glsl"}, variant));
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{}, {"SINGLE"}, {"SINGLE", "MEAN"}, {"SINGLE", "PIXELS 2"}})
      EXPECT_LE(
          count_samplers(make_program(
              screen, {"camera.glsl", "facing.glsl", "material.glsl", "resolve_fragment.glsl"},
              with(variant, more))),
          16);
  }
}

void compile_transport() {
  const Files screen{"screen_vertex.glsl"};
  for (const char* single : {"SINGLE 0", "SINGLE 1"})
    EXPECT_NO_THROW((void)make_program(screen, {"transport_fragment.glsl"}, {single, "LAYERS 15"}));
  EXPECT_NO_THROW(
      (void)make_program({"camera.glsl", "exitance_vertex.glsl"}, {"exitance_fragment.glsl"}));
}

void compile_splats() {
  for (const bool on_software : {false, true}) {
    SplatPrograms programs = make_splat_programs(on_software);
    for (unsigned i = 0; i < programs.splat.size(); ++i) {
      const auto has = [&](unsigned bit) { return (i >> bit & 1u) != 0; };
      EXPECT_NO_THROW((void)get_splat_program(programs, {has(0), has(1), has(2), has(3), has(4)}));
    }
    for (const Program& program : programs.splat) EXPECT_NE(program.handle.get(), 0u);
  }
}

TEST(Shaders, CompileInBothKindsOfContexts) {
  for (const ContextKind kind : {ContextKind::embedded, ContextKind::desktop}) {
    const OffscreenContext context(kind);
    compile_materials();
    compile_transport();
    compile_splats();
    EXPECT_NO_THROW((void)make_fit_programs());
    EXPECT_NO_THROW((void)make_source_programs());
    EXPECT_NO_THROW((void)make_shading_programs());
    EXPECT_NO_THROW((void)make_geometry_program());
    EXPECT_NO_THROW(
        (void)make_lamp_program({"fresnel.glsl", "lamp.glsl", "lamp_flux_fragment.glsl"}));
    EXPECT_NO_THROW((void)make_program({"shadow_vertex.glsl"}, {"shadow_fragment.glsl"}));
    EXPECT_GT(measure_splat_rate(64, 64, 10, 4).splats_per_s, 0);
    check_gl("all shaders");
  }
}

// Names of GLSL ES 3.10 and above, and of desktop GLSL.
TEST(Shaders, UseNothingBeyondGlslEs300) {
  for (const std::string_view name : shader_names())
    for (const char* word : {"imageLoad",
                             "imageStore",
                             "shared ",
                             "buffer ",
                             "atomic",
                             "textureGather",
                             "double",
                             "gl_Layer",
                             "gl_ViewportIndex",
                             "gl_ClipDistance",
                             "#extension",
                             "#version",
                             "sampler1D",
                             "samplerBuffer",
                             "image2D",
                             "layout(binding",
                             "bitCount",
                             "fma(",
                             "dvec",
                             "gl_FragColor",
                             "texture2D("})
      EXPECT_EQ(shader_source(name).find(word), std::string_view::npos) << name << ": " << word;
}

// Of numbers 0 and 1 instead, some drivers make a + t (b - a), which has lost b where a is large.
TEST(Shaders, MixByBooleansAndNotByNumbersMadeOfThem) {
  for (const std::string_view name : shader_names())
    for (const char* word : {", vec3(lessThan", ", vec3(greaterThan", ", vec3(equal"})
      EXPECT_EQ(shader_source(name).find(word), std::string_view::npos) << name << ": " << word;
}

// As many as WebGL 2 promises.
TEST(Shaders, KeepToTheUnitsThatEveryDeviceHas) {
  const auto count = [](const Files& files) {
    std::size_t units = 0;
    for (const std::string_view file : files) {
      const std::string_view text = shader_source(file);
      for (std::size_t at = text.find("uniform "); at != std::string_view::npos;
           at = text.find("uniform ", at + 1))
        units += text.substr(at, 24).find("sampler") != std::string_view::npos ? 1 : 0;
    }
    return units;
  };
  // Sums over all branches of #ifdef: more than any variant has.
  EXPECT_LE(count({"fresnel.glsl", "reflector.glsl", "sky.glsl", "self_occlusion.glsl",
                   "sky_reflection_fragment.glsl"}),
            16u);
  EXPECT_LE(count({"splat_vertex.glsl"}) + count({"splat_fragment.glsl"}), 16u);
  EXPECT_LE(count({"fresnel.glsl", "reflector.glsl", "lamp.glsl", "lamp_reflection_fragment.glsl"}),
            16u);
}

}  // namespace
}  // namespace parian

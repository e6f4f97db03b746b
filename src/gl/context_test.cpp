#include "gl/context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "gl/objects.h"

namespace parian {
namespace {

TEST(OffscreenContext, IsThereAndCanDoWhatTheRendererNeeds) {
  const OffscreenContext context;
  EXPECT_FALSE(context.limits().renderer.empty());
  EXPECT_GE(context.limits().max_texture_size, 2048);
  EXPECT_GE(context.limits().max_array_layers, 256);
  EXPECT_GE(context.limits().max_draw_buffers, 4);
}

TEST(OffscreenContext, AnotherOneAfterItsEnd) {
  { const OffscreenContext first; }
  const OffscreenContext second;
  EXPECT_NO_THROW(check_gl("a new context"));
}

std::string message_of(const GlFeatures& features) {
  GlLimits limits;
  limits.renderer = "a device";
  limits.version = "its version";
  try {
    check_features(features, limits);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::resource);
    return error.what();
  }
  return {};
}

TEST(Features, WhatIsMissingIsNamed) {
  EXPECT_EQ(message_of({false, 30, true}), "");
  EXPECT_EQ(message_of({true, 33, false}), "");  // part of the version
  EXPECT_EQ(message_of({false, 20, true}),
            "OpenGL: expected OpenGL ES 3.0 or OpenGL 3.3, found 'its version'");
  EXPECT_EQ(message_of({true, 32, true}),
            "OpenGL: expected OpenGL ES 3.0 or OpenGL 3.3, found 'its version'");
  EXPECT_EQ(message_of({false, 30, false}),
            "OpenGL: expected the extension EXT_color_buffer_float, found 'a device' without");
}

TEST(OffscreenContext, OfBothKindsOneAfterTheOther) {
  for (const ContextKind kind : {ContextKind::desktop, ContextKind::embedded}) {
    const OffscreenContext context(kind);
    const bool is_embedded = context.limits().version.find("OpenGL ES") != std::string::npos;
    EXPECT_EQ(is_embedded, kind == ContextKind::embedded) << context.limits().version;
    EXPECT_NO_THROW(check_gl("a new context"));
  }
}

TEST(Texture, KeepsFloatsAndTheOrderOfRows) {
  const OffscreenContext context;
  std::vector<float> values(4 * 5 * 3);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) * 1.2345678f;
  const Texture texture = make_texture(TexelFormat::rgba32f, 5, 3, "test", values.data());
  EXPECT_EQ(read_pixels(make_framebuffer({{&texture}}, "test")), values);
  EXPECT_EQ(byte_size(texture), 4u * 4 * 5 * 3);
}

TEST(Texture, TooLargeNamesItselfAndTheLimit) {
  const OffscreenContext context;
  const int most = context.limits().max_texture_size;
  try {
    (void)make_texture(TexelFormat::r32f, most + 1, 1, "the test's texture");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::resource);
    EXPECT_EQ(std::string(error.what()),
              "the test's texture: expected at most " + std::to_string(most) +
                  " texels or layers, the graphics driver's limit, found " +
                  std::to_string(most + 1));
  }
}

TEST(Program, AShaderThatDoesNotCompileIsNamedWithTheLog) {
  const OffscreenContext context;
  try {  // without the camera's functions
    (void)make_program({"surface_vertex.glsl"}, {"fresnel.glsl"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("surface_vertex.glsl: expected a shader that"));
    EXPECT_THAT(error.what(), testing::HasSubstr("project"));
  }
}

TEST(Program, UnknownShaderIsAnError) {
  EXPECT_THROW((void)shader_source("no.glsl"), Error);
  EXPECT_GT(shader_names().size(), 5u);
}

TEST(CheckGl, LostDevicesAndFullOnesAreNamed) {
  const Error lost = make_gl_error(0x0507, "splats");  // GL_CONTEXT_LOST
  EXPECT_EQ(lost.kind, ErrorKind::resource);
  EXPECT_STREQ(lost.what(),
               "splats: expected a graphics device, found none: it was lost or reset; start again");
  const Error full = make_gl_error(0x0505, "picture");  // GL_OUT_OF_MEMORY
  EXPECT_EQ(full.kind, ErrorKind::resource);
  EXPECT_STREQ(full.what(),
               "picture: expected memory of the graphics device (a smaller picture needs less), "
               "found none left");
  const Error wrong = make_gl_error(0x0502, "picture");  // GL_INVALID_OPERATION
  EXPECT_EQ(wrong.kind, ErrorKind::contract);
  EXPECT_STREQ(wrong.what(), "picture: expected no OpenGL error, found 0x502");
}

TEST(CheckGl, WhatOpenGlRecordedIsThrownOnce) {
  const OffscreenContext context;
  const Framebuffer none;
  bind(none);
  clear_color(100);  // of a target that is not there
  try {
    check_gl("the test");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::contract);
  }
  EXPECT_NO_THROW(check_gl("the test"));
}

}  // namespace
}  // namespace parian

#include "gl/objects.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/check.h"
#include "base/error.h"

namespace parian {
namespace {

struct FormatParts {
  GLint internal;
  GLenum format;
  GLenum type;
  std::size_t bytes;  // of a texel
};

FormatParts parts_of(TexelFormat format) {
  switch (format) {
    case TexelFormat::r32f:
      return {GL_R32F, GL_RED, GL_FLOAT, 4};
    case TexelFormat::rg32f:
      return {GL_RG32F, GL_RG, GL_FLOAT, 8};
    case TexelFormat::rgb32f:
      return {GL_RGB32F, GL_RGB, GL_FLOAT, 12};
    case TexelFormat::rgba32f:
      return {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16};
    case TexelFormat::rgba16f:
      return {GL_RGBA16F, GL_RGBA, GL_FLOAT, 8};
    case TexelFormat::rgba16f_halves:
      return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8};
    case TexelFormat::r16ui:
      return {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2};
    case TexelFormat::rgba16ui:
      return {GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, 8};
    case TexelFormat::depth32f:
      return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4};
  }
  return {};
}

GLenum target_of(const Texture& texture) {
  return texture.layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
}

void check_limit(int value, GLenum limit, const std::string& what) {
  GLint most = 0;
  glGetIntegerv(limit, &most);
  if (value > most)
    throw Error({{},
                 what,
                 fmt::format("at most {} texels or layers, the graphics driver's limit", most),
                 fmt::format("{}", value)},
                ErrorKind::resource);
}

Texture create_texture(Texture texture, const std::string& what, const void* data) {
  PARIAN_CHECK(texture.width > 0 && texture.height > 0);
  check_limit(std::max(texture.width, texture.height), GL_MAX_TEXTURE_SIZE, what);
  if (texture.layers > 0) check_limit(texture.layers, GL_MAX_ARRAY_TEXTURE_LAYERS, what);
  GLuint name = 0;
  glGenTextures(1, &name);
  texture.handle = GlHandle<destroy_texture>(name);
  const GLenum target = target_of(texture);
  const FormatParts parts = parts_of(texture.format);
  glBindTexture(target, name);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  if (texture.layers > 0)
    glTexImage3D(target, 0, parts.internal, texture.width, texture.height, texture.layers, 0,
                 parts.format, parts.type, data);
  else
    glTexImage2D(target, 0, parts.internal, texture.width, texture.height, 0, parts.format,
                 parts.type, data);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(target, filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(target, wrap, GL_CLAMP_TO_EDGE);
  check_gl(what.c_str());
  return texture;
}

std::string get_log(GLuint name, bool is_program) {
  GLint length = 0;
  is_program ? glGetProgramiv(name, GL_INFO_LOG_LENGTH, &length)
             : glGetShaderiv(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(1, length)), '\0');
  is_program ? glGetProgramInfoLog(name, length, nullptr, log.data())
             : glGetShaderInfoLog(name, length, nullptr, log.data());
  return log.c_str();
}

[[noreturn]] void fail_shader(const std::string& name, const std::string& log) {
  throw Error({name, {}, "a shader that compiles", log}, ErrorKind::contract);
}

GLuint compile(GLenum kind, const std::vector<std::string_view>& files,
               const std::vector<std::string>& defines) {
  std::string source = epoxy_is_desktop_gl() ? "#version 330\n" : "#version 300 es\n";
  source +=
      "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
      "precision highp sampler2DArray;\nprecision highp usampler2D;\n"
      "precision highp usampler2DArray;\n";
  for (const std::string& define : defines) source += fmt::format("#define {}\n", define);
  for (const std::string_view file : files)
    source += fmt::format("#line 1\n{}", shader_source(file));
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled != 0) return shader;
  const std::string log = get_log(shader, false);
  glDeleteShader(shader);
  fail_shader(std::string(files.back()), log);
}

GLint locate(const Program& program, const char* name) {
  return glGetUniformLocation(program.handle.get(), name);
}

GlHandle<destroy_vertex_array> bind_no_vertices() {
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  glBindVertexArray(name);
  return GlHandle<destroy_vertex_array>(name);
}

}  // namespace

void destroy_texture(std::uint32_t name) {
  glDeleteTextures(1, &name);
}
void destroy_buffer(std::uint32_t name) {
  glDeleteBuffers(1, &name);
}
void destroy_vertex_array(std::uint32_t name) {
  glDeleteVertexArrays(1, &name);
}
void destroy_framebuffer(std::uint32_t name) {
  glDeleteFramebuffers(1, &name);
}
void destroy_program(std::uint32_t name) {
  glDeleteProgram(name);
}

Texture make_texture(TexelFormat format, int width, int height, const std::string& what,
                     const void* data) {
  return create_texture({{}, format, width, height, 0}, what, data);
}

Texture make_texture_array(TexelFormat format, int width, int height, int layers,
                           const std::string& what, const void* data) {
  return create_texture({{}, format, width, height, layers}, what, data);
}

Texture make_picture_texture(const Image& image, const std::string& what) {
  std::vector<float> values;
  values.reserve(image.values.size() / 3 * 4);
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    values.push_back(std::min(image.values[i], 65504.0f));
    if (i % 3 == 2) values.push_back(1);
  }
  Texture texture =
      make_texture(TexelFormat::rgba16f, image.width, image.height, what, values.data());
  glBindTexture(GL_TEXTURE_2D, texture.handle.get());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glGenerateMipmap(GL_TEXTURE_2D);
  check_gl(what.c_str());
  return texture;
}

void update_texture(const Texture& texture, const void* data) {
  const GLenum target = target_of(texture);
  const FormatParts parts = parts_of(texture.format);
  glBindTexture(target, texture.handle.get());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (texture.layers > 0)
    glTexSubImage3D(target, 0, 0, 0, 0, texture.width, texture.height, texture.layers, parts.format,
                    parts.type, data);
  else
    glTexSubImage2D(target, 0, 0, 0, texture.width, texture.height, parts.format, parts.type, data);
}

std::size_t byte_size(const Texture& texture) {
  return parts_of(texture.format).bytes * static_cast<std::size_t>(texture.width) *
         static_cast<std::size_t>(texture.height) *
         static_cast<std::size_t>(std::max(1, texture.layers));
}

Framebuffer make_framebuffer(const std::vector<Attachment>& colors, const std::string& what,
                             Attachment depth) {
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  Framebuffer framebuffer;
  framebuffer.handle = GlHandle<destroy_framebuffer>(name);
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  const auto attach = [&](GLenum point, const Texture& texture, int layer) {
    framebuffer.width = texture.width;
    framebuffer.height = texture.height;
    if (texture.layers > 0)
      glFramebufferTextureLayer(GL_FRAMEBUFFER, point, texture.handle.get(), 0, layer);
    else
      glFramebufferTexture2D(GL_FRAMEBUFFER, point, GL_TEXTURE_2D, texture.handle.get(), 0);
  };
  std::vector<GLenum> buffers;
  for (const Attachment& color : colors) {
    buffers.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(buffers.size()));
    attach(buffers.back(), *color.texture, color.layer);
  }
  if (depth.texture != nullptr) attach(GL_DEPTH_ATTACHMENT, *depth.texture, depth.layer);
  if (buffers.empty()) buffers.push_back(GL_NONE);
  glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error({{},
                 what,
                 "a target that the graphics driver can draw to",
                 fmt::format("status {:#x}", status)},
                ErrorKind::resource);
  return framebuffer;
}

void bind(const Framebuffer& framebuffer) {
  // What a window's own drawing may have left.
  for (const GLenum test : {GL_SCISSOR_TEST, GL_CULL_FACE, GL_STENCIL_TEST}) glDisable(test);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.handle.get());
  glViewport(0, 0, framebuffer.width, framebuffer.height);
}

void clear_color(int target, std::array<float, 4> value) {
  glClearBufferfv(GL_COLOR, target, value.data());
}

void clear_depth(float value) {
  glDepthMask(GL_TRUE);
  glClearBufferfv(GL_DEPTH, 0, &value);
}

std::vector<float> read_pixels(const Framebuffer& framebuffer, int target) {
  std::vector<float> values(4 * static_cast<std::size_t>(framebuffer.width) *
                            static_cast<std::size_t>(framebuffer.height));
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.handle.get());
  glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(target));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, framebuffer.width, framebuffer.height, GL_RGBA, GL_FLOAT, values.data());
  check_gl("reading pixels");
  return values;
}

Program make_program(const std::vector<std::string_view>& vertex,
                     const std::vector<std::string_view>& fragment,
                     const std::vector<std::string>& defines) {
  Program program;
  program.name = fragment.back();
  const GLuint name = glCreateProgram();
  program.handle = GlHandle<destroy_program>(name);
  for (const auto& [kind, files] :
       {std::pair{GL_VERTEX_SHADER, &vertex}, std::pair{GL_FRAGMENT_SHADER, &fragment}}) {
    const GLuint shader = compile(static_cast<GLenum>(kind), *files, defines);
    glAttachShader(name, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(name);
  GLint linked = 0;
  glGetProgramiv(name, GL_LINK_STATUS, &linked);
  if (linked == 0) fail_shader(program.name, get_log(name, true));
  return program;
}

void use(const Program& program) {
  glUseProgram(program.handle.get());
}

void set_uniform(const Program& program, const char* name, int value) {
  glUniform1i(locate(program, name), value);
}
void set_uniform(const Program& program, const char* name, float value) {
  glUniform1f(locate(program, name), value);
}
void set_uniform(const Program& program, const char* name, Vec2 value) {
  glUniform2f(locate(program, name), value.x, value.y);
}
void set_uniform(const Program& program, const char* name, Vec3 value) {
  glUniform3f(locate(program, name), value.x, value.y, value.z);
}
void set_uniform(const Program& program, const char* name, std::array<int, 2> value) {
  glUniform2i(locate(program, name), value[0], value[1]);
}
void set_uniform(const Program& program, const char* name, const std::vector<Vec3>& values) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  glUniform3fv(locate(program, name), static_cast<GLsizei>(values.size()), &values[0].x);
}
void set_uniform(const Program& program, const char* name, const std::vector<float>& values) {
  glUniform1fv(locate(program, name), static_cast<GLsizei>(values.size()), values.data());
}
void set_uniform(const Program& program, const char* name, const std::vector<int>& values) {
  glUniform1iv(locate(program, name), static_cast<GLsizei>(values.size()), values.data());
}

void set_uniform(const Program& program, const char* name, const std::vector<Mat4>& values) {
  glUniformMatrix4fv(locate(program, name), static_cast<GLsizei>(values.size()), GL_FALSE,
                     values[0].data());
}
void set_uniform(const Program& program, const char* name, const std::vector<Vec2>& values) {
  glUniform2fv(locate(program, name), static_cast<GLsizei>(values.size()), &values[0].x);
}
void set_uniform(const Program& program, const char* name, const std::vector<Vec4>& values) {
  glUniform4fv(locate(program, name), static_cast<GLsizei>(values.size()), values[0].data());
}

void bind_texture(const Program& program, const char* name, int unit, const Texture& texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target_of(texture), texture.handle.get());
  glUniform1i(locate(program, name), unit);
}

// A core profile draws nothing without a vertex array, and one belongs to its context.
void draw_triangle() {
  const GlHandle<destroy_vertex_array> none = bind_no_vertices();
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void draw_squares(int count) {
  const GlHandle<destroy_vertex_array> none = bind_no_vertices();
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
}

void draw_points(int count) {
  const GlHandle<destroy_vertex_array> none = bind_no_vertices();
  if (epoxy_is_desktop_gl()) glEnable(GL_PROGRAM_POINT_SIZE);
  glDrawArrays(GL_POINTS, 0, count);
}

float largest_point_size() {
  // Mesa's softpipe numbers a draw's points anew after some thousand.
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  if (renderer != nullptr && std::string_view(renderer) == "softpipe") return 0;
  std::array<float, 2> range{};
  glGetFloatv(GL_ALIASED_POINT_SIZE_RANGE, range.data());
  return range[1];
}

void draw_screen() {
  glDisable(GL_DEPTH_TEST);
  draw_triangle();
}

void draw_screen_on_surface() {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  draw_triangle();
  glDepthMask(GL_TRUE);
  glDisable(GL_DEPTH_TEST);
}

void set_additive_blending(bool enabled) {
  enabled ? glEnable(GL_BLEND) : glDisable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ONE);
}

Error make_gl_error(std::uint32_t error, const char* where) {
  if (error == GL_CONTEXT_LOST)
    return Error({{}, where, "a graphics device", "none: it was lost or reset; start again"},
                 ErrorKind::resource);
  if (error == GL_OUT_OF_MEMORY)
    return Error(
        {{}, where, "memory of the graphics device (a smaller picture needs less)", "none left"},
        ErrorKind::resource);
  return Error({{}, where, "no OpenGL error", fmt::format("{:#x}", error)}, ErrorKind::contract);
}

void check_gl(const char* where) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR) throw make_gl_error(error, where);
}

void finish_gl() {
  glFinish();
}

}  // namespace parian

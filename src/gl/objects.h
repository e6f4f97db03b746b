// OpenGL objects as values: made by functions, freed with their owner. All need a current context,
// the one they were made in. Shaders see textures with row 0 on top, as images have it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "image/image.h"
#include "math/vec.h"

namespace parian {

// A name that OpenGL gave out; move-only.
template <void (*Destroy)(std::uint32_t)>
class GlHandle {
 public:
  GlHandle() = default;
  explicit GlHandle(std::uint32_t name) : name_(name) {}
  ~GlHandle() {
    if (name_ != 0) Destroy(name_);
  }
  GlHandle(GlHandle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  std::uint32_t get() const { return name_; }

 private:
  std::uint32_t name_ = 0;
};
void destroy_texture(std::uint32_t name);
void destroy_buffer(std::uint32_t name);
void destroy_vertex_array(std::uint32_t name);
void destroy_framebuffer(std::uint32_t name);
void destroy_program(std::uint32_t name);

// `rgba16f` takes 32-bit floats, `rgba16f_halves` the bits of 16-bit ones.
enum class TexelFormat {
  r32f,
  rg32f,
  rgb32f,
  rgba32f,
  rgba16f,
  rgba16f_halves,
  r16ui,
  rgba16ui,
  depth32f
};

// Fetched texel by texel unless said otherwise: nearest, clamped to the edge.
struct Texture {
  GlHandle<destroy_texture> handle;
  TexelFormat format = TexelFormat::rgba32f;
  int width = 0;
  int height = 0;
  int layers = 0;  // 0: a plain one, no array
};
// `data` is [layer][y][x][channel] (float or uint16_t by the format), or null: undefined. `what`
// names it in errors. Throws Error(resource) when it is larger than the context allows.
Texture make_texture(TexelFormat format, int width, int height, const std::string& what,
                     const void* data = nullptr);
Texture make_texture_array(TexelFormat format, int width, int height, int layers,
                           const std::string& what, const void* data = nullptr);
// With all coarser resolutions, linear between texels, wrapped around in x: a picture of an
// environment, which shaders look up at any size of footprint. Radiance above 65,504 is cut.
Texture make_picture_texture(const Image& image, const std::string& what);
// All of it again, of the same size.
void update_texture(const Texture& texture, const void* data);
std::size_t byte_size(const Texture& texture);

// A texture, or one layer of an array, that is drawn to.
struct Attachment {
  const Texture* texture = nullptr;
  int layer = 0;
};
// Where drawing goes: colour targets in order, and depth if there is one.
struct Framebuffer {
  GlHandle<destroy_framebuffer> handle;
  int width = 0;
  int height = 0;
};
// Throws Error(resource) where the driver finds it incomplete.
Framebuffer make_framebuffer(const std::vector<Attachment>& colors, const std::string& what,
                             Attachment depth = {});
// All of it becomes the viewport.
void bind(const Framebuffer& framebuffer);
void clear_color(int target, std::array<float, 4> value = {});
void clear_depth(float value);
// Four floats a pixel, row 0 first.
std::vector<float> read_pixels(const Framebuffer& framebuffer, int target = 0);

struct Program {
  GlHandle<destroy_program> handle;
  std::string name;
};
// From files of shaders/, joined behind the version, precision and `defines` (one per line without
// '#define'). Throws Error(contract) with the driver's log.
Program make_program(const std::vector<std::string_view>& vertex,
                     const std::vector<std::string_view>& fragment,
                     const std::vector<std::string>& defines = {});
void use(const Program& program);
// Of the program in use; names that a variant has no use for are ignored.
void set_uniform(const Program& program, const char* name, int value);
void set_uniform(const Program& program, const char* name, float value);
void set_uniform(const Program& program, const char* name, Vec2 value);
void set_uniform(const Program& program, const char* name, Vec3 value);
void set_uniform(const Program& program, const char* name, std::array<int, 2> value);
void set_uniform(const Program& program, const char* name, const std::vector<Vec3>& values);
void set_uniform(const Program& program, const char* name, const std::vector<float>& values);
void set_uniform(const Program& program, const char* name, const std::vector<int>& values);
// Column by column.
using Mat4 = std::array<float, 16>;
void set_uniform(const Program& program, const char* name, const std::vector<Mat4>& values);
void set_uniform(const Program& program, const char* name, const std::vector<Vec2>& values);
using Vec4 = std::array<float, 4>;
void set_uniform(const Program& program, const char* name, const std::vector<Vec4>& values);
void bind_texture(const Program& program, const char* name, int unit, const Texture& texture);

// One triangle over the whole target (shaders/screen_vertex.glsl).
void draw_screen();
// Where the target's depth is nearer than the far plane: on what has been drawn.
void draw_screen_on_surface();
// The same, with the depth test as it is.
void draw_triangle();
// Four corners in a strip, `count` times.
void draw_squares(int count);
// `count` points of the size that the vertex shader says; at most largest_point_size() pixels.
void draw_points(int count);
float largest_point_size();
void set_additive_blending(bool enabled);

// Throws Error naming `where` when OpenGL has recorded an error: contract, or resource where memory
// ran out or the device was lost.
void check_gl(const char* where);
// What that throws for an OpenGL error number.
Error make_gl_error(std::uint32_t error, const char* where);
// Waits until everything is drawn: for timing.
void finish_gl();

// The text of shaders/NAME; throws Error(contract) for others.
std::string_view shader_source(std::string_view name);
const std::vector<std::string_view>& shader_names();

}  // namespace parian

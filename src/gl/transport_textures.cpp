#include "gl/transport_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"

namespace parian {
namespace {

constexpr int row_length = 1024;
// Of the 224 vectors that OpenGL ES 3.0 promises a fragment shader.
constexpr int max_layers = 200;

int count_layers(const PackedTransport& packed) {
  const std::size_t values = packed.functions * packed.components;
  return 3 * static_cast<int>((values + 11) / 12);
}

// [layer][place][4] of [block][function][component][lane].
std::vector<std::uint16_t> order_by_layers(const PackedTransport& packed, std::size_t texels) {
  const auto layers = static_cast<std::size_t>(count_layers(packed));
  const std::size_t values = packed.functions * packed.components;
  std::vector<std::uint16_t> ordered(4 * layers * texels, 0);
  parallel_for_blocks(packed.places, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::size_t block = p / transport_lanes, lane = p % transport_lanes;
      for (std::size_t k = 0; k < values; ++k)
        ordered[4 * ((k / 4) * texels + p) + k % 4] =
            packed.half[(block * values + k) * transport_lanes + lane];
    }
  });
  return ordered;
}

PlacedTransport place_transport(const TransportTextures& textures, const PackedTransport& packed,
                                const char* what) {
  PlacedTransport placed;
  if (packed.functions == 0) return placed;
  PARIAN_CHECK_EQ(packed.places, textures.places);
  placed.layers = count_layers(packed);
  if (placed.layers > max_layers)
    throw Error({{},
                 what,
                 fmt::format("at most {} values per place for the graphics device", 4 * max_layers),
                 fmt::format("{}", packed.functions * packed.components)},
                ErrorKind::resource);
  placed.scale = packed.scale;
  const std::size_t texels =
      static_cast<std::size_t>(textures.width) * static_cast<std::size_t>(textures.height);
  placed.values = make_texture_array(TexelFormat::rgba16f_halves, textures.width, textures.height,
                                     placed.layers, what, order_by_layers(packed, texels).data());
  return placed;
}

Texture make_place_texture(const TransportTextures& textures, const std::vector<Vec3>& values,
                           const char* what) {
  std::vector<Vec3> padded(
      static_cast<std::size_t>(textures.width) * static_cast<std::size_t>(textures.height),
      Vec3{0, 0, 1});
  std::copy(values.begin(), values.end(), padded.begin());
  return make_texture(TexelFormat::rgb32f, textures.width, textures.height, what, padded.data());
}

// [value of a place / 4][4]: each value's coefficient, with the scale of its halves.
std::vector<Vec4> make_weights(const PlacedTransport& placed, const std::vector<float>& coefficient,
                               Rgb scale, std::size_t components) {
  std::vector<Vec4> weights(static_cast<std::size_t>(placed.layers), Vec4{});
  const float channel_scale[3] = {scale.x, scale.y, scale.z};
  for (std::size_t k = 0; k < placed.scale.size() * components; ++k) {
    const std::size_t function = k / components, channel = k % 3;
    weights[k / 4][k % 4] = std::numbers::pi_v<float> * placed.scale[function] *
                            coefficient[3 * function + channel] * channel_scale[channel];
  }
  return weights;
}

Program make_transport_program(const std::vector<PlacedTransport>& lights, bool is_single) {
  const auto found = std::find_if(lights.begin(), lights.end(),
                                  [](const PlacedTransport& light) { return light.layers > 0; });
  if (found == lights.end()) return {};
  return make_program(
      {"screen_vertex.glsl"}, {"transport_fragment.glsl"},
      {fmt::format("LAYERS {}", found->layers), fmt::format("SINGLE {}", is_single ? 1 : 0)});
}

}  // namespace

std::size_t TransportTextures::bytes() const {
  std::size_t sum = byte_size(exitance);
  for (const Texture* texture : {&positions, &normals})
    if (texture->handle.get() != 0) sum += byte_size(*texture);
  for (const auto* lights : {&multiple, &single})
    for (const PlacedTransport& light : *lights)
      if (light.layers > 0) sum += byte_size(light.values);
  return sum;
}

TransportTextures make_radiance_textures(std::size_t places, TexelFormat sums) {
  TransportTextures textures;
  textures.places = places;
  textures.width = row_length;
  textures.height = std::max(1, static_cast<int>((places + row_length - 1) / row_length));
  textures.exitance = make_texture(sums, textures.width, textures.height, "radiance of vertices");
  textures.exitance_target = make_framebuffer({{&textures.exitance}}, "radiance of vertices");
  return textures;
}

TransportTextures make_transport_textures(const std::vector<Vec3>& positions,
                                          const std::vector<Vec3>& normals,
                                          const HomogeneousTransport& transport, TexelFormat sums) {
  PARIAN_CHECK_EQ(positions.size(), transport.places);
  PARIAN_CHECK_EQ(normals.size(), transport.places);
  TransportTextures textures = make_radiance_textures(transport.places, sums);
  textures.positions = make_place_texture(textures, positions, "positions of vertices");
  textures.normals = make_place_texture(textures, normals, "normals of vertices");
  textures.multiple.resize(transport.lights.size());
  textures.single.resize(transport.lights.size());
  for (std::size_t i = 0; i < transport.lights.size(); ++i)
    update_light(textures, i, transport.lights[i]);
  return textures;
}

void update_light(TransportTextures& textures, std::size_t index, const LightTransport& light) {
  textures.multiple[index] =
      place_transport(textures, light.multiple, "transport of multiple scattering");
  textures.single[index] =
      place_transport(textures, light.single, "transport of single scattering");
}

TransportPrograms make_transport_programs(const TransportTextures& textures) {
  TransportPrograms programs;
  programs.multiple = make_transport_program(textures.multiple, false);
  programs.single = make_transport_program(textures.single, true);
  programs.surface =
      make_program({"camera.glsl", "exitance_vertex.glsl"}, {"exitance_fragment.glsl"});
  return programs;
}

void eval_transport(const TransportTextures& textures, const TransportPrograms& programs,
                    const TransportCoefficients& coefficients, const std::vector<Rgb>& scale,
                    Vec3 eye, double eta) {
  PARIAN_CHECK_EQ(scale.size(), textures.multiple.size());
  bind(textures.exitance_target);
  clear_color(0);
  set_additive_blending(true);
  for (std::size_t i = 0; i < scale.size(); ++i) {
    const PlacedTransport &multiple = textures.multiple[i], &single = textures.single[i];
    if (multiple.layers > 0) {
      use(programs.multiple);
      bind_texture(programs.multiple, "transport", 0, multiple.values);
      set_uniform(programs.multiple, "weights",
                  make_weights(multiple, coefficients.multiple, scale[i], 3));
      draw_screen();
    }
    if (single.layers > 0 && !coefficients.single.empty()) {
      use(programs.single);
      bind_texture(programs.single, "transport", 0, single.values);
      bind_texture(programs.single, "positions", 1, textures.positions);
      bind_texture(programs.single, "normals", 2, textures.normals);
      set_uniform(programs.single, "eye", eye);
      set_uniform(programs.single, "eta", static_cast<float>(eta));
      set_uniform(programs.single, "three_g",
                  Vec3{coefficients.three_g[0], coefficients.three_g[1], coefficients.three_g[2]});
      set_uniform(programs.single, "weights",
                  make_weights(single, coefficients.single, scale[i], 12));
      draw_screen();
    }
  }
  set_additive_blending(false);
  check_gl("radiance of vertices");
}

void put_radiance(const TransportTextures& textures, const std::vector<Rgb>& radiance) {
  PARIAN_CHECK_EQ(radiance.size(), textures.places);
  std::vector<Vec4> values(static_cast<std::size_t>(textures.width) *
                           static_cast<std::size_t>(textures.height));
  parallel_for_blocks(radiance.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Rgb exitance = radiance[i] * std::numbers::pi_v<float>;
      values[i] = {exitance.x, exitance.y, exitance.z, 1};
    }
  });
  update_texture(textures.exitance, values.data());
  check_gl("radiance of vertices");
}

std::vector<Rgb> read_radiance(const TransportTextures& textures) {
  const std::vector<float> values = read_pixels(textures.exitance_target);
  std::vector<Rgb> radiance(textures.places);
  for (std::size_t i = 0; i < radiance.size(); ++i)
    radiance[i] =
        Rgb{values[4 * i], values[4 * i + 1], values[4 * i + 2]} * std::numbers::inv_pi_v<float>;
  return radiance;
}

}  // namespace parian

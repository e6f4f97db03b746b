// Precomputed transport of a homogeneous material on the device (homogeneous editing 2007, section
// 6.2): half floats in textures, from which one pass over the places makes their radiance.
#pragma once

#include <vector>

#include "gl/objects.h"
#include "transport/homogeneous_transport.h"

namespace parian {

// Places lie row by row in all textures; values are [layer][place][4], value 4 layer + i of a place
// being [function][component] of PackedTransport.
struct PlacedTransport {
  int layers = 0;  // a multiple of 3: 12 values, 4 colours; 0: left out
  Texture values;
  std::vector<float> scale;  // [function]
};

struct TransportTextures {
  int width = 1, height = 1;  // of all
  std::size_t places = 0;
  std::size_t single_functions = 0;
  Texture positions, normals;
  std::vector<PlacedTransport> multiple, single;  // of each light
  Texture exitance;                               // pi times radiance, less F_t
  Framebuffer exitance_target;

  std::size_t bytes() const;
};
// `sums` is the format of radiance. Throws Error(resource) where a texture or the number of
// functions exceeds what the device allows.
TransportTextures make_transport_textures(const std::vector<Vec3>& positions,
                                          const std::vector<Vec3>& normals,
                                          const HomogeneousTransport& transport, TexelFormat sums);
// Of radiance alone, which put_radiance() brings.
TransportTextures make_radiance_textures(std::size_t places, TexelFormat sums);
// One light of it again, with as many functions.
void update_light(TransportTextures& textures, std::size_t index, const LightTransport& light);

struct TransportPrograms {
  Program multiple, single, surface;
};
TransportPrograms make_transport_programs(const TransportTextures& textures);

// Eq. 9 and 14 at all places, without F_t; `scale` is each light's.
void eval_transport(const TransportTextures& textures, const TransportPrograms& programs,
                    const TransportCoefficients& coefficients, const std::vector<Rgb>& scale,
                    Vec3 eye, double eta);
// The result of the same on the CPU (transport/homogeneous_transport.h).
void put_radiance(const TransportTextures& textures, const std::vector<Rgb>& radiance);
// Radiance of all places, less F_t.
std::vector<Rgb> read_radiance(const TransportTextures& textures);

}  // namespace parian

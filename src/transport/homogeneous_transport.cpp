#include "transport/homogeneous_transport.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/parallel.h"
#include "material/diffusion.h"
#include "transport/half.h"
#include "transport/irradiance.h"
#include "transport/transport_kernels.h"

namespace parian {
namespace {

constexpr std::size_t lanes = transport_lanes;
constexpr double inverse_pi = std::numbers::inv_pi;
constexpr double greatest_half = 65504;
// Eddington's phase function is negative beyond (Xu et al., section 4; see algorithms).
constexpr double greatest_g = 1.0 / 3;

std::size_t block_count(std::size_t places) {
  return (places + lanes - 1) / lanes;
}

std::size_t half_index(const PackedTransport& packed, std::size_t place, std::size_t function,
                       std::size_t component) {
  return ((place / lanes * packed.functions + function) * packed.components + component) * lanes +
         place % lanes;
}

// Coefficients times the scales of the functions and the colour of a light.
AlignedVector<float> scale_coefficients(const std::vector<float>& coefficients,
                                        const PackedTransport& packed, Rgb scale) {
  if (packed.functions == 0) return {};
  PARIAN_CHECK_EQ(coefficients.size(), 3 * packed.functions);
  const float colour[3] = {scale.x, scale.y, scale.z};
  AlignedVector<float> scaled(coefficients.size());
  for (std::size_t i = 0; i < scaled.size(); ++i)
    scaled[i] = coefficients[i] * packed.scale[i / 3] * colour[i % 3];
  return scaled;
}

}  // namespace

PackedTransport pack_transport(const std::vector<float>& value, std::size_t functions,
                               std::size_t components) {
  const std::size_t row = functions * components;
  PARIAN_CHECK(row > 0 && value.size() % row == 0);
  PackedTransport packed{.places = value.size() / row,
                         .functions = functions,
                         .components = components,
                         .scale = std::vector<float>(functions, 1.0f),
                         .half = {}};
  std::vector<float> largest(functions, 0.0f);
  for (std::size_t i = 0; i < value.size(); ++i) {
    float& most = largest[i % row / components];
    most = std::max(most, std::abs(value[i]));
  }
  for (std::size_t j = 0; j < functions; ++j)  // a power of two: scaling rounds nothing
    if (largest[j] > 0)
      packed.scale[j] =
          std::exp2(std::ceil(std::log2(largest[j] / static_cast<float>(greatest_half))));
  packed.half.assign(block_count(packed.places) * lanes * row, 0);
  parallel_for_blocks(packed.places, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t place = begin; place < end; ++place)
      for (std::size_t i = 0; i < row; ++i)
        packed.half[half_index(packed, place, i / components, i % components)] =
            float_to_half(value[place * row + i] / packed.scale[i / components]);
  });
  return packed;
}

float unpack(const PackedTransport& packed, std::size_t place, std::size_t function,
             std::size_t component) {
  return half_to_float(packed.half[half_index(packed, place, function, component)]) *
         packed.scale[function];
}

TransportProjection::TransportProjection(const HomogeneousTransport& transport)
    : multiple_(make_reflectance_projection(transport.multiple_basis, transport.knots)),
      single_(make_attenuation_projection(transport.single_basis, transport.knots)),
      multiple_size_(transport.multiple_basis.size()),
      single_size_(transport.single_basis.size()) {}

TransportCoefficients TransportProjection::fit(const Dipole& material) const {
  PARIAN_CHECK(material.channels.size() == 1 || material.channels.size() == 3);
  TransportCoefficients coefficients;
  coefficients.multiple.resize(3 * multiple_size_);
  coefficients.single.resize(3 * single_size_);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t channel = material.channels.size() == 1 ? 0 : c;
    const DipoleCoefficients& medium = material.channels[channel];
    const ReflectanceCurve curve = make_reflectance_curve(material, channel);
    set_reflectance(coefficients, c, [&](double r) { return eval_curve(curve, r); });
    if (!material.single_scattering) continue;
    const double sigma_s = sigma_s_of(medium), sigma_t = sigma_s + medium.sigma_a;
    set_attenuation(coefficients, c, sigma_s, medium.g, [&, sigma_t](double s) {
      return eval_gain(material.attenuation_gain, s) * std::exp(-sigma_t * s);
    });
  }
  return coefficients;
}

void TransportProjection::set_reflectance(TransportCoefficients& coefficients, std::size_t channel,
                                          const std::function<double(double)>& R_d) const {
  const std::vector<double> c = multiple_.fit(R_d);
  for (std::size_t j = 0; j < c.size(); ++j)
    coefficients.multiple[3 * j + channel] = static_cast<float>(c[j] * inverse_pi);
}

void TransportProjection::set_attenuation(TransportCoefficients& coefficients, std::size_t channel,
                                          double sigma_s, double g,
                                          const std::function<double(double)>& E) const {
  const std::vector<double> e = single_.fit(E);
  for (std::size_t j = 0; j < e.size(); ++j)
    coefficients.single[3 * j + channel] = static_cast<float>(e[j] * sigma_s * inverse_pi / 4);
  coefficients.three_g[channel] = static_cast<float>(3 * std::clamp(g, -greatest_g, greatest_g));
}

TransportView make_transport_view(const std::vector<Vec3>& positions,
                                  const std::vector<Vec3>& normals, Vec3 eye, double eta,
                                  bool has_fresnel) {
  PARIAN_CHECK_EQ(positions.size(), normals.size());
  TransportView view;
  view.value.assign(block_count(positions.size()) * 4 * lanes, 0.0f);
  const auto index = static_cast<float>(eta);
  parallel_for_blocks(positions.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float* at = &view.value[i / lanes * 4 * lanes + i % lanes];
      const Vec3 n = normals[i], w = normalize(eye - positions[i]);
      const float cosine = std::max(dot(n, w), 0.0f);
      // Snell: the part along the surface shrinks by eta.
      const Vec3 along = (w - n * dot(n, w)) * (1 / index);
      const Vec3 refracted = along + n * std::sqrt(std::max(1 - dot(along, along), 0.0f));
      at[0] = has_fresnel ? fresnel_transmission(index, cosine) : 1.0f;
      at[lanes] = refracted.x;
      at[2 * lanes] = refracted.y;
      at[3 * lanes] = refracted.z;
    }
  });
  return view;
}

void eval_transport(const HomogeneousTransport& transport,
                    const TransportCoefficients& coefficients, const std::vector<Rgb>& scale,
                    const TransportView& view, std::vector<Rgb>& radiance) {
  PARIAN_CHECK_EQ(scale.size(), transport.lights.size());
  const std::size_t blocks = block_count(transport.places);
  PARIAN_CHECK_EQ(view.value.size(), blocks * 4 * lanes);
  std::vector<AlignedVector<float>> multiple, single;
  for (std::size_t i = 0; i < scale.size(); ++i) {
    const LightTransport& light = transport.lights[i];
    multiple.push_back(scale_coefficients(coefficients.multiple, light.multiple, scale[i]));
    single.push_back(scale_coefficients(coefficients.single, light.single, scale[i]));
  }
  radiance.resize(transport.places);
  constexpr std::size_t chunk = 64;  // blocks
  parallel_for_blocks(blocks, chunk, [&](std::size_t begin, std::size_t end) {
    alignas(64) float sums[chunk * 3 * lanes] = {}, values[chunk * 3 * lanes];
    const float* seen = &view.value[begin * 4 * lanes];
    for (std::size_t i = 0; i < scale.size(); ++i) {
      const PackedTransport &T = transport.lights[i].multiple, &S = transport.lights[i].single;
      if (T.functions > 0)
        add_multiple(&T.half[begin * T.functions * 3 * lanes], end - begin, T.functions,
                     multiple[i].data(), sums);
      if (S.functions > 0)
        add_single(&S.half[begin * S.functions * 12 * lanes], end - begin, S.functions,
                   single[i].data(), coefficients.three_g.data(), seen, sums);
    }
    finish_radiance(sums, seen, end - begin, values);
    const std::size_t first = begin * lanes,
                      count = std::min(end * lanes, transport.places) - first;
    for (std::size_t i = 0; i < count; ++i)
      radiance[first + i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  });
}

std::size_t transport_bytes(const HomogeneousTransport& transport) {
  std::size_t bytes = 0;
  for (const LightTransport& light : transport.lights)
    bytes += 2 * (light.multiple.half.size() + light.single.half.size());
  return bytes;
}

}  // namespace parian

#include "gl/material_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "math/fast_math.h"
#include "transport/near_term.h"

namespace parian {
namespace {

// Where radii lie between the knots: the same for all pixels.
struct KnotPlace {
  std::size_t knot = 0;
  float part = 0;
};
KnotPlace find_place(const std::vector<float>& knots, float r) {
  auto k =
      static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), r) - knots.begin());
  k = std::clamp<std::size_t>(k, 1, knots.size() - 1) - 1;
  return {k, (r - knots[k]) / (knots[k + 1] - knots[k])};
}
// h of one channel, linear between knots and beyond them.
float interpolate(KnotPlace place, const float* half_log) {
  const float* from = half_log + 3 * place.knot;
  return from[0] + place.part * (from[3] - from[0]);
}

// I = int P w dA and int (P w)^2 dA over a plane, w the near term's weight: midpoints in r^2, for
// profiles that end at `end_mm` or beyond the near term.
struct NearRule {
  static constexpr std::size_t steps = 64;
  std::array<KnotPlace, steps> place;
  std::array<float, steps> weight{};
  double ring_mm2 = 0;
};
NearRule make_near_rule(const std::vector<float>& knots, double end_mm, double near_mm) {
  NearRule rule;
  const double end = std::min(near_mm, end_mm);
  rule.ring_mm2 = std::numbers::pi * end * end / static_cast<double>(NearRule::steps);
  for (std::size_t i = 0; i < NearRule::steps; ++i) {
    const double r =
        end * std::sqrt((static_cast<double>(i) + 0.5) / static_cast<double>(NearRule::steps));
    rule.place[i] = find_place(knots, static_cast<float>(r));
    rule.weight[i] = static_cast<float>(near_weight(r, near_mm));
  }
  return rule;
}

struct NearValues {
  double integral = 0, square = 0;
};
NearValues integrate_near(const NearRule& rule, const float* half_log) {
  std::array<float, NearRule::steps> log_p, p;
  for (std::size_t i = 0; i < p.size(); ++i) log_p[i] = 2 * interpolate(rule.place[i], half_log);
  exp_array(log_p.data(), p.data(), p.size());
  NearValues values;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto value = static_cast<double>(p[i] * rule.weight[i]);
    values.integral += rule.ring_mm2 * value;
    values.square += rule.ring_mm2 * value * value;
  }
  return values;
}

// Counts of samples are cut here.
constexpr float most_samples = 1e6f;

// Rows of the field at all pixels, turned into the planes that the textures hold.
struct Planes {
  std::vector<float> support, half_log, integral, count;  // the logarithm of the integral
};

// What turning them takes; no nodes: the rows are not wanted.
struct PlaneRules {
  std::vector<KnotPlace> nodes;
  NearRule near;  // of profiles that reach beyond the near term
  double near_mm = 0, area_mm2 = 0;
};

void fill_pixel(const ProfileField& field, const PlaneRules& rules, int x, int y,
                std::vector<float>& row, Planes& planes) {
  const std::size_t pixels =
      static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height);
  const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width) +
                            static_cast<std::size_t>(x);
  std::array<float, 3> support{};
  field.eval(x, y, row.data(), support.data());
  if (support[0] <= 0) {
    std::fill_n(&planes.count[3 * pixel], 3, most_samples);
    std::fill_n(&planes.integral[3 * pixel], 3, std::log(1e-30f));
    return;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    planes.support[3 * pixel + c] = support[c];
    const auto end = static_cast<double>(support[c]);
    const NearValues near = integrate_near(
        end >= rules.near_mm ? rules.near : make_near_rule(field.knots_mm, end, rules.near_mm),
        &row[c]);
    planes.integral[3 * pixel + c] = static_cast<float>(std::log(std::max(near.integral, 1e-30)));
    planes.count[3 * pixel + c] = static_cast<float>(
        std::min(static_cast<double>(most_samples),
                 near.integral * near.integral / std::max(1e-300, rules.area_mm2 * near.square)));
    for (std::size_t j = 0; j < rules.nodes.size(); ++j)
      planes.half_log[3 * (j * pixels + pixel) + c] = interpolate(rules.nodes[j], &row[c]);
  }
}

Planes make_planes(const ProfileField& field, const std::vector<float>& nodes, double area_mm2,
                   double near_mm, bool with_rows) {
  const std::size_t pixels =
      static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height);
  Planes planes;
  planes.support.resize(3 * pixels);
  planes.integral.resize(3 * pixels);
  planes.count.resize(3 * pixels);
  PlaneRules rules{{}, make_near_rule(field.knots_mm, near_mm, near_mm), near_mm, area_mm2};
  if (with_rows)
    for (const float node : nodes) rules.nodes.push_back(find_place(field.knots_mm, node));
  planes.half_log.resize(3 * pixels * rules.nodes.size());
  parallel_for(static_cast<std::size_t>(field.height), [&](std::size_t y) {
    std::vector<float> row(field.row());
    for (int x = 0; x < field.width; ++x)
      fill_pixel(field, rules, x, static_cast<int>(y), row, planes);
  });
  return planes;
}

// Of samples, for their sum to be trusted alone (transport/near_term.h).
constexpr float enough = 8;
// Profiles that have fallen by this much count no further.
constexpr float deepest = 6;

ReferenceProfile make_reference(const ProfileField& field) {
  ReferenceProfile reference;
  reference.knots_mm = field.knots_mm;
  reference.half_log.resize(field.knots());
  const int step = std::max(1, std::max(field.width, field.height) / 48);
  std::vector<float> row(field.row());
  std::array<float, 3> support{};
  float count = 0;
  for (int y = 0; y < field.height; y += step)
    for (int x = 0; x < field.width; x += step, ++count) {
      field.eval(x, y, row.data(), support.data());
      for (std::size_t k = 0; k < field.knots(); ++k)
        reference.half_log[k] +=
            {std::max(row[3 * k], row[0] - deepest), std::max(row[3 * k + 1], row[1] - deepest),
             std::max(row[3 * k + 2], row[2] - deepest)};
    }
  for (Vec3& value : reference.half_log) value = value / count;
  return reference;
}

// h of the bases at the nodes; then value and slope at the last knot, from which tails go on.
std::vector<float> make_base_rows(const ProfileBlend& blend, const std::vector<float>& nodes) {
  const std::size_t width = nodes.size() + 2, last = blend.knots_mm.size() - 1;
  std::vector<float> rows(3 * width * blend.bases());
  for (std::size_t base = 0; base < blend.bases(); ++base)
    for (std::size_t c = 0; c < 3; ++c) {
      const float* values =
          base_profile(blend, base, std::min(static_cast<int>(c), blend.channels - 1));
      const Profile profile{blend.knots_mm, {values, values + last + 1}, HUGE_VAL};
      float* row = &rows[3 * width * base + c];
      for (std::size_t j = 0; j < nodes.size(); ++j)
        row[3 * j] =
            static_cast<float>(0.5 * eval_log_profile(profile, static_cast<double>(nodes[j])));
      row[3 * nodes.size()] = static_cast<float>(0.5 * profile.log_value[last]);
      row[3 * nodes.size() + 3] =
          static_cast<float>(0.5 * (profile.log_value[last] - profile.log_value[last - 1]) /
                             (blend.knots_mm[last] - blend.knots_mm[last - 1]));
    }
  return rows;
}

void add_blend(const ProfileBlend& blend, MaterialTextures& textures) {
  const std::size_t pixels = blend.pixels(), per_pixel = static_cast<std::size_t>(blend.per_pixel);
  textures.defines.push_back(fmt::format("BLEND {}", blend.per_pixel));
  textures.end_mm = blend.knots_mm.back();
  textures.least_slope = -0.5 * min_tail_decay / blend.knots_mm.back();
  textures.base = make_texture(TexelFormat::rgb32f, static_cast<int>(textures.nodes.size()) + 2,
                               static_cast<int>(blend.bases()), "base profiles",
                               make_base_rows(blend, textures.nodes).data());
  std::vector<float> weight(per_pixel * pixels), of_pixel(per_pixel), gain;
  if (!blend.gain.empty()) gain.resize(3 * pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    get_weights(blend, pixel, of_pixel.data());
    for (std::size_t k = 0; k < per_pixel; ++k) weight[k * pixels + pixel] = of_pixel[k];
    if (gain.empty()) continue;
    for (std::size_t c = 0; c < 3; ++c)
      gain[3 * pixel + c] =
          0.5f *
          std::log(blend.gain[std::min(c, static_cast<std::size_t>(blend.channels) - 1) * pixels +
                              pixel]);
  }
  textures.index = make_texture_array(TexelFormat::r16ui, blend.width, blend.height,
                                      blend.per_pixel, "blend indices", blend.index.data());
  textures.weight = make_texture_array(TexelFormat::r32f, blend.width, blend.height,
                                       blend.per_pixel, "blend weights", weight.data());
  if (gain.empty()) return;
  textures.defines.emplace_back("GAIN");
  textures.gain =
      make_texture(TexelFormat::rgb32f, blend.width, blend.height, "blend gain", gain.data());
}

}  // namespace

Vec3 eval_reference(const ReferenceProfile& reference, double r_mm) {
  const float* values = &reference.half_log[0].x;
  const KnotPlace place = find_place(reference.knots_mm, static_cast<float>(r_mm));
  return {interpolate(place, values), interpolate(place, values + 1),
          interpolate(place, values + 2)};
}

std::array<double, 3> eval_reference_kernel(const ReferenceProfile& reference, double r_mm) {
  const Vec3 h = eval_reference(reference, r_mm);
  std::array<double, 3> kernel{};
  for (std::size_t c = 0; c < 3; ++c)
    if (r_mm < static_cast<double>(reference.support_mm[c]))
      kernel[c] = std::exp(2 * static_cast<double>(component(h, static_cast<int>(c))));
  return kernel;
}

Vec3 eval_reference_node(const ReferenceProfile& reference, const std::vector<float>& nodes,
                         std::size_t index) {
  const float before = nodes[index == 0 ? 0 : index - 1];
  const float step = std::max(nodes[index] - before, 1e-6f);
  const auto cut = [&](float support) {
    if (support <= before) return -20.0f;
    const float f = std::clamp((support - before) / step, 0.05f, 1.0f);
    return -(1 - f) * (1 + 1.15f * f) / f;
  };
  const auto& support = reference.support_mm;
  return eval_reference(reference, static_cast<double>(nodes[index])) +
         Vec3{cut(support[0]), cut(support[1]), cut(support[2])};
}

std::size_t MaterialTextures::bytes() const {
  std::size_t sum = 0;
  for (const Texture* texture :
       {&support, &half_log, &base, &index, &weight, &gain, &near_integral, &near_count})
    if (texture->handle.get() != 0) sum += byte_size(*texture);
  return sum;
}

MaterialTextures make_material_textures(const ProfileBlend* blend, const ProfileField& field,
                                        const RadialLevels& levels, double area_mm2,
                                        double near_mm) {
  MaterialTextures textures;
  textures.width = field.width;
  textures.height = field.height;
  textures.pixel_pitch_mm = field.pixel_pitch_mm;
  textures.boundary = field.boundary;
  textures.eta = field.eta;
  textures.nodes = levels.nodes;
  textures.reference = make_reference(field);
  textures.defines.push_back(fmt::format("NODES {}", levels.nodes.size()));
  if (field.width == 1 && field.height == 1) textures.defines.emplace_back("UNIFORM");
  if (blend != nullptr && !blend->dilation.empty()) blend = nullptr;
  const Planes planes =
      make_planes(field, levels.nodes, area_mm2, near_mm, /*with_rows=*/blend == nullptr);
  const auto plane = [&](const std::vector<float>& values, const char* what) {
    return make_texture(TexelFormat::rgb32f, field.width, field.height, what, values.data());
  };
  textures.support = plane(planes.support, "supports of the profiles");
  textures.near_integral = plane(planes.integral, "near term");
  textures.near_count = plane(planes.count, "near term");
  for (std::size_t i = 0; i < planes.support.size(); ++i) {
    float& longest = textures.reference.support_mm[i % 3];
    longest = std::max(longest, planes.support[i]);
  }
  textures.is_sparse = *std::min_element(planes.count.begin(), planes.count.end()) < enough;
  if (blend != nullptr)
    add_blend(*blend, textures);
  else
    textures.half_log = make_texture_array(TexelFormat::rgb32f, field.width, field.height,
                                           static_cast<int>(levels.nodes.size()),
                                           "profiles of the material", planes.half_log.data());
  return textures;
}

int bind_material(const Program& program, const MaterialTextures& material, int unit) {
  set_uniform(program, "node_r", material.nodes);
  bind_texture(program, "material_support", unit++, material.support);
  bind_texture(program, "near_integral", unit++, material.near_integral);
  bind_texture(program, "near_count", unit++, material.near_count);
  if (material.half_log.handle.get() != 0) {
    bind_texture(program, "half_log_rows", unit++, material.half_log);
    return unit;
  }
  set_uniform(program, "blend_end", static_cast<float>(material.end_mm));
  set_uniform(program, "blend_slope", static_cast<float>(material.least_slope));
  bind_texture(program, "base_rows", unit++, material.base);
  bind_texture(program, "blend_index", unit++, material.index);
  bind_texture(program, "blend_weight", unit++, material.weight);
  if (material.gain.handle.get() != 0) bind_texture(program, "blend_gain", unit++, material.gain);
  return unit;
}

}  // namespace parian

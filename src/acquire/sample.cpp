#include "acquire/sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "acquire/noise.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr int max_side = 8192;
constexpr double max_pixels = 1 << 26;
constexpr double max_radius_px = 512;
constexpr double max_coefficient = 1000;  // 1/mm
constexpr double min_scattering = 1e-6;   // 1/mm
constexpr std::size_t max_materials = 16;

struct BaseMaterial {
  std::string name;
  std::array<DipoleCoefficients, 3> channels;
  std::optional<double> eta;  // of measured materials
};

// Continuous noise on the coefficients: factors e^{s n - s^2/2} of mean 1.
struct Variation {
  double relative = 0;
  double length_mm = 2;
  int octaves = 3;
};
ParamList describe(Variation& variation) {
  return {{.name = "relative",
           .help = "relative standard deviation",
           .target = &variation.relative,
           .min = 0,
           .max = 1},
          {.name = "length-mm",
           .help = "correlation length",
           .target = &variation.length_mm,
           .min = 1e-4,
           .max = 1000},
          {.name = "octaves",
           .help = "octaves of noise",
           .target = &variation.octaves,
           .min = 1,
           .max = 8}};
}

// A number for all channels, or one per channel.
std::array<double, 3> read_channels(const Document& node, int channels, double min) {
  std::array<double, 3> values{};
  if (std::holds_alternative<double>(node.value)) {
    values.fill(as_number(node, min, max_coefficient));
    return values;
  }
  const Document::Array& elements = as_array(node);
  if (elements.size() != static_cast<std::size_t>(channels))
    throw_at(node, channels == 1 ? "a number or an array of 1" : "a number or an array of 3");
  for (std::size_t c = 0; c < elements.size(); ++c)
    values[c] = as_number(elements[c], min, max_coefficient);
  return values;
}

BaseMaterial read_measured(const Document& node, int channels) {
  const NamedMaterial* named = nullptr;
  try {
    named = &find_named_material(as_string(node));
  } catch (const Error& error) {
    if (error.parts.place != "material") throw;
    throw_at(node, error.parts.expected, error.parts.found);
  }
  BaseMaterial material{.name = {}, .channels = named->channels, .eta = named->eta};
  if (channels == 1) material.channels.fill(named->channels[1]);  // green
  for (const DipoleCoefficients& medium : material.channels)
    if (medium.sigma_s_prime < min_scattering)
      throw_at(node, "a material that scatters in every channel",
               fmt::format("'{}', of which a channel has none measured", named->name));
  return material;
}

BaseMaterial read_material(const Document& node, int channels) {
  check_keys(node, {"name", "material", "sigma_a", "sigma_s_prime", "scale"});
  BaseMaterial material;
  if (const Document* measured = find(node, "material")) {
    for (const char* key : {"sigma_a", "sigma_s_prime"})
      if (const Document* own = find(node, key))
        throw_at(*own, "either 'material' or 'sigma_a' and 'sigma_s_prime'", "both");
    material = read_measured(*measured, channels);
  } else {
    const auto sigma_a = read_channels(get(node, "sigma_a"), channels, 0);
    const auto sigma_s_prime = read_channels(get(node, "sigma_s_prime"), channels, min_scattering);
    for (std::size_t c = 0; c < 3; ++c)
      material.channels[c] = {.sigma_a = sigma_a[c], .sigma_s_prime = sigma_s_prime[c]};
  }
  material.name = as_string(get(node, "name"));
  if (material.name.empty()) throw_at(get(node, "name"), "a name");
  if (const Document* scale = find(node, "scale")) {
    const double factor = as_number(*scale, 1e-3, 1e3);
    for (DipoleCoefficients& medium : material.channels) {
      medium.sigma_a *= factor;
      medium.sigma_s_prime *= factor;
    }
  }
  return material;
}

std::vector<BaseMaterial> read_materials(const Document& node, int channels) {
  const Document::Array& elements = as_array(node);
  if (elements.empty() || elements.size() > max_materials)
    throw_at(node, fmt::format("1 to {} materials", max_materials));
  std::vector<BaseMaterial> materials;
  for (const Document& element : elements) {
    materials.push_back(read_material(element, channels));
    for (std::size_t i = 0; i + 1 < materials.size(); ++i)
      if (materials[i].name == materials.back().name)
        throw_at(get(element, "name"), "a name of its own",
                 fmt::format("'{}' again", materials[i].name));
  }
  return materials;
}

// The description's, or the one on which its measured materials agree, or 1.3.
double read_eta(const Document& document, const std::vector<BaseMaterial>& materials) {
  if (const Document* eta = find(document, "eta")) return as_number(*eta, 1, 2.5);
  std::optional<double> common;
  for (const BaseMaterial& material : materials) {
    if (!material.eta) continue;
    if (common && *common != *material.eta)
      throw_at(document, "the key 'eta', since its measured materials differ in it",
               fmt::format("{} and {}", *common, *material.eta));
    common = material.eta;
  }
  return common.value_or(1.3);
}

void read_grid(const Document& document, Sample& sample) {
  sample.pixel_pitch_mm = as_number(get(document, "pitch_mm"), 1e-4, 100);
  const Document& size = get(document, "size");
  if (as_array(size).size() != 2) throw_at(size, "[width, height]");
  sample.width = as_int(as_array(size)[0], 1, max_side);
  sample.height = as_int(as_array(size)[1], 1, max_side);
  if (static_cast<double>(sample.width) * sample.height > max_pixels)
    throw_at(size, fmt::format("at most {} pixels", max_pixels),
             fmt::format("{} x {}", sample.width, sample.height));
  const Document* in_px = find(document, "radius_px");
  const Document* in_mm = find(document, "radius_mm");
  if ((in_px == nullptr) == (in_mm == nullptr))
    throw_at(document, "one of the keys 'radius_px' and 'radius_mm'",
             in_px == nullptr ? "neither" : "both");
  sample.radius_px =
      in_px != nullptr ? as_number(*in_px) : as_number(*in_mm) / sample.pixel_pitch_mm;
  const double most = std::min(max_radius_px, std::max(sample.width, sample.height) - 1.0);
  if (!(sample.radius_px >= 1 && sample.radius_px <= most))
    throw_at(in_px != nullptr ? *in_px : *in_mm,
             fmt::format("a radius of 1 to {} pixels (that of the sample, at most {})", most,
                         max_radius_px),
             fmt::format("{} pixels", sample.radius_px));
}

// sigma(x) = sum_m w_m(x) sigma_m
void mix(const std::vector<BaseMaterial>& materials, const std::vector<float>& weights,
         Sample& sample) {
  const std::size_t pixels = sample.pixels();
  for (std::size_t c = 0; c < static_cast<std::size_t>(sample.channels); ++c)
    for (std::size_t i = 0; i < pixels; ++i) {
      double sigma_a = 0, sigma_s_prime = 0;
      for (std::size_t m = 0; m < materials.size(); ++m) {
        sigma_a += weights[m * pixels + i] * materials[m].channels[c].sigma_a;
        sigma_s_prime += weights[m * pixels + i] * materials[m].channels[c].sigma_s_prime;
      }
      sample.sigma_a[c * pixels + i] = static_cast<float>(sigma_a);
      sample.sigma_s_prime[c * pixels + i] = static_cast<float>(sigma_s_prime);
    }
}

// One field for sigma_a and one for sigma_s_prime, the same for all channels: hues stay.
void vary(const Variation& variation, Sample& sample) {
  const double s = std::sqrt(std::log1p(variation.relative * variation.relative));
  const auto width = static_cast<std::size_t>(sample.width);
  const double scale = sample.pixel_pitch_mm / variation.length_mm;
  parallel_for(static_cast<std::size_t>(sample.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x)
      for (std::uint64_t field = 0; field < 2; ++field) {
        const double noise = eval_fractal_noise(
            hash_u64(sample.seed, 1000 + field), (static_cast<double>(x) + 0.5) * scale,
            (static_cast<double>(y) + 0.5) * scale, variation.octaves);
        const auto factor = static_cast<float>(std::exp(s * noise - s * s / 2));
        std::vector<float>& planes = field == 0 ? sample.sigma_a : sample.sigma_s_prime;
        for (std::size_t c = 0; c < static_cast<std::size_t>(sample.channels); ++c)
          planes[c * sample.pixels() + y * width + x] *= factor;
      }
  });
}

std::uint64_t read_seed(const Document& document, std::int64_t seed) {
  double number = 1;
  if (const Document* node = find(document, "seed")) {
    number = as_number(*node, 0, 0x1.0p53);
    if (number != std::floor(number)) throw_at(*node, "a whole number");
  }
  return seed >= 0 ? static_cast<std::uint64_t>(seed) : static_cast<std::uint64_t>(number);
}

}  // namespace

Sample read_sample(const Document& document, const ImageLoader& load_image, std::int64_t seed) {
  check_keys(document, {"$schema", "name", "description", "materials", "layout", "pitch_mm", "size",
                        "radius_px", "radius_mm", "channels", "eta", "seed", "variation"});
  Sample sample;
  sample.name = as_string(get(document, "name"));
  if (const Document* text = find(document, "description")) as_string(*text);
  if (const Document* channels = find(document, "channels")) {
    sample.channels = as_int(*channels, 1, 3);
    if (sample.channels == 2) throw_at(*channels, "1 or 3 channels");
  }
  read_grid(document, sample);
  const auto materials = read_materials(get(document, "materials"), sample.channels);
  sample.eta = read_eta(document, materials);
  sample.seed = read_seed(document, seed);
  const int count = static_cast<int>(materials.size());
  const Layout layout = read_layout(get(document, "layout"), count, load_image);
  Variation variation;
  if (const Document* node = find(document, "variation")) read_params(*node, describe(variation));

  const auto channels = static_cast<std::size_t>(sample.channels);
  sample.sigma_a.resize(channels * sample.pixels());
  sample.sigma_s_prime.resize(channels * sample.pixels());
  mix(materials,
      make_weights(layout,
                   {sample.width, sample.height, sample.pixel_pitch_mm, count, sample.seed}),
      sample);
  if (variation.relative > 0) vary(variation, sample);
  sample.description = document;
  set(sample.description, "seed", static_cast<double>(sample.seed));
  return sample;
}

}  // namespace parian

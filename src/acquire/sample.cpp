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
#include "material/bssrdf_table.h"

namespace parian {
namespace {

constexpr int max_side = 8192;
constexpr double max_pixels = 1 << 26;
constexpr double max_radius_px = 512;
constexpr double max_coefficient = 1000;  // 1/mm
constexpr double min_scattering = 1e-6;   // 1/mm
constexpr std::size_t max_materials = 16;
constexpr double max_anisotropy = 0.99;

ParamList describe(SampleVariation& variation) {
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
std::array<double, 3> read_channels(const Document& node, int channels, double min,
                                    double max = max_coefficient) {
  std::array<double, 3> values{};
  if (std::holds_alternative<double>(node.value)) {
    values.fill(as_number(node, min, max));
    return values;
  }
  const Document::Array& elements = as_array(node);
  if (elements.size() != static_cast<std::size_t>(channels))
    throw_at(node, channels == 1 ? "a number or an array of 1" : "a number or an array of 3");
  for (std::size_t c = 0; c < elements.size(); ++c) values[c] = as_number(elements[c], min, max);
  return values;
}

SampleMaterial read_measured(const Document& node, int channels) {
  const NamedMaterial* named = nullptr;
  try {
    named = &find_named_material(as_string(node));
  } catch (const Error& error) {
    if (error.parts.place != "material") throw;
    throw_at(node, error.parts.expected, error.parts.found);
  }
  SampleMaterial material{.name = {}, .channels = named->channels, .eta = named->eta};
  if (channels == 1) material.channels.fill(named->channels[1]);  // green
  for (const DipoleCoefficients& medium : material.channels)
    if (medium.sigma_s_prime < min_scattering)
      throw_at(node, "a material that scatters in every channel",
               fmt::format("'{}', of which a channel has none measured", named->name));
  return material;
}

SampleMaterial read_material(const Document& node, int channels) {
  check_keys(node, {"name", "material", "sigma_a", "sigma_s_prime", "g", "scale"});
  SampleMaterial material;
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
  if (const Document* g = find(node, "g")) {
    const auto values = read_channels(*g, channels, -max_anisotropy, max_anisotropy);
    for (std::size_t c = 0; c < 3; ++c) material.channels[c].g = values[c];
  }
  if (const Document* scale = find(node, "scale")) {
    const double factor = as_number(*scale, 1e-3, 1e3);
    for (DipoleCoefficients& medium : material.channels) {
      medium.sigma_a *= factor;
      medium.sigma_s_prime *= factor;
    }
  }
  return material;
}

std::vector<SampleMaterial> read_materials(const Document& node, int channels) {
  const Document::Array& elements = as_array(node);
  if (elements.empty() || elements.size() > max_materials)
    throw_at(node, fmt::format("1 to {} materials", max_materials));
  std::vector<SampleMaterial> materials;
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
double read_eta(const Document& document, const std::vector<SampleMaterial>& materials) {
  if (const Document* eta = find(document, "eta")) return as_number(*eta, 1, 2.5);
  std::optional<double> common;
  for (const SampleMaterial& material : materials) {
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
void mix(const std::vector<SampleMaterial>& materials, const std::vector<float>& weights,
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

void vary(Sample& sample) {
  const auto width = static_cast<std::size_t>(sample.width);
  parallel_for(static_cast<std::size_t>(sample.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const auto centre = [&](std::size_t i) {
        return (static_cast<double>(i) + 0.5) * sample.pixel_pitch_mm;
      };
      const VariationFactors factors = eval_variation(sample, centre(x), centre(y), 0);
      for (std::size_t c = 0; c < static_cast<std::size_t>(sample.channels); ++c) {
        const std::size_t i = c * sample.pixels() + y * width + x;
        sample.sigma_a[i] *= static_cast<float>(factors.sigma_a);
        sample.sigma_s_prime[i] *= static_cast<float>(factors.sigma_s);
      }
    }
  });
}

void read_depth(const Document& document, Sample& sample) {
  const Document* node = find(document, "depth");
  if (node == nullptr) return;
  read_params(*node, describe(sample.depth));
  if (sample.depth.thickness_mm > 0 && sample.depth.grid_mm > 0)
    throw_at(get(*node, "grid_mm"), "no 'grid_mm' beside 'thickness_mm'", "both");
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

ParamList describe(SampleDepth& depth) {
  return {{.name = "thickness-mm",
           .help = "of the sample; 0: half-infinite",
           .target = &depth.thickness_mm,
           .min = 0,
           .max = 1000},
          {.name = "grid-mm",
           .help = "depth to which a half-infinite sample is described, below it stays as it is "
                   "there; 0: the radius of the table",
           .target = &depth.grid_mm,
           .min = 0,
           .max = 1000},
          {.name = "voxels-per-pixel",
           .help = "along each side of a pixel; voxels are cubes",
           .target = &depth.voxels_per_pixel,
           .min = 1,
           .max = 16},
          {.name = "margin-px",
           .help = "pixels of the layout around the sample",
           .target = &depth.margin_px,
           .min = 0,
           .max = 1024},
          {.name = "tilt-deg",
           .help = "of the lines along which the layout goes on below, against the vertical",
           .target = &depth.tilt_deg,
           .min = -85,
           .max = 85},
          {.name = "tilt-direction-deg",
           .help = "into which they lean, against x",
           .target = &depth.tilt_direction_deg,
           .min = -360,
           .max = 360},
          {.name = "solid",
           .help = "random structures in space: stones, not columns",
           .target = &depth.solid}};
}

TableHeader make_table_header(const Sample& sample, Boundary boundary, Sampling sampling,
                              const std::string& provenance) {
  TableHeader header;
  header.width = sample.width;
  header.height = sample.height;
  header.channels = sample.channels;
  header.pixel_pitch_mm = sample.pixel_pitch_mm;
  header.boundary = boundary;
  header.eta = sample.eta;
  header.symmetric = true;
  header.sampling = sampling;
  header.provenance = provenance;
  header.offsets = half_disc_offsets(sample.radius_px, sample.width, sample.height);
  check(header, sample.name);
  return header;
}

VariationFactors eval_variation(const Sample& sample, double x, double y, double z) {
  const SampleVariation& variation = sample.variation;
  if (variation.relative == 0) return {};
  const double s = std::sqrt(std::log1p(variation.relative * variation.relative));
  const double scale = 1 / variation.length_mm;
  const auto factor = [&](std::uint64_t field) {
    const std::uint64_t seed = hash_u64(sample.seed, 1000 + field);
    const double noise =
        sample.depth.solid
            ? eval_fractal_noise(seed, x * scale, y * scale, z * scale, variation.octaves)
            : eval_fractal_noise(seed, x * scale, y * scale, variation.octaves);
    return std::exp(s * noise - s * s / 2);
  };
  return {factor(0), factor(1)};
}

Sample read_sample(const Document& document, const ImageLoader& load_image, std::int64_t seed) {
  check_keys(document, {"$schema", "name", "description", "materials", "layout", "pitch_mm", "size",
                        "radius_px", "radius_mm", "channels", "eta", "seed", "variation", "depth"});
  Sample sample;
  sample.name = as_string(get(document, "name"));
  if (const Document* text = find(document, "description")) as_string(*text);
  if (const Document* channels = find(document, "channels")) {
    sample.channels = as_int(*channels, 1, 3);
    if (sample.channels == 2) throw_at(*channels, "1 or 3 channels");
  }
  read_grid(document, sample);
  sample.materials = read_materials(get(document, "materials"), sample.channels);
  sample.eta = read_eta(document, sample.materials);
  sample.seed = read_seed(document, seed);
  const int count = static_cast<int>(sample.materials.size());
  sample.layout = read_layout(get(document, "layout"), count, load_image);
  if (const Document* node = find(document, "variation"))
    read_params(*node, describe(sample.variation));
  read_depth(document, sample);

  const auto channels = static_cast<std::size_t>(sample.channels);
  sample.sigma_a.resize(channels * sample.pixels());
  sample.sigma_s_prime.resize(channels * sample.pixels());
  mix(sample.materials,
      make_weights(sample.layout, {.width = sample.width,
                                   .height = sample.height,
                                   .pixel_pitch_mm = sample.pixel_pitch_mm,
                                   .materials = count,
                                   .seed = sample.seed}),
      sample);
  if (sample.variation.relative > 0) vary(sample);
  sample.description = document;
  set(sample.description, "seed", static_cast<double>(sample.seed));
  return sample;
}

}  // namespace parian

// Materials of scene descriptions.
#include <fmt/format.h>

#include "base/check.h"
#include "material/slab_diffusion.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

constexpr double greatest_g = 0.99;
constexpr double min_thickness_mm = 1e-3, max_thickness_mm = 1e4;
constexpr std::size_t most_layers = 16, most_points = 256;

// A measured homogeneous material by name, in any case.
const NamedMaterial* find_named(const std::string& name) {
  const auto lower = [](std::string text) {
    for (char& c : text) c = 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
  };
  for (const NamedMaterial& material : named_materials())
    if (lower(material.name) == lower(name)) return &material;
  return &find_named_material(name);
}

Dipole read_named(const Document& node) {
  const NamedMaterial& named = *find_at(node, find_named);
  for (const DipoleCoefficients& medium : named.channels)
    if (medium.sigma_s_prime < min_scattering)
      throw_at(node, "a material that scatters in every channel",
               fmt::format("'{}', of which a channel has none measured", named.name));
  return {.channels = {named.channels.begin(), named.channels.end()}, .eta = named.eta};
}

std::vector<DipoleCoefficients> read_channels(const Document& node) {
  const auto sigma_a = read_three(get(node, "sigma_a"), 0, max_coefficient);
  std::array<double, 3> g{};
  if (const Document* cosine = find(node, "g")) g = read_three(*cosine, -greatest_g, greatest_g);
  const Document& scattering = get_one_of(node, {"sigma_s_prime", "sigma_s"});
  const bool is_reduced = find(node, "sigma_s_prime") != nullptr;
  const auto sigma_s = read_three(scattering, min_scattering, max_coefficient);
  std::vector<DipoleCoefficients> channels;
  channels.reserve(3);
  for (std::size_t c = 0; c < 3; ++c)
    channels.push_back({.sigma_a = sigma_a[c],
                        .sigma_s_prime = is_reduced ? sigma_s[c] : (1 - g[c]) * sigma_s[c],
                        .g = g[c]});
  return channels;
}

Dipole read_coefficients(const Document& node) {
  Dipole dipole{.channels = read_channels(node)};
  if (const Document* eta = find(node, "eta")) dipole.eta = as_number(*eta, 1, 2.5);
  return dipole;
}

const Document* find_any(const Document& node, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (const Document* member = find(node, key)) return member;
  return nullptr;
}

DiffusionModel read_model(const Document& node) {
  const std::string& name = as_string(node);
  if (name == "classic") return DiffusionModel::classic;
  if (name == "better") return DiffusionModel::better;
  if (name == "normalized") return DiffusionModel::normalized;
  throw_unknown(node, {"classic", "better", "normalized"});
}

double read_thickness(const Document& node) {
  return as_number(node, min_thickness_mm, max_thickness_mm);
}

// The slabs under the first, each with a thickness but for the last.
std::vector<DipoleLayer> read_below(const Document& node) {
  const std::size_t count = as_array(node).size();
  if (count > most_layers)
    throw_at(node, fmt::format("at most {} layers", most_layers), fmt::format("{}", count));
  std::vector<DipoleLayer> layers;
  layers.reserve(count);
  for (const Document& layer : as_array(node)) {
    check_keys(layer, {"sigma_a", "sigma_s_prime", "sigma_s", "g", "thickness_mm"});
    layers.push_back({.channels = read_channels(layer)});
    const Document* thickness = find(layer, "thickness_mm");
    if (thickness == nullptr && layers.size() < count)
      throw_at(layer, "the key 'thickness_mm' in all layers but the last", "none");
    if (thickness != nullptr) layers.back().thickness_mm = read_thickness(*thickness);
  }
  return layers;
}

// [[mm, factor], ...]
CurveGain read_gain(const Document& node) {
  const std::size_t count = as_array(node).size();
  if (count < 1 || count > most_points)
    throw_at(node, fmt::format("1 to {} points", most_points), fmt::format("{}", count));
  CurveGain gain;
  gain.reserve(count);
  for (const Document& point : as_array(node)) {
    const Document::Array& pair = as_array(point);
    if (pair.size() != 2)
      throw_at(point, "a pair [mm, factor]", fmt::format("an array of {}", pair.size()));
    gain.push_back({as_number(pair[0], 0, max_length_mm), as_number(pair[1], 1e-6, 1e6)});
    if (gain.size() > 1 && !(gain.back().mm > gain[gain.size() - 2].mm))
      throw_at(pair[0], "lengths that increase", fmt::format("{}", gain.back().mm));
  }
  return gain;
}

// What all homogeneous materials may have beside their coefficients.
Dipole with_options(const Document& node, Dipole dipole) {
  if (const Document* single = find(node, "single_scattering"))
    dipole.single_scattering = as_bool(*single);
  if (const Document* model = find(node, "model")) dipole.model = read_model(*model);
  if (const Document* gain = find(node, "reflectance_gain"))
    dipole.reflectance_gain = read_gain(*gain);
  if (const Document* gain = find(node, "attenuation_gain"))
    dipole.attenuation_gain = read_gain(*gain);
  const Document* thickness = find(node, "thickness_mm");
  if (thickness != nullptr) dipole.thickness_mm = read_thickness(*thickness);
  if (const Document* below = find(node, "below")) {
    if (thickness == nullptr) throw_at(*below, "the key 'thickness_mm' beside 'below'", "none");
    dipole.below = read_below(*below);
  }
  if (thickness == nullptr) return dipole;
  if (dipole.single_scattering)
    throw_at(*thickness, "no 'thickness_mm' beside 'single_scattering'", "both");
  try {
    for (std::size_t c = 0; c < dipole.channels.size(); ++c) make_slab_stack(dipole, c);
  } catch (const Error& error) {
    throw_at(get(node, error.parts.place), error.parts.expected, error.parts.found);
  }
  return dipole;
}

}  // namespace

SurfaceMaterial read_material(const Document& node, const SceneLoaders& loaders,
                              std::string& name) {
  check_keys(node, {"file", "named", "sigma_a", "sigma_s_prime", "sigma_s", "g", "eta",
                    "single_scattering", "model", "thickness_mm", "below", "reflectance_gain",
                    "attenuation_gain"});
  if (find_any(node, {"sigma_a", "sigma_s_prime", "sigma_s"}) != nullptr &&
      find_any(node, {"file", "named"}) == nullptr) {
    name = "homogeneous";
    return Material(with_options(node, read_coefficients(node)));
  }
  const Document& source =
      get_one_of(node, {"file", "named", "sigma_a", "sigma_s_prime", "sigma_s"});
  for (const char* key : {"eta", "g"})
    if (const Document* member = find(node, key))
      throw_at(*member, fmt::format("the key '{}' only beside 'sigma_a'", key), "it here");
  name = as_string(source);
  if (find(node, "named") != nullptr) return Material(with_options(node, read_named(source)));
  for (const char* key : {"single_scattering", "model", "thickness_mm", "below", "reflectance_gain",
                          "attenuation_gain"})
    if (const Document* member = find(node, key))
      throw_at(*member, fmt::format("the key '{}' only beside 'sigma_a' or 'named'", key),
               "it here");
  read_path(source);
  PARIAN_CHECK(loaders.load_material != nullptr);
  return loaders.load_material(name);
}

}  // namespace parian

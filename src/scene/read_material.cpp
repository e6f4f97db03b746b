// Materials of scene descriptions.
#include <fmt/format.h>

#include "base/check.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

constexpr double greatest_g = 0.99;

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

Dipole read_coefficients(const Document& node) {
  const auto sigma_a = read_three(get(node, "sigma_a"), 0, max_coefficient);
  std::array<double, 3> g{};
  if (const Document* cosine = find(node, "g")) g = read_three(*cosine, -greatest_g, greatest_g);
  const Document& scattering = get_one_of(node, {"sigma_s_prime", "sigma_s"});
  const bool is_reduced = find(node, "sigma_s_prime") != nullptr;
  const auto sigma_s = read_three(scattering, min_scattering, max_coefficient);
  Dipole dipole;
  for (std::size_t c = 0; c < 3; ++c)
    dipole.channels.push_back({.sigma_a = sigma_a[c],
                               .sigma_s_prime = is_reduced ? sigma_s[c] : (1 - g[c]) * sigma_s[c],
                               .g = g[c]});
  if (const Document* eta = find(node, "eta")) dipole.eta = as_number(*eta, 1, 2.5);
  return dipole;
}

const Document* find_any(const Document& node, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (const Document* member = find(node, key)) return member;
  return nullptr;
}

Dipole with_single_scattering(const Document& node, Dipole dipole) {
  if (const Document* single = find(node, "single_scattering"))
    dipole.single_scattering = as_bool(*single);
  return dipole;
}

}  // namespace

SurfaceMaterial read_material(const Document& node, const SceneLoaders& loaders,
                              std::string& name) {
  check_keys(node, {"file", "named", "sigma_a", "sigma_s_prime", "sigma_s", "g", "eta",
                    "single_scattering"});
  if (find_any(node, {"sigma_a", "sigma_s_prime", "sigma_s"}) != nullptr &&
      find_any(node, {"file", "named"}) == nullptr) {
    name = "homogeneous";
    return Material(with_single_scattering(node, read_coefficients(node)));
  }
  const Document& source =
      get_one_of(node, {"file", "named", "sigma_a", "sigma_s_prime", "sigma_s"});
  for (const char* key : {"eta", "g"})
    if (const Document* member = find(node, key))
      throw_at(*member, fmt::format("the key '{}' only beside 'sigma_a'", key), "it here");
  name = as_string(source);
  if (find(node, "named") != nullptr)
    return Material(with_single_scattering(node, read_named(source)));
  if (const Document* single = find(node, "single_scattering"))
    throw_at(*single, "the key 'single_scattering' only beside 'sigma_a' or 'named'", "it here");
  read_path(source);
  PARIAN_CHECK(loaders.load_material != nullptr);
  return loaders.load_material(name);
}

}  // namespace parian

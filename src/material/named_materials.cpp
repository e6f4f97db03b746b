// Measured homogeneous coefficients: Jensen et al. 2001 (Table 1) and the liquids of Narasimhan et
// al. 2006 at their natural concentration. docs/samples.md says where copies of these tables differ
// and which value is taken here.
#include <fmt/format.h>

#include "base/error.h"
#include "base/names.h"
#include "material/dipole.h"

namespace parian {
namespace {

struct Row {
  const char* name;
  std::array<double, 3> sigma_s_prime;  // 1/mm
  std::array<double, 3> sigma_a;        // 1/mm
};

// clang-format off
constexpr Row jensen_2001[] = {
    {"Apple", {2.29, 2.39, 1.97}, {0.0030, 0.0034, 0.046}},
    {"Chicken1", {0.15, 0.21, 0.38}, {0.015, 0.077, 0.19}},
    {"Chicken2", {0.19, 0.25, 0.32}, {0.018, 0.088, 0.20}},
    {"Cream", {7.38, 5.47, 3.15}, {0.0002, 0.0028, 0.0163}},
    {"Ketchup", {0.18, 0.07, 0.03}, {0.061, 0.97, 1.45}},
    {"Marble", {2.19, 2.62, 3.00}, {0.0021, 0.0041, 0.0071}},
    {"Potato", {0.68, 0.70, 0.55}, {0.0024, 0.0090, 0.12}},
    {"Skimmilk", {0.70, 1.22, 1.90}, {0.0014, 0.0025, 0.0142}},
    {"Skin1", {0.74, 0.88, 1.01}, {0.032, 0.17, 0.48}},
    {"Skin2", {1.09, 1.59, 1.79}, {0.013, 0.070, 0.145}},
    {"Spectralon", {11.6, 20.4, 14.9}, {0, 0, 0}},
    {"Wholemilk", {2.55, 3.21, 3.77}, {0.0011, 0.0024, 0.014}},
};

// sigma_s' = sigma_s (1 - g) of the published sigma_t, albedo and g.
constexpr Row narasimhan_2006[] = {
    {"Lowfat Milk", {0.89187, 1.5136, 2.532}, {0.002875, 0.00575, 0.0115}},
    {"Reduced Milk", {2.4858, 3.1669, 4.5214}, {0.0025556, 0.0051111, 0.012778}},
    {"Regular Milk", {4.5513, 5.8294, 7.136}, {0.0015333, 0.0046, 0.019933}},
    {"Espresso", {0.72378, 0.84557, 1.0247}, {4.7984, 6.5751, 8.8493}},
    {"Mint Mocha Coffee", {0.31602, 0.38538, 0.48131}, {3.772, 5.8228, 7.82}},
    {"Lowfat Soy Milk", {0.30576, 0.34233, 0.61664}, {0.0014375, 0.0071875, 0.035937}},
    {"Regular Soy Milk", {0.59223, 0.73866, 1.4693}, {0.0019167, 0.0095833, 0.065167}},
    {"Lowfat Chocolate Milk", {0.64925, 0.83916, 1.1057}, {0.0115, 0.0368, 0.1564}},
    {"Regular Chocolate Milk", {1.4585, 2.1289, 2.9527}, {0.010063, 0.043125, 0.14375}},
    {"Coke", {8.9053e-5, 8.372e-5, 0}, {0.10014, 0.16503, 0.2468}},
    {"Pepsi", {6.1697e-5, 4.2564e-5, 0}, {0.091641, 0.14158, 0.20729}},
    {"Sprite", {6.0306e-6, 6.4139e-6, 6.5504e-6}, {0.001886, 0.0018308, 0.0020025}},
    {"Gatorade", {0.0024574, 0.003007, 0.0037325}, {0.024794, 0.019289, 0.008878}},
    {"Chardonnay", {1.7982e-5, 1.3758e-5, 1.2023e-5}, {0.010782, 0.011855, 0.023997}},
    {"White Zinfandel", {1.7501e-5, 1.9069e-5, 1.288e-5}, {0.012072, 0.016184, 0.019843}},
    {"Merlot", {2.1129e-5, 0, 0}, {0.11632, 0.25191, 0.29434}},
    {"Budweiser Beer", {2.4356e-5, 2.4079e-5, 1.0564e-5}, {0.011492, 0.024911, 0.057786}},
    {"Coors Light Beer", {5.0922e-5, 4.301e-5, 0}, {0.006164, 0.013984, 0.034983}},
    {"Clorox", {0.0024035, 0.0031373, 0.003991}, {0.0033542, 0.014892, 0.026297}},
    {"Apple Juice", {0.00013612, 0.00015836, 0.000227}, {0.012957, 0.023741, 0.052184}},
    {"Cranberry Juice", {0.00010402, 0.00011646, 7.8139e-5}, {0.039437, 0.094223, 0.12426}},
    {"Grape Juice", {5.382e-5, 0, 0}, {0.10404, 0.23958, 0.29325}},
    {"Ruby Grapefruit Juice", {0.011002, 0.010927, 0.011036}, {0.085867, 0.18314, 0.25262}},
    {"White Grapefruit Juice", {0.22826, 0.23998, 0.32748}, {0.0138, 0.018831, 0.056781}},
    {"Shampoo", {0.0007176, 0.0008303, 0.0009016}, {0.014107, 0.045693, 0.061717}},
    {"Strawberry Shampoo", {0.00015671, 0.00015947, 1.518e-5}, {0.01449, 0.05796, 0.075823}},
    {"Head & Shoulders Shampoo", {0.023805, 0.028804, 0.034306}, {0.084621, 0.15688, 0.20365}},
    {"Pacific Ocean Surface Water", {0.0001764, 0.00032095, 0.00019617}, {0.031845, 0.031324, 0.030147}},
};
// clang-format on

NamedMaterial make_material(const Row& row, const char* source, double eta) {
  NamedMaterial material{row.name, source, {}, eta};
  for (std::size_t c = 0; c < 3; ++c)
    material.channels[c] = {.sigma_a = row.sigma_a[c], .sigma_s_prime = row.sigma_s_prime[c]};
  return material;
}

std::vector<NamedMaterial> make_materials() {
  std::vector<NamedMaterial> materials;
  for (const Row& row : jensen_2001)
    materials.push_back(make_material(row, "Jensen et al. 2001",
                                      std::string_view(row.name) == "Marble" ? 1.5 : 1.3));
  for (const Row& row : narasimhan_2006)
    materials.push_back(make_material(row, "Narasimhan et al. 2006", 1.33));
  return materials;
}

}  // namespace

const std::vector<NamedMaterial>& named_materials() {
  static const std::vector<NamedMaterial> materials = make_materials();
  return materials;
}

const NamedMaterial& find_named_material(std::string_view name) {
  std::vector<std::string> known;
  for (const NamedMaterial& material : named_materials()) {
    if (material.name == name) return material;
    known.push_back(material.name);
  }
  const std::string nearest = nearest_name(name, known);
  constexpr std::size_t longest = 60;
  const std::string_view shown = name.substr(0, longest);
  throw Error({"", "material", "the name of a measured material",
               nearest.empty() ? fmt::format("'{}'", shown)
                               : fmt::format("'{}' (did you mean '{}'?)", shown, nearest)});
}

}  // namespace parian

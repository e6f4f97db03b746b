#include "app/cli/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/names.h"

namespace parian {
namespace {

constexpr std::size_t most_values = 10'000;

struct Coefficient {
  const char* name;
  double min, max;
};
constexpr Coefficient coefficients[] = {{"sigma_a", 0, 1000},
                                        {"sigma_s", 1e-6, 1000},
                                        {"sigma_s_prime", 1e-6, 1000},
                                        {"g", -0.99, 0.99},
                                        {"thickness_mm", 1e-3, 1e4}};

[[noreturn]] void fail(const std::string& expected, const std::string& found) {
  throw Error({{}, "--sweep", expected, found}, ErrorKind::usage);
}

double parse_number(const std::string& text, const Coefficient& coefficient) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() ||
      !(value >= coefficient.min && value <= coefficient.max))
    fail(fmt::format("numbers in [{}, {}] for {}", coefficient.min, coefficient.max,
                     coefficient.name),
         fmt::format("'{}'", text));
  return value;
}

const Coefficient& find_coefficient(const std::string& name) {
  std::vector<std::string> known;
  for (const Coefficient& coefficient : coefficients) {
    if (name == coefficient.name) return coefficient;
    known.emplace_back(coefficient.name);
  }
  const std::string nearest = nearest_name(name, known);
  fail(
      "sigma_a, sigma_s, sigma_s_prime, g or thickness_mm",
      nearest.empty() ? "'" + name + "'" : fmt::format("'{}' (did you mean '{}'?)", name, nearest));
}

}  // namespace

Sweep parse_sweep(const std::string& text) {
  const std::size_t equals = text.find('='), first = text.find(':', equals),
                    second = text.find(':', first + 1);
  if (equals == std::string::npos || first == std::string::npos || second == std::string::npos)
    fail("NAME=FIRST:LAST:COUNT, as sigma_s=0.3:4:30", fmt::format("'{}'", text));
  Sweep sweep{text.substr(0, equals), {}};
  const Coefficient& coefficient = find_coefficient(sweep.name);
  const double from = parse_number(text.substr(equals + 1, first - equals - 1), coefficient);
  const double to = parse_number(text.substr(first + 1, second - first - 1), coefficient);
  std::size_t count = 0;
  const char* begin = text.data() + second + 1;
  const auto [end, status] = std::from_chars(begin, text.data() + text.size(), count);
  if (status != std::errc() || end != text.data() + text.size() || count < 1 || count > most_values)
    fail(fmt::format("a count in [1, {}]", most_values),
         fmt::format("'{}'", text.substr(second + 1)));
  sweep.values.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    sweep.values.push_back(count == 1 ? from
                                      : from + (to - from) * static_cast<double>(i) /
                                                   static_cast<double>(count - 1));
  return sweep;
}

Dipole set_coefficient(Dipole material, const std::string& name, double value) {
  if (name == "thickness_mm") material.thickness_mm = value;
  for (DipoleCoefficients& medium : material.channels) {
    const double sigma_s = sigma_s_of(medium);
    if (name == "sigma_a") medium.sigma_a = value;
    if (name == "sigma_s_prime") medium.sigma_s_prime = value;
    if (name == "sigma_s") medium.sigma_s_prime = (1 - medium.g) * value;
    if (name == "g") {
      medium.g = value;
      medium.sigma_s_prime = (1 - value) * sigma_s;
    }
  }
  return material;
}

std::string frame_name(const std::string& pattern, std::size_t frame) {
  const std::size_t first = pattern.find('#');
  if (first == std::string::npos) return pattern;
  const std::size_t last = std::min(pattern.find_first_not_of('#', first), pattern.size());
  return pattern.substr(0, first) + fmt::format("{:0{}}", frame, last - first) +
         pattern.substr(last);
}

Image make_contact_sheet(const std::vector<Image>& pictures) {
  PARIAN_CHECK(!pictures.empty());
  const Image& one = pictures.front();
  const int count = static_cast<int>(pictures.size());
  const int columns = std::min(
      count, std::max(3, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))))));
  const int rows = (count + columns - 1) / columns;
  Image sheet = make_image(columns * one.width, rows * one.height, one.channels);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int left = static_cast<int>(i) % columns * one.width,
              top = static_cast<int>(i) / columns * one.height;
    for (int y = 0; y < one.height; ++y)
      std::copy_n(&pictures[i].values[static_cast<std::size_t>(y * one.width) *
                                      static_cast<std::size_t>(one.channels)],
                  static_cast<std::size_t>(one.width * one.channels), &at(sheet, left, top + y, 0));
  }
  return sheet;
}

}  // namespace parian

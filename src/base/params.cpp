#include "base/params.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/names.h"

namespace parian {
namespace {

template <typename... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

void check_number(const Param& param, double value) {
  const bool inside = std::isfinite(value) && value <= param.max &&
                      (param.above_min ? value > param.min : value >= param.min);
  if (inside) return;
  const std::string range = format_range(param);
  throw Error({.place = param.name,
               .expected = range.empty() ? "a finite number" : "a value " + range,
               .found = fmt::format("{}", value)});
}

template <typename Number>
Number parse_number(const Param& param, const std::string& text, const char* kind) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [rest, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc() || rest != end)
    throw Error({.place = param.name, .expected = kind, .found = "'" + text + "'"});
  return value;
}

bool parse_bool(const Param& param, const std::string& text) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  throw Error({.place = param.name, .expected = "true or false", .found = "'" + text + "'"});
}

std::vector<double> parse_list(const Param& param, const std::string& text) {
  std::vector<double> values;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    values.push_back(
        parse_number<double>(param, text.substr(begin, comma - begin), "numbers, comma-separated"));
    begin = comma + 1;
  }
  return values;
}

int parse_choice(const Param& param, const ChoiceTarget& choice, const std::string& text) {
  const auto found = std::find(choice.names.begin(), choice.names.end(), text);
  if (found != choice.names.end()) return static_cast<int>(found - choice.names.begin());
  std::string hint = nearest_name(text, choice.names);
  if (!hint.empty()) hint = " (did you mean '" + hint + "'?)";
  throw Error({.place = param.name,
               .expected = "one of " + list_names(choice.names),
               .found = "'" + text + "'" + hint});
}

}  // namespace

void check(const ParamList& params) {
  for (const Param& param : params) {
    std::visit(Overloaded{[](const bool*) {}, [](const std::string*) {}, [](const ChoiceTarget&) {},
                          [&](const int* value) { check_number(param, *value); },
                          [&](const std::uint64_t* value) {
                            check_number(param, static_cast<double>(*value));
                          },
                          [&](const double* value) { check_number(param, *value); },
                          [&](const std::vector<double>* values) {
                            for (double value : *values) check_number(param, value);
                          }},
               param.target);
  }
}

std::string format_value(const Param& param) {
  return std::visit(
      Overloaded{[](const bool* value) { return std::string(*value ? "true" : "false"); },
                 [](const std::string* value) { return *value; },
                 [](const ChoiceTarget& choice) {
                   return choice.names.at(static_cast<std::size_t>(choice.get()));
                 },
                 [](const std::vector<double>* values) {
                   return fmt::format("{}", fmt::join(*values, ","));
                 },
                 [](const auto* value) { return fmt::format("{}", *value); }},
      param.target);
}

std::string format_range(const Param& param) {
  if (const auto* choice = std::get_if<ChoiceTarget>(&param.target))
    return "one of " + list_names(choice->names);
  const bool low = std::isfinite(param.min), high = std::isfinite(param.max);
  if (low && high)
    return fmt::format("in {}{}, {}]", param.above_min ? '(' : '[', param.min, param.max);
  if (low) return fmt::format("{} {}", param.above_min ? ">" : ">=", param.min);
  if (high) return fmt::format("<= {}", param.max);
  return {};
}

void parse_value(const Param& param, const std::string& text) {
  std::visit(
      Overloaded{
          [&](bool* value) { *value = parse_bool(param, text); },
          [&](int* value) { *value = parse_number<int>(param, text, "a whole number"); },
          [&](std::uint64_t* value) {
            *value = parse_number<std::uint64_t>(param, text, "a whole number from 0");
          },
          [&](double* value) { *value = parse_number<double>(param, text, "a number"); },
          [&](std::string* value) { *value = text; },
          [&](std::vector<double>* values) { *values = parse_list(param, text); },
          [&](const ChoiceTarget& choice) { choice.set(parse_choice(param, choice, text)); }},
      param.target);
}

std::string json_key(const Param& param) {
  std::string key = param.name;
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

}  // namespace parian

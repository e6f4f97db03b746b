// One description per params struct: symbol, unit, range and help of each field, bound to the
// field itself. Command-line flags, JSON keys and the editor's sliders are derived from it.
//
//   struct FitParams { int segments = 0; ... };
//   ParamList describe(FitParams& params) {
//     return {{.name = "segments", .help = "...", .target = &params.segments, .min = 0, .max =
//     256}};
//   }
//
// A description points into the struct it was made from and must not outlive it.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace parian {

// An enum field: choices are the names of its values, in order from 0.
struct ChoiceTarget {
  std::vector<std::string> names;
  std::function<int()> get;
  std::function<void(int)> set;
};

template <typename Enum>
ChoiceTarget make_choice(Enum& field, std::vector<std::string> names) {
  return {std::move(names), [&field] { return static_cast<int>(field); },
          [&field](int value) { field = static_cast<Enum>(value); }};
}

using ParamTarget = std::variant<bool*, int*, std::uint64_t*, double*, std::string*,
                                 std::vector<double>*, ChoiceTarget>;

struct Param {
  std::string name;  // kebab-case: flag --name, JSON key "name" with '_' for '-'
  std::string help;
  ParamTarget target;
  // Allowed range of numbers (of each element, for lists).
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  // true: min itself is not allowed
  std::string symbol;      // as in the paper, may be empty
  std::string unit;        // may be empty
  char letter = 0;         // short form of the command-line flag, 0: none
};

using ParamList = std::vector<Param>;

// Throws Error naming field, allowed range and value. NaN and infinities never pass.
void check(const ParamList& params);

// The value as text, as it would be typed on the command line.
std::string format_value(const Param& param);
// "in [1, 256]", "> 0", "one of 'a' or 'b'"; empty where anything goes.
std::string format_range(const Param& param);
// Sets from text; throws Error naming the parameter. Does not check ranges.
void parse_value(const Param& param, const std::string& text);

// params "name" as JSON key: '-' becomes '_'.
std::string json_key(const Param& param);

}  // namespace parian

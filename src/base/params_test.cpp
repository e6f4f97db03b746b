#include "base/params.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/test_errors.h"

namespace parian {
namespace {

enum class Weight { uniform, energy };
struct Example {
  int segments = 24;
  double lambda = 0.01;
  bool monotone = true;
  Weight weight = Weight::uniform;
  std::vector<double> knots;
  std::uint64_t seed = 1;
};

ParamList describe(Example& example) {
  return {
      {.name = "segments", .help = "", .target = &example.segments, .min = 1, .max = 256},
      {.name = "lambda", .help = "", .target = &example.lambda, .min = 0, .above_min = true},
      {.name = "no-monotone", .help = "", .target = &example.monotone},
      {.name = "weight", .help = "", .target = make_choice(example.weight, {"uniform", "energy"})},
      {.name = "knots", .help = "", .target = &example.knots, .min = 0},
      {.name = "seed", .help = "", .target = &example.seed}};
}

TEST(Params, FormatsAndParsesEveryKind) {
  Example source, copy;
  source = {7, 0.25, false, Weight::energy, {0, 0.5, 2}, 18446744073709551615u};
  const ParamList from = describe(source), to = describe(copy);
  for (std::size_t i = 0; i < from.size(); ++i) parse_value(to[i], format_value(from[i]));
  EXPECT_EQ(copy.segments, 7);
  EXPECT_EQ(copy.lambda, 0.25);
  EXPECT_FALSE(copy.monotone);
  EXPECT_EQ(copy.weight, Weight::energy);
  EXPECT_EQ(copy.knots, source.knots);
  EXPECT_EQ(copy.seed, source.seed);
  EXPECT_EQ(json_key(to[2]), "no_monotone");
}

TEST(Params, CheckNamesFieldRangeAndValue) {
  Example example;
  example.segments = 100'000;
  EXPECT_EQ(error_of([&] { check(describe(example)); }),
            "segments: expected a value in [1, 256], found 100000");
  example = {};
  example.lambda = 0;
  EXPECT_EQ(error_of([&] { check(describe(example)); }), "lambda: expected a value > 0, found 0");
  example.lambda = std::nan("");
  EXPECT_EQ(error_of([&] { check(describe(example)); }), "lambda: expected a value > 0, found nan");
}

TEST(Params, ParseErrorsNameTheParameter) {
  Example example;
  const ParamList params = describe(example);
  EXPECT_EQ(error_of([&] { parse_value(params[0], "many"); }),
            "segments: expected a whole number, found 'many'");
  EXPECT_EQ(
      error_of([&] { parse_value(params[3], "enery"); }),
      "weight: expected one of 'uniform' or 'energy', found 'enery' (did you mean 'energy'?)");
  EXPECT_EQ(error_of([&] { parse_value(params[4], "1,x"); }),
            "knots: expected numbers, comma-separated, found 'x'");
}

}  // namespace
}  // namespace parian

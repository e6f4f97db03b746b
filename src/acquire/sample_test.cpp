#include "acquire/sample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquire/test_documents_internal.h"
#include "base/test_errors.h"

namespace parian {
namespace {

Sample read(Document document, std::int64_t seed = -1) {
  return read_sample(locate(std::move(document)), {}, seed);
}
std::string error_with(const std::string& key, Document value) {
  Document document = chessboard_description();
  set(document, key, std::move(value));
  return error_of([&] { read(std::move(document)); });
}

TEST(Sample, ReadsADescription) {
  const Sample sample = read(chessboard_description());
  EXPECT_EQ(sample.width, 24);
  EXPECT_EQ(sample.height, 20);
  EXPECT_EQ(sample.channels, 3);
  EXPECT_EQ(sample.seed, 3u);
  EXPECT_EQ(sample.eta, 1.5);  // marble's
  const std::size_t blue = 2 * sample.pixels();
  EXPECT_FLOAT_EQ(sample.sigma_s_prime[blue], 3.00f);  // marble
  EXPECT_FLOAT_EQ(sample.sigma_a[blue + 6], 0.05f);    // dark, half as dense
  EXPECT_FLOAT_EQ(sample.sigma_s_prime[blue + 6], 0.6f);
}

TEST(Sample, RadiusInMillimetres) {
  Document document = homogeneous_description("Apple");
  auto& members = std::get<Document::Object>(document.value);
  for (auto& [key, value] : members)
    if (key == "radius_px") key = "radius_mm", value = Document(1.0);
  EXPECT_EQ(read(document).radius_px, 4);
  set(document, "radius_px", 4);
  EXPECT_EQ(error_of([&] { read(document); }),
            "s.json: /: expected one of the keys 'radius_px' and 'radius_mm', found both");
}

TEST(Sample, VariationHasItsMeanAndDeviation) {
  Document document = homogeneous_description("Apple");
  set(document, "variation", object({{"relative", 0.2}, {"length_mm", 0.3}, {"octaves", 1}}));
  set(document, "size", array({128, 128}));
  const Sample sample = read(document);
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < sample.pixels(); ++i) {
    const double factor = sample.sigma_s_prime[i] / 2.29;
    sum += factor, squares += factor * factor;
    // The same factor for all channels.
    ASSERT_NEAR(sample.sigma_s_prime[2 * sample.pixels() + i] / 1.97, factor, 1e-5);
  }
  const double mean = sum / static_cast<double>(sample.pixels());
  const double variance = squares / static_cast<double>(sample.pixels()) - mean * mean;
  // About 4000 independent places.
  EXPECT_NEAR(mean, 1, 0.02);
  EXPECT_NEAR(std::sqrt(variance), 0.2, 0.02);
  EXPECT_NE(sample.sigma_a[0] / 0.003f, sample.sigma_s_prime[0] / 2.29f);
}

TEST(Sample, SeedsAreReproducible) {
  Document document = chessboard_description();
  set(document, "layout", object({{"kind", "mixing"}}));
  EXPECT_EQ(read(document).sigma_a, read(document).sigma_a);
  EXPECT_NE(read(document).sigma_a, read(document, 4).sigma_a);
  EXPECT_EQ(read(document, 3).sigma_a, read(document).sigma_a);
  EXPECT_EQ(as_number(get(read(document, 4).description, "seed")), 4);
}

TEST(Sample, OneChannel) {
  Document document = homogeneous_description("Skin1");
  set(document, "channels", 1);
  const Sample sample = read(document);
  EXPECT_EQ(sample.sigma_a.size(), sample.pixels());
  EXPECT_FLOAT_EQ(sample.sigma_a[0], 0.17f);  // the green one
  set(document, "materials",
      array({object({{"name", "a"}, {"sigma_a", 0.25}, {"sigma_s_prime", 2.0}})}));
  EXPECT_FLOAT_EQ(read(document).sigma_a[0], 0.25f);
}

TEST(Sample, BadMaterialsAreNamed) {
  const auto error = [](Document material) {
    return error_with("materials", array({std::move(material)}));
  };
  EXPECT_EQ(error(object({{"name", "a"}, {"material", "Wholmilk"}})),
            "s.json: /materials/0/material: expected the name of a measured material, found "
            "'Wholmilk' (did you mean 'Wholemilk'?)");
  EXPECT_EQ(error(object({{"name", "a"}, {"sigmaa", 1}})),
            "s.json: /materials/0/sigmaa: expected a known key, found 'sigmaa' (did you mean "
            "'sigma_a'?)");
  EXPECT_EQ(
      error(object({{"name", "a"}, {"sigma_a", array({1.0, 2.0})}})),
      "s.json: /materials/0/sigma_a: expected a number or an array of 3, found an array of 2");
  EXPECT_EQ(error(object({{"name", "a"}, {"sigma_a", 0.1}, {"sigma_s_prime", 0}})),
            "s.json: /materials/0/sigma_s_prime: expected a number in [1e-06, 1000], found the "
            "number 0");
  EXPECT_EQ(error(object({{"name", "a"}, {"material", "Marble"}, {"sigma_a", 0.1}})),
            "s.json: /materials/0/sigma_a: expected either 'material' or 'sigma_a' and "
            "'sigma_s_prime', found both");
  EXPECT_EQ(error(object({{"name", "a"}, {"material", "Merlot"}})),
            "s.json: /materials/0/material: expected a material that scatters in every channel, "
            "found 'Merlot', of which a channel has none measured");
  const Document marble = object({{"name", "a"}, {"material", "Marble"}});
  const Document apple = object({{"name", "a"}, {"material", "Apple"}});
  EXPECT_EQ(error_with("materials", array({marble, apple})),
            "s.json: /materials/1/name: expected a name of its own, found 'a' again");
  EXPECT_EQ(
      error_with("materials", array({marble, object({{"name", "b"}, {"material", "Apple"}})})),
      "s.json: /: expected the key 'eta', since its measured materials differ in it, found "
      "1.5 and 1.3");
}

TEST(Sample, BadGridsAreNamed) {
  EXPECT_EQ(error_with("pitchmm", 1),
            "s.json: /pitchmm: expected a known key, found 'pitchmm' (did you mean 'pitch_mm'?)");
  EXPECT_EQ(error_with("size", array({24.0})),
            "s.json: /size: expected [width, height], found an array of 1");
  EXPECT_EQ(error_with("size", array({8193, 2})),
            "s.json: /size/0: expected a whole number in [1, 8192], found the number 8193");
  EXPECT_EQ(error_with("radius_px", 24),
            "s.json: /radius_px: expected a radius of 1 to 23 pixels (that of the sample, at most "
            "512), found 24 pixels");
  EXPECT_EQ(error_with("pitch_mm", 0),
            "s.json: /pitch_mm: expected a number in [0.0001, 100], found the number 0");
  EXPECT_EQ(error_with("channels", 2),
            "s.json: /channels: expected 1 or 3 channels, found the number 2");
  EXPECT_EQ(error_with("seed", -1),
            "s.json: /seed: expected a number in [0, 9007199254740992], found the number -1");
}

}  // namespace
}  // namespace parian

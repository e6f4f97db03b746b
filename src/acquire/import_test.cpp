#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "acquire/import_slices.h"
#include "acquire/import_textures.h"
#include "acquire/test_documents_internal.h"
#include "base/test_errors.h"
#include "material/bssrdf_table.h"
#include "material/diffusion.h"

namespace parian {
namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

struct MemorySink : SliceSink {
  explicit MemorySink(const TableHeader& header) : table(make_bssrdf_table(header)) {}
  void write_slice(int channel, int offset_index, const float* slice) override {
    std::copy(slice, slice + table.header.pixels(), slice_of(table, channel, offset_index));
  }
  void finish() override { finished = true; }
  BssrdfTable table;
  bool finished = false;
};

// 3 x 2 pixels, offsets (0,0) and (1,0).
Document slices_description() {
  return object({{"kind", "slices"},
                 {"pitch_mm", 0.5},
                 {"offsets", array({array({0, 0}), array({1, 0})})},
                 {"files", array({"a.npy", "b.npy"})},
                 {"boundary", "included"},
                 {"noise_gain", 0.01}});
}
using Arrays = std::map<std::string, NamedArray>;
Arrays make_arrays() {
  return {{"a.npy", {{2, 3}, {1, 2, 3, 4, 5, 6}}}, {"b.npy", {{2, 3}, {.1f, .2f, 9, .3f, -1, 9}}}};
}
BssrdfTable import_all(Document document, const Arrays& arrays) {
  const auto load = [&](const std::string& path) { return arrays.at(path); };
  const SliceImport slices = read_slice_import(locate(std::move(document)), load);
  MemorySink sink(slices.header);
  import_slices(slices, load, sink);
  EXPECT_TRUE(sink.finished);
  return sink.table;
}
std::string error_with(const std::string& key, Document value) {
  Document document = slices_description();
  set(document, key, std::move(value));
  return error_of([&] { import_all(document, make_arrays()); });
}

TEST(ImportSlices, KeepsValuesAndDescription) {
  const BssrdfTable table = import_all(slices_description(), make_arrays());
  EXPECT_EQ(table.header.width, 3);
  EXPECT_EQ(table.header.height, 2);
  EXPECT_EQ(table.header.channels, 1);
  EXPECT_EQ(table.header.boundary, Boundary::included);
  EXPECT_EQ(table.header.noise_gain, std::vector<double>{0.01});
  EXPECT_EQ(table.header.noise_floor, std::vector<double>{0});
  EXPECT_EQ(slice_of(table, 0, 0)[5], 6);
  EXPECT_EQ(slice_of(table, 0, 1)[4], -1);            // data, as there is a noise model
  EXPECT_TRUE(std::isnan(slice_of(table, 0, 1)[2]));  // its partner is outside
}

TEST(ImportSlices, OneArrayHoldsWhatManyFilesHold) {
  Document document = slices_description();
  auto& members = std::get<Document::Object>(document.value);
  for (auto& [key, value] : members)
    if (key == "files") key = "file", value = Document("all.npy");
  // [channel][offset][y][x] and files of [y][x][channel]: the same table.
  NamedArray all{{3, 2, 2, 3}, {}};
  Arrays each{{"a.npy", {{2, 3, 3}, std::vector<float>(18)}},
              {"b.npy", {{2, 3, 3}, std::vector<float>(18)}}};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t d = 0; d < 2; ++d)
      for (std::size_t i = 0; i < 6; ++i) {
        const auto value = static_cast<float>(1 + c + 10 * d + 100 * i);
        all.values.push_back(value);
        each[d == 0 ? "a.npy" : "b.npy"].values[i * 3 + c] = value;
      }
  const BssrdfTable together = import_all(document, {{"all.npy", all}});
  const BssrdfTable apart = import_all(slices_description(), each);
  ASSERT_EQ(together.reflectance.size(), apart.reflectance.size());
  for (std::size_t i = 0; i < apart.reflectance.size(); ++i)
    if (!std::isnan(apart.reflectance[i])) {
      ASSERT_EQ(together.reflectance[i], apart.reflectance[i]);
    }
}

TEST(ImportSlices, BadDescriptionsNameThePlace) {
  EXPECT_EQ(error_with("files", array({"a.npy"})),
            "s.json: /files: expected 2 files, one for each offset, found 1");
  EXPECT_EQ(error_with("file", "a.npy"),
            "s.json: /: expected one of the keys 'files' and 'file', found both");
  EXPECT_EQ(error_with("boundary", "open"),
            "s.json: /boundary: expected 'excluded' or 'included', found 'open'");
  EXPECT_EQ(error_with("offset", 1),
            "s.json: /offset: expected a known key, found 'offset' (did you mean 'offsets'?)");
  EXPECT_EQ(error_with("noise_floor", array({0, 0, 0})),
            "s.json: /noise_floor: expected 1 number, found an array of 3");
  Arrays arrays = make_arrays();
  arrays["b.npy"] = {{3, 2}, {1, 2, 3, 4, 5, 6}};
  EXPECT_EQ(error_of([&] { import_all(slices_description(), arrays); }),
            "b.npy: shape: expected [2][3], as 'a.npy' has, found [3][2]");
  arrays["a.npy"] = {{6}, {1, 2, 3, 4, 5, 6}};
  EXPECT_EQ(error_of([&] { import_all(slices_description(), arrays); }),
            "a.npy: shape: expected [height][width] or [height][width][channels], found [6]");
}

TEST(ImportSlices, BadValuesNameTheFile) {
  Arrays arrays = make_arrays();
  arrays["b.npy"].values[1] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_of([&] { import_all(slices_description(), arrays); }).substr(0, 6), "b.npy:");
  arrays["b.npy"].values[1] = nan_value;  // not measured
  EXPECT_EQ(error_of([&] { import_all(slices_description(), arrays); }), "no error");
}

TextureImport gradient(TextureModel model, TextureRadius radius) {
  TextureImport import{.model = model, .radius = radius, .pixel_pitch_mm = 0.5};
  import.albedo = make_image(5, 2, 3);
  import.radius_mm = make_image(5, 2, 1);
  for (std::size_t i = 0; i < import.albedo.values.size(); ++i)
    import.albedo.values[i] = 0.1f + 0.028f * static_cast<float>(i);
  for (std::size_t i = 0; i < 10; ++i)
    import.radius_mm.values[i] = 0.3f + 0.1f * static_cast<float>(i);
  return import;
}

TEST(ImportTextures, AlbedoIsTheTextures) {
  for (const auto model : {TextureModel::burley, TextureModel::dipole})
    for (const auto radius :
         {TextureRadius::mean_free_path, TextureRadius::diffuse_mean_free_path}) {
      const TextureImport import = gradient(model, radius);
      const TextureMap made = make_texture_map(import);
      EXPECT_EQ(made.limited, 0u);
      EXPECT_EQ(made.map.boundary, Boundary::included);
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 5; ++x)
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(diffuse_albedo(get_profile(made.map, c, x, y)) / at(import.albedo, x, y, c),
                        1, 2e-5);
    }
}

// The albedo of the dipole is known in closed form, and diffusion.h has its own formulas.
TEST(ImportTextures, ProfilesAreTheModels) {
  for (const double alpha : {0.3, 0.9, 0.99, 0.9999}) {
    const DipoleCoefficients medium{.sigma_a = 2 * (1 - alpha), .sigma_s_prime = 2 * alpha};
    const double albedo = dipole_albedo(medium, 1.3);
    EXPECT_NEAR(invert_dipole_albedo(albedo, 1.3), alpha, 1e-9);
    TextureImport import = gradient(TextureModel::dipole, TextureRadius::mean_free_path);
    import.albedo = make_image(1, 1, 1, static_cast<float>(albedo));
    import.radius_mm = make_image(1, 1, 1, 0.5f);
    const Profile profile = get_profile(make_texture_map(import).map, 0, 0, 0);
    for (std::size_t k = 1; k < 18; ++k)
      EXPECT_NEAR(profile.log_value[k], std::log(eval_dipole(medium, 1.3, profile.knots_mm[k])),
                  0.03);
  }
  TextureImport import = gradient(TextureModel::burley, TextureRadius::mean_free_path);
  import.albedo = make_image(1, 1, 1, 0.6f);
  import.radius_mm = make_image(1, 1, 1, 0.5f);
  import.segments = 96;
  const Profile profile = get_profile(make_texture_map(import).map, 0, 0, 0);
  const ReflectanceCurve curve{
      NormalizedDiffusion{.total = 0.6, .decay_per_mm = (1.9 - 0.6 + 3.5 * 0.04) / 0.5}};
  for (std::size_t k = 1; k < 80; ++k)
    EXPECT_NEAR(profile.log_value[k], std::log(eval_curve(curve, profile.knots_mm[k])), 0.01);
}

TEST(ImportTextures, ReadsDescriptions) {
  const auto load = [](const std::string& path) {
    return path == "narrow.png" ? make_image(2, 3, 1, 0.5f)
           : path == "bad.exr"  ? make_image(3, 3, 1, 1.5f)
                                : make_image(3, 3, 3, 0.5f);
  };
  Document document = object({{"kind", "textures"},
                              {"albedo", "a.png"},
                              {"mean_free_path", "r.png"},
                              {"scale_mm", 4},
                              {"pitch_mm", 0.25}});
  const auto read = [&](const Document& from) {
    return read_texture_import(locate(from), load, load);
  };
  EXPECT_EQ(read(document).radius_mm.values.at(0), 2.0f);
  const auto error_with_key = [&](const char* key, Document value) {
    Document changed = document;
    set(changed, key, std::move(value));
    return error_of([&] { read(changed); });
  };
  EXPECT_EQ(error_with_key("mean_free_path", "narrow.png"),
            "narrow.png: size: expected 3 x 3 pixels, as 'a.png' has, found 2 x 3");
  EXPECT_EQ(error_with_key("albedo", "bad.exr"),
            "bad.exr: pixel (0, 0): expected a value in [0, 1], found 1.5");
  EXPECT_EQ(error_with_key("model", "gauss"),
            "s.json: /model: expected 'burley' or 'dipole', found 'gauss'");
  EXPECT_EQ(error_with_key("diffuse_mean_free_path", "r.png"),
            "s.json: /: expected one of the keys 'mean_free_path' and 'diffuse_mean_free_path', "
            "found both");
}

}  // namespace
}  // namespace parian

#include "io/hdf5/map_file.h"

#include <gtest/gtest.h>

#include "base/test_errors.h"
#include "io/hdf5/table_file.h"
#include "io/hdf5/test_files_internal.h"
#include "io/json/files.h"

namespace parian {
namespace {

using namespace hdf5;

ProfileMap make_test_map(int channels) {
  ProfileMap map = make_profile_map(4, 3, channels, 0.5, {0, 0.5, 1.25});
  Rng rng = make_rng(2);
  for (float& value : map.log_profile) value = static_cast<float>(-5 * sample_uniform(rng));
  return map;
}

struct MapFile : testing::Test {
  std::string error_when(const std::function<void(TestFile&)>& spoil) const {
    const ProfileMap map = make_test_map(1);
    {
      TestFile file(path);
      file.set("format", std::string("parian-profile-map"));
      file.set("version", 1);
      file.set("pixel_pitch_mm", 0.5);
      file.put("knots_mm", H5T_NATIVE_DOUBLE, {3}, H5T_NATIVE_DOUBLE, map.knots_mm.data());
      file.put("log_profile", H5T_NATIVE_FLOAT, {1, 3, 3, 4}, H5T_NATIVE_FLOAT,
               map.log_profile.data());
      spoil(file);
    }
    const std::string message = error_of([&] { load_profile_map(path); });
    return message.starts_with(path + ": ") ? message.substr(path.size() + 2) : message;
  }
  TestFolder folder{"map"};
  std::string path = folder.at("m.h5");
};

TEST_F(MapFile, RoundTripsBitForBit) {
  for (const int channels : {1, 3}) {
    ProfileMap map = make_test_map(channels);
    const std::size_t plane = map.pixels() * static_cast<std::size_t>(channels);
    if (channels == 3) {
      map.boundary = Boundary::included;
      map.eta = 1.5;
      map.gain.assign(plane, 2.0f);
      map.dilation.assign(plane, 0.5f);
      map.hold_out = {0.05, ~std::uint64_t{0}};
      map.provenance = "{\"by\": \"test\"}";
    }
    save_profile_map(path, map);
    EXPECT_EQ(folder.count(), 1u);
    const ProfileMap read = load_profile_map(path);
    EXPECT_EQ(read.width, 4);
    EXPECT_EQ(read.height, 3);
    EXPECT_EQ(read.channels, channels);
    EXPECT_EQ(read.pixel_pitch_mm, 0.5);
    EXPECT_EQ(read.boundary, map.boundary);
    EXPECT_EQ(read.eta, map.eta);
    EXPECT_EQ(read.knots_mm, map.knots_mm);
    EXPECT_EQ(read.log_profile, map.log_profile);
    EXPECT_EQ(read.gain, map.gain);
    EXPECT_EQ(read.dilation, map.dilation);
    EXPECT_EQ(read.hold_out.fraction, map.hold_out.fraction);
    EXPECT_EQ(read.hold_out.seed, map.hold_out.seed);
    EXPECT_EQ(read.provenance, map.provenance);
  }
}

TEST_F(MapFile, SavingOverAnOldOneReplacesIt) {
  save_profile_map(path, make_test_map(1));
  save_profile_map(path, make_test_map(3));
  EXPECT_EQ(load_profile_map(path).channels, 3);
  EXPECT_EQ(folder.count(), 1u);
}

TEST_F(MapFile, BadMapsAreNamed) {
  EXPECT_EQ(error_when([](TestFile&) {}), "no error");
  EXPECT_EQ(error_when([](TestFile& f) { f.set("format", std::string("parian-bssrdf-table")); }),
            "attribute 'format': expected 'parian-profile-map', found 'parian-bssrdf-table'");
  EXPECT_EQ(error_when([](TestFile& f) { f.remove_dataset("knots_mm"); }),
            "dataset 'knots_mm': expected shape [K], found no such dataset");
  const std::vector<double> bad{0, 2, 1, 4};
  EXPECT_EQ(error_when([&](TestFile& f) {
              f.put("knots_mm", H5T_NATIVE_DOUBLE, {4}, H5T_NATIVE_DOUBLE, bad.data());
            }),
            "dataset 'knots_mm': expected shape [3], as 'log_profile' has 3 knots, found [4]");
  EXPECT_EQ(error_when([&](TestFile& f) {
              f.put("knots_mm", H5T_NATIVE_DOUBLE, {3}, H5T_NATIVE_DOUBLE, bad.data());
            }),
            "knots_mm[2]: expected a finite value > 2, found 1");
  EXPECT_EQ(error_when([&](TestFile& f) {
              f.put("gain", H5T_NATIVE_FLOAT, {1, 4, 3}, H5T_NATIVE_DOUBLE, nullptr);
            }),
            "dataset 'gain': expected shape [1][3][4], as of 'log_profile', found [1][4][3]");
  EXPECT_EQ(error_when([](TestFile& f) { f.set("hold_out_fraction", 1.0); }),
            "attribute 'hold_out_fraction': expected a fraction in [0, 1), found 1");
  EXPECT_EQ(error_when([](TestFile& f) { f.set("eta", -1.0); }),
            "attribute 'eta': expected a refractive index in [1, 4], found -1");
}

TEST_F(MapFile, FormatsAreToldApart) {
  save_profile_map(path, make_test_map(1));
  EXPECT_EQ(read_format(path), "parian-profile-map");
  write_text(folder.at("text"), "hello");
  EXPECT_EQ(read_format(folder.at("text")), "");
  TestFile(folder.at("plain.h5")).set("other", 1);
  EXPECT_EQ(read_format(folder.at("plain.h5")), "");
  TestFile(folder.at("number.h5")).set("format", 1);
  EXPECT_EQ(read_format(folder.at("number.h5")), "");
  EXPECT_EQ(error_of([&] { read_format(folder.at("none")); }),
            folder.at("none") + ": expected a readable file, found no such file");
}

}  // namespace
}  // namespace parian

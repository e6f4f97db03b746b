#include "io/hdf5/transport_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/test_errors.h"
#include "io/hdf5/test_files_internal.h"
#include "io/json/files.h"

namespace parian {
namespace {

using namespace hdf5;

std::vector<float> make_values(std::size_t count) {
  Rng rng = make_rng(3);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(sample_uniform(rng) - 0.2);
  return values;
}

TransportFile make_file(int degree = 1) {
  TransportFile file;
  HomogeneousTransport& transport = file.transport;
  transport.eta = 1.4;
  transport.places = 11;
  transport.multiple_basis = {.degree = degree, .knots = {0, 0.5, 2, 9}};
  transport.single_basis = {.degree = degree, .knots = {0, 1, 4}};
  const std::size_t n = transport.multiple_basis.size(), m = transport.single_basis.size();
  transport.lights.push_back({.name = "light 1 (point)",
                              .multiple = pack_transport(make_values(11 * n * 3), n, 3),
                              .single = pack_transport(make_values(11 * m * 12), m, 12)});
  transport.lights.push_back(
      {.name = "light 2", .multiple = pack_transport(make_values(11 * n * 3), n, 3), .single = {}});
  file.fingerprint = {.mesh = 1, .parameters = ~std::uint64_t{0}, .lights = {7, 8}};
  file.provenance = "{\"by\": \"test\"}";
  return file;
}

struct TransportFiles : testing::Test {
  // What reading says of the saved file after a change of its bytes or attributes.
  std::string message() const {
    const std::string text = error_of([&] { load_transport(path); });
    return text.starts_with(path + ": ") ? text.substr(path.size() + 2) : text;
  }
  TestFolder folder{"transport"};
  std::string path = folder.at("t.h5");
};

TEST_F(TransportFiles, RoundTripBitForBit) {
  for (const int degree : {1, 2}) {
    const TransportFile file = make_file(degree);
    save_transport(path, file);
    EXPECT_EQ(folder.count(), 1u);
    const TransportFile read = load_transport(path);
    EXPECT_TRUE(read.is_complete());
    EXPECT_EQ(read.fingerprint, file.fingerprint);
    EXPECT_EQ(read.provenance, file.provenance);
    EXPECT_EQ(read.transport.eta, 1.4);
    EXPECT_EQ(read.transport.multiple_basis.degree, degree);
    EXPECT_EQ(read.transport.multiple_basis.knots, file.transport.multiple_basis.knots);
    EXPECT_EQ(read.transport.single_basis.knots, file.transport.single_basis.knots);
    ASSERT_EQ(read.transport.lights.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      const LightTransport &a = read.transport.lights[i], &b = file.transport.lights[i];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.multiple.half, b.multiple.half);
      EXPECT_EQ(a.multiple.scale, b.multiple.scale);
      EXPECT_EQ(a.single.half, b.single.half);
      EXPECT_EQ(a.single.functions, b.single.functions);
    }
  }
}

TEST_F(TransportFiles, UnfinishedOnesSayHowFarTheyAre) {
  TransportFile file = make_file();
  file.transport.lights.pop_back();
  save_transport(path, file);
  const TransportFile read = load_transport(path);
  EXPECT_FALSE(read.is_complete());
  EXPECT_EQ(read.transport.lights.size(), 1u);
  EXPECT_EQ(read.fingerprint.lights.size(), 2u);
}

TEST_F(TransportFiles, OtherScenesAreNamed) {
  const TransportFile file = make_file();
  const auto found = [&](TransportFingerprint other, bool with_parameters) {
    return std::string(error_of([&] { check_fingerprint(file, "t.h5", other, with_parameters); }));
  };
  TransportFingerprint other = file.fingerprint;
  EXPECT_EQ(found(other, true), "no error");
  other.mesh = 2;
  EXPECT_EQ(found(other, false),
            "t.h5: attribute 'mesh_hash': expected the hash of the scene's mesh, found that of "
            "another");
  other = file.fingerprint;
  other.lights[1] = 9;
  EXPECT_EQ(found(other, false),
            "t.h5: attribute 'light_hash_2': expected the hash of the scene's light 2, found that "
            "of another");
  other.lights.push_back(1);
  EXPECT_EQ(found(other, false), "t.h5: attribute 'lights': expected 3, as the scene has, found 2");
  other = file.fingerprint;
  other.parameters = 5;
  EXPECT_EQ(found(other, false), "no error");
  EXPECT_EQ(found(other, true),
            "t.h5: attribute 'parameter_hash': expected the hash of these parameters, found that "
            "of another");
}

TEST_F(TransportFiles, DamageIsFound) {
  TransportFile file = make_file();
  save_transport(path, file);
  const std::string bytes = read_file(path, 1u << 20u);
  for (const std::size_t size : {bytes.size() / 2, bytes.size() - 300}) {
    write_text(path, std::string_view(bytes).substr(0, size));
    const std::string expected = fmt::format(
        "expected a whole HDF5 file, found a truncated or damaged one (truncated file: eof = {}, "
        "sblock->base_addr = 0, stored_eof = {})",
        size, bytes.size());
    EXPECT_EQ(message(), expected);
  }
  file.transport.lights[0].single.half[8 * 5] = 0x7e00;  // NaN
  save_transport(path, file);
  EXPECT_EQ(message(),
            "dataset 'single_1', [0][0][5]: expected a finite value, found NaN or infinity");
  file = make_file();
  file.transport.multiple_basis.knots[1] = 3;
  save_transport(path, file);
  EXPECT_EQ(message(),
            "dataset 'multiple_knots_mm', [2]: expected increasing knots from 0, found 2");
  file.transport.multiple_basis.knots = {0, 1};
  save_transport(path, file);
  EXPECT_EQ(message(), "dataset 'multiple_1': expected shape [11][2][3], found [11][4][3]");
  file = make_file();
  file.transport.lights[1].multiple.scale[0] = 0;
  save_transport(path, file);
  EXPECT_EQ(message(), "dataset 'multiple_2_scale': expected finite values above 0, found 0");
}

}  // namespace
}  // namespace parian

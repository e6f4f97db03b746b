#include "io/hdf5/photon_file.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/test_errors.h"
#include "io/hdf5/test_files_internal.h"
#include "io/json/files.h"

namespace parian {
namespace {

using namespace hdf5;

Sample make_sample(double albedo = 0.9) {
  const Document::Object material{
      {"name", "all"}, {"sigma_a", 1 - albedo}, {"sigma_s_prime", albedo}};
  return read_sample(Document::Object{{"name", "plain"},
                                      {"materials", Document::Array{Document(material)}},
                                      {"layout", Document::Object{{"kind", "uniform"}}},
                                      {"channels", 1},
                                      {"pitch_mm", 1},
                                      {"size", Document::Array{4, 3}},
                                      {"radius_px", 1}},
                     {});
}

struct PhotonFiles : testing::Test {
  void SetUp() override {
    for (int step = 0; step < 3; ++step) simulation.advance();
    save_photon_progress(path, simulation);
  }
  std::string message() const {
    const PhotonSimulation fresh(make_sample(), params);
    const std::string text = error_of([&] { load_photon_progress(path, fresh); });
    return text.starts_with(path + ": ") ? text.substr(path.size() + 2) : text;
  }
  // What reading says after a change of the file through HDF5.
  template <typename Change>
  std::string message_after(const Change& change) {
    save_photon_progress(path, simulation);
    {
      const Guard guard;
      const Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
      change(file.get());
    }
    return message();
  }
  TestFolder folder{"photons"};
  std::string path = folder.at("t.h5.partial");
  PhotonParams params{.photons = 64};
  PhotonSimulation simulation{make_sample(), params};
};

void write_value(hid_t file, const char* name, float value) {
  const Id dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  const Id space(H5Dget_space(dataset.get()), H5Sclose);
  std::vector<float> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
  values[5] = value;
  H5Dwrite(dataset.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

TEST_F(PhotonFiles, RoundTripBitForBit) {
  EXPECT_EQ(folder.count(), 1u);
  PhotonSimulation other(make_sample(), params);
  other.resume(load_photon_progress(path, other));
  EXPECT_EQ(other.progress().steps, 3u);
  for (PhotonSimulation* each : {&simulation, &other})
    while (!each->is_done()) each->advance();
  const PhotonSums &a = simulation.progress().sums[0], &b = other.progress().sums[0];
  EXPECT_EQ(a.forward, b.forward);
  EXPECT_EQ(a.backward, b.backward);
  EXPECT_EQ(a.squares, b.squares);
  const PhotonRoundTotals &s = simulation.progress().totals[0], &t = other.progress().totals[0];
  EXPECT_EQ(s.sum, t.sum);
  EXPECT_EQ(s.squares, t.squares);
  EXPECT_EQ(s.roulette, t.roulette);
  EXPECT_EQ(s.balance, t.balance);
  EXPECT_EQ(s.flights, t.flights);
}

TEST_F(PhotonFiles, OtherRunsAreRefused) {
  const PhotonSimulation other(make_sample(0.8), params);
  EXPECT_EQ(error_of([&] { load_photon_progress(path, other); }),
            path +
                ": attribute 'fingerprint': expected that of this sample and these parameters, "
                "found that of another");
}

TEST_F(PhotonFiles, DamageIsFound) {
  EXPECT_EQ(message(), "no error");
  EXPECT_EQ(message_after([](hid_t file) { H5Adelete(file, "steps"); }),
            "attribute 'steps': expected a whole number, found no such attribute");
  EXPECT_EQ(message_after([](hid_t file) { H5Ldelete(file, "totals", H5P_DEFAULT); }),
            "dataset 'totals': expected shape [C][11], found no such dataset");
  EXPECT_EQ(message_after([](hid_t file) { write_value(file, "backward_1", -1); }),
            "dataset 'backward_1', value 5: expected a finite value from 0, found -1");
  EXPECT_EQ(message_after([](hid_t file) {
              write_value(file, "squares_1", std::numeric_limits<float>::quiet_NaN());
            }),
            "dataset 'squares_1', value 5: expected a finite value from 0, found nan");
  EXPECT_EQ(message_after([](hid_t file) {
              H5Ldelete(file, "forward_1", H5P_DEFAULT);
              H5Lcopy(file, "totals", file, "forward_1", H5P_DEFAULT, H5P_DEFAULT);
            }),
            "dataset 'forward_1': expected shape [D][H][W], found [1][11]");
  save_photon_progress(path, simulation);
  const std::string bytes = read_file(path, 1u << 20u);
  write_text(path, std::string_view(bytes).substr(0, bytes.size() / 2));
  EXPECT_NE(message(), "no error");
}

}  // namespace
}  // namespace parian

// Bad tables, each with its exact message, and outputs that cannot be written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include "base/test_errors.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/hdf5/test_files_internal.h"
#include "io/json/files.h"

namespace parian {
namespace {

using namespace hdf5;

struct BadTable : testing::Test {
  // The error of opening a good table once `spoil` has changed it, without the file's name.
  std::string error_when(const std::function<void(TestFile&)>& spoil) const {
    {
      TestFile file = write_minimal_table(path, table);
      spoil(file);
    }
    return strip(error_of([&] { read_table(*open_table(path)); }));
  }
  std::string strip(const std::string& message) const {
    return message.starts_with(path + ": ") ? message.substr(path.size() + 2) : message;
  }
  std::string error_with_offsets(std::vector<int> offsets) const {
    return error_when([&](TestFile& file) {
      const hsize_t count = offsets.size() / 2;
      file.put("offsets", H5T_NATIVE_INT, {count, 2}, H5T_NATIVE_INT, offsets.data());
      const std::vector<float> values(count * 20, 1.0f);
      file.put("reflectance", H5T_IEEE_F32LE, {1, count, 4, 5}, H5T_NATIVE_FLOAT, values.data());
    });
  }
  std::string error_with_value(float value) const {
    return error_when([&](TestFile& file) {
      BssrdfTable changed = table;
      slice_of(changed, 1, 3)[7] = value;
      file.put("reflectance", H5T_IEEE_F32LE, table_shape(table.header), H5T_NATIVE_FLOAT,
               changed.reflectance.data());
    });
  }

  TestFolder folder{"bad-table"};
  std::string path = folder.at("t.h5");
  BssrdfTable table = make_noise_table(make_test_header());
};

TEST_F(BadTable, GoodOneOpens) {
  EXPECT_EQ(error_when([](TestFile&) {}), "no error");
}

TEST_F(BadTable, NotHdf5) {
  EXPECT_EQ(strip(error_of([&] { open_table(path); })),
            "expected a readable file, found no such file");
  write_text(path, "hello");
  EXPECT_EQ(strip(error_of([&] { open_table(path); })),
            "expected an HDF5 file, found no HDF5 signature");
  write_text(path, "");
  EXPECT_EQ(strip(error_of([&] { open_table(path); })),
            "expected an HDF5 file, found no HDF5 signature");
  EXPECT_EQ(error_of([&] { open_table("/dev/null"); }),
            std::string("/dev/null: expected an HDF5 file, found a pipe or device"));
}

TEST_F(BadTable, Truncated) {
  write_minimal_table(path, table);
  const std::string bytes = read_file(path, 1 << 20);
  write_text(path, bytes.substr(0, 1000));
  EXPECT_EQ(strip(error_of([&] { open_table(path); })),
            "expected a whole HDF5 file, found a truncated or damaged one (truncated file: eof = "
            "1000, sblock->base_addr = 0, stored_eof = " +
                std::to_string(bytes.size()) + ")");
  for (std::size_t size = 0; size < bytes.size(); size += 97) {
    write_text(path, bytes.substr(0, size));
    EXPECT_EQ(catch_error([&] { open_table(path); }).kind, ErrorKind::input);
  }
}

TEST_F(BadTable, FormatAndVersion) {
  EXPECT_EQ(error_when([](TestFile& file) { file.set("format", std::string("other")); }),
            "attribute 'format': expected 'parian-bssrdf-table', found 'other'");
  EXPECT_EQ(error_when([](TestFile& file) { file.remove_attribute("format"); }),
            "attribute 'format': expected 'parian-bssrdf-table', found no such attribute");
  EXPECT_EQ(error_when([](TestFile& file) { file.set("format", 3); }),
            "attribute 'format': expected a string, found whole numbers");
  EXPECT_EQ(error_when([](TestFile& file) { file.set("version", 2); }),
            "attribute 'version': expected 1, found 2");
}

TEST_F(BadTable, MissingParts) {
  EXPECT_EQ(error_when([](TestFile& file) { file.remove_attribute("pixel_pitch_mm"); }),
            "attribute 'pixel_pitch_mm': expected a number, found no such attribute");
  EXPECT_EQ(error_when([](TestFile& file) { file.remove_attribute("version"); }),
            "attribute 'version': expected a number, found no such attribute");
  EXPECT_EQ(error_when([](TestFile& file) { file.remove_dataset("offsets"); }),
            "dataset 'offsets': expected shape [D][2], found no such dataset");
  EXPECT_EQ(error_when([](TestFile& file) { file.remove_dataset("reflectance"); }),
            "dataset 'reflectance': expected shape [C][D][H][W], found no such dataset");
}

TEST_F(BadTable, Attributes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const char* pitch = "attribute 'pixel_pitch_mm': expected a finite length > 0, found ";
  EXPECT_EQ(error_when([&](TestFile& f) { f.set("pixel_pitch_mm", nan); }),
            pitch + std::string("nan"));
  EXPECT_EQ(error_when([&](TestFile& f) { f.set("pixel_pitch_mm", 0.0); }),
            pitch + std::string("0"));
  EXPECT_EQ(error_when([&](TestFile& f) { f.set("pixel_pitch_mm", 1 / 0.0); }),
            pitch + std::string("inf"));
  EXPECT_EQ(error_when([&](TestFile& f) { f.set("pixel_pitch_mm", std::string("1")); }),
            "attribute 'pixel_pitch_mm': expected numbers, found a string");
  const double two[2] = {1, 2};
  EXPECT_EQ(error_when([&](TestFile& f) { f.set("pixel_pitch_mm", H5T_NATIVE_DOUBLE, two, {2}); }),
            "attribute 'pixel_pitch_mm': expected a single value, found 2 values");
  EXPECT_EQ(error_when([](TestFile& f) { f.set("boundary", std::string("inside")); }),
            "attribute 'boundary': expected 'excluded' or 'included', found 'inside'");
  EXPECT_EQ(error_when([](TestFile& f) { f.set("sampling", std::string("line")); }),
            "attribute 'sampling': expected 'point' or 'area', found 'line'");
  EXPECT_EQ(error_when([](TestFile& f) { f.set("symmetric", 2); }),
            "attribute 'symmetric': expected 0 or 1, found 2");
  EXPECT_EQ(error_when([](TestFile& f) { f.set("eta", 0.5); }),
            "attribute 'eta': expected a refractive index in [1, 4], found 0.5");
  EXPECT_EQ(
      error_when([&](TestFile& f) { f.set("noise_floor", H5T_NATIVE_DOUBLE, two, {2}); }),
      "attribute 'noise_floor': expected 3 values, one per channel, as for its twin, found 2");
}

TEST_F(BadTable, Shapes) {
  const std::vector<float> values(65536, 1.0f);
  const auto with_shape = [&](const std::vector<hsize_t>& shape) {
    return error_when([&](TestFile& file) {
      file.put("reflectance", H5T_IEEE_F32LE, shape, H5T_NATIVE_FLOAT, values.data());
    });
  };
  EXPECT_EQ(
      with_shape({3, 2, 4, 5}),
      "dataset 'offsets': expected shape [2][2], as 'reflectance' has 2 offsets, found [7][2]");
  EXPECT_EQ(with_shape({8, 4, 5}),
            "dataset 'reflectance': expected shape [C][D][H][W], found [8][4][5]");
  const std::string limits =
      "dataset 'reflectance': expected shape [C][D][H][W] with C = 1 or 3, D in [1, 1000000], H "
      "and W in [1, 65535], found ";
  EXPECT_EQ(with_shape({2, 8, 4, 5}), limits + "[2][8][4][5]");
  EXPECT_EQ(with_shape({1, 1, 1, 65536}), limits + "[1][1][1][65536]");
  EXPECT_EQ(with_shape({3, 0, 4, 5}), limits + "[3][0][4][5]");
  EXPECT_EQ(error_when([&](TestFile& file) {
              file.put("offsets", H5T_NATIVE_FLOAT, {8, 2}, H5T_NATIVE_FLOAT, values.data());
            }),
            "dataset 'offsets': expected whole numbers, found floating-point numbers");
}

// A few hundred bytes that claim terabytes are not believed.
TEST_F(BadTable, ClaimsWithoutData) {
  const Id plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t chunk[4] = {1, 1, 64, 64};
  H5Pset_chunk(plist.get(), 4, chunk);
  EXPECT_EQ(error_when([&](TestFile& file) {
              file.put("reflectance", H5T_IEEE_F32LE, {3, 1000000, 65535, 65535}, H5T_NATIVE_FLOAT,
                       nullptr, plist.get());
            }),
            "dataset 'reflectance': expected stored values for the shape "
            "[3][1000000][65535][65535], found 0 bytes");
}

TEST_F(BadTable, Offsets) {
  EXPECT_EQ(error_with_offsets({0, 0, -1, 0}),
            "offsets[1]: expected an offset of the half plane dy > 0, or dy = 0 and dx >= 0, found "
            "(-1, 0)");
  EXPECT_EQ(error_with_offsets({0, 0, 1, 1, 2, 1, 1, 1}),
            "offsets[3]: expected each offset once, found (1, 1) again");
  EXPECT_EQ(error_with_offsets({1, 0, 1, 1}),
            "offsets: expected the offset (0, 0) among them, found none");
  EXPECT_EQ(error_with_offsets({0, 0, 5, 0}),
            "offsets[1]: expected |dx| < 5 and |dy| < 4, the size of the sample, found (5, 0)");
  EXPECT_EQ(error_with_offsets({0, 0, 70000, 0}),
            "offsets[1]: expected components in [-65535, 65535], found (70000, 0)");
}

TEST_F(BadTable, Values) {
  const std::string place = "reflectance[1][3][1][2] (channel, offset, y, x): expected ";
  EXPECT_EQ(table.header.offsets[3], (Offset{-1, 1}));
  EXPECT_EQ(error_with_value(std::numeric_limits<float>::infinity()),
            place + "a finite value or NaN (not measured), found inf");
  EXPECT_EQ(error_with_value(0),
            place + "a value > 0 or NaN, as the table has no noise model, found 0");
  EXPECT_EQ(error_with_value(-0.5f),
            place + "a value > 0 or NaN, as the table has no noise model, found -0.5");
}

TEST_F(BadTable, ChunksThatWereNeverWritten) {
  for (const bool nan_fill : {false, true}) {
    const Id plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const hsize_t chunk[4] = {1, 1, 4, 5}, start[4] = {}, count[4] = {1, 1, 4, 5};
    H5Pset_chunk(plist.get(), 4, chunk);
    const float fill = std::numeric_limits<float>::quiet_NaN();
    if (nan_fill) H5Pset_fill_value(plist.get(), H5T_NATIVE_FLOAT, &fill);
    const std::string error = error_when([&](TestFile& file) {
      file.put("reflectance", H5T_IEEE_F32LE, table_shape(table.header), H5T_NATIVE_FLOAT, nullptr,
               plist.get());
      const Id dataset(H5Dopen2(file.file.get(), "reflectance", H5P_DEFAULT), H5Dclose);
      const Id memory(H5Screate_simple(4, count, nullptr), H5Sclose);
      const Id space(H5Dget_space(dataset.get()), H5Sclose);
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, nullptr, count, nullptr);
      H5Dwrite(dataset.get(), H5T_NATIVE_FLOAT, memory.get(), space.get(), H5P_DEFAULT,
               slice_of(table, 0, 0));
    });
    // Slices are read by several threads: any of those that are missing may be named.
    if (nan_fill) {
      EXPECT_EQ(error, "no error");
    } else {
      EXPECT_THAT(error, testing::MatchesRegex("reflectance.[0-9]..[0-9].: expected written "
                                               "values, found a chunk that was never written"));
    }
  }
}

TEST_F(BadTable, DamagedDeflateStream) {
  const auto sink = create_table(path, table.header, {.deflate = 9});
  copy_slices(*make_slices(table), *sink);
  std::string bytes = read_file(path, 1 << 20);
  const std::size_t stream = bytes.rfind("\x78\xda");  // zlib's header at level 9
  ASSERT_NE(stream, std::string::npos);
  bytes.replace(stream, 8, 8, '\0');
  write_text(path, bytes);
  EXPECT_THAT(strip(error_of([&] { read_table(*open_table(path)); })),
              testing::MatchesRegex("reflectance.[0-9].*: expected a whole deflate stream, found "
                                    "damaged data"));
}

TEST_F(BadTable, UnwritableOutput) {
  const Error error = catch_error([&] { create_table(folder.at("no/t.h5"), table.header); });
  EXPECT_EQ(error.what(),
            folder.at("no/t.h5") + ": expected a writable folder, found no such directory");
  EXPECT_EQ(error.kind, ErrorKind::resource);
}

// A small file system of our own that fills up; needs the right to mount.
struct FullDisk : BadTable {
  void SetUp() override {
    std::filesystem::create_directories(disk);
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0)
      GTEST_SKIP() << "mounting a tmpfs needs root";
    mounted = true;
    path = disk + "/t.h5";
  }
  void TearDown() override {
    if (mounted) ::umount2(disk.c_str(), MNT_DETACH);
  }
  void expect_full(const std::function<void()>& write) const {
    write_text(path, "old");
    const Error error = catch_error(write);
    EXPECT_EQ(error.what(), path + ": expected free disk space, found a full disk");
    EXPECT_EQ(error.kind, ErrorKind::resource);
    EXPECT_EQ(read_file(path, 9), "old");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(disk), {}), 1);
  }
  // Leaves `bytes` free.
  void fill_but(std::size_t bytes) const {
    const auto space = std::filesystem::space(disk);
    write_text(disk + "/ballast", std::string(space.available - bytes, 'x'));
  }
  TableHeader large_header() const {
    TableHeader header = make_test_header();
    header.width = header.height = 64;
    return header;  // 384 KiB
  }
  std::string disk = folder.at("disk");
  bool mounted = false;
};

TEST_F(FullDisk, ShowsAtOnceForPlainTables) {
  expect_full([&] { create_table(path, large_header()); });
}

TEST_F(FullDisk, ShowsWhileDeflatedTablesAreWritten) {
  const BssrdfTable large = make_noise_table(large_header());
  expect_full([&] {
    const auto sink = create_table(path, large.header, {.deflate = 1});
    copy_slices(*make_slices(large), *sink);
  });
}

// With no room for HDF5's own metadata, at any point of it.
TEST_F(FullDisk, ShowsWhenNotEvenTheHeaderFits) {
  for (const std::size_t free : {0u, 4096u, 8192u, 12288u, 16384u}) {
    write_text(path, "old");
    fill_but(free);
    for (const int deflate : {0, 1}) {
      const Error error = catch_error([&] {
        const auto sink = create_table(path, large_header(), {.deflate = deflate});
        copy_slices(*make_slices(make_noise_table(large_header())), *sink);
      });
      EXPECT_EQ(error.what(), path + ": expected free disk space, found a full disk") << free;
      EXPECT_EQ(std::distance(std::filesystem::directory_iterator(disk), {}), 2);
    }
    EXPECT_EQ(read_file(path, 9), "old");
    std::filesystem::remove(disk + "/ballast");
  }
}

TEST_F(FullDisk, ShowsForMapsAndTexts) {
  expect_full([&] { save_profile_map(path, make_profile_map(64, 64, 3, 1, {0, 1, 2, 3, 4, 5})); });
  expect_full([&] { write_text(path, std::string(300 << 10, 'x')); });
}

}  // namespace
}  // namespace parian

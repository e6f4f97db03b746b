#include "io/hdf5/table_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "io/hdf5/read_internal.h"
#include "io/hdf5/slice_layout_internal.h"
#include "io/hdf5/test_files_internal.h"
#include "io/json/files.h"

namespace parian {
namespace {

using namespace hdf5;

// The same bits, but for those of NaN.
void expect_same_values(const std::vector<float>& left, const std::vector<float>& right) {
  ASSERT_EQ(left.size(), right.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < left.size(); ++i)
    different += !(std::isnan(left[i]) && std::isnan(right[i])) &&
                 std::memcmp(&left[i], &right[i], sizeof(float)) != 0;  // NOLINT: bits are meant
  EXPECT_EQ(different, 0u);
}

// Whether slices of the file are read past HDF5.
bool is_fast(const std::string& path) {
  const Guard guard;
  const File file = open_file(path);
  const RawFile raw(path, RawFile::Mode::read, path);
  return locate_slices(file, open_dataset(file, "reflectance", "[C][D][H][W]"), raw).has_value();
}

void save(const std::string& path, const BssrdfTable& table, int deflate = 0) {
  const auto sink = create_table(path, table.header, {.deflate = deflate});
  copy_slices(*make_slices(table), *sink);
}

TEST(TableFile, RoundTripsBitForBit) {
  const TestFolder folder("table");
  for (const int channels : {1, 3}) {
    for (const int deflate : {0, 6}) {
      const BssrdfTable table = make_noise_table(make_test_header(channels));
      save(folder.at("t.h5"), table, deflate);
      EXPECT_EQ(folder.count(), 1u);
      EXPECT_TRUE(is_fast(folder.at("t.h5")));
      const auto source = open_table(folder.at("t.h5"));
      EXPECT_EQ(source->name(), folder.at("t.h5"));
      expect_same_values(read_table(*source).reflectance, table.reflectance);
    }
  }
}

TEST(TableFile, HeaderRoundTrips) {
  const TestFolder folder("table");
  TableHeader header = make_test_header();
  header.boundary = Boundary::included;
  header.sampling = Sampling::area;
  header.eta = 1.47;
  header.pixel_pitch_mm = 0.1;
  header.noise_floor = {1e-4, 2e-4, 0};
  header.noise_gain = {0, 1e-3, 3};
  header.provenance = "{\"text\": \"\xc3\xa4" + std::string(100000, 'x') + "\"}";
  header.symmetric = false;
  header.offsets = {{1, 0}, {0, 0}, {-1, 2}, {-1, 0}, {1, -2}};
  BssrdfTable table = make_noise_table(header);
  slice_of(table, 1, 1)[7] = -0.5f;  // the noise model allows it
  save(folder.at("t.h5"), table);
  const BssrdfTable read = read_table(*open_table(folder.at("t.h5")));
  EXPECT_EQ(read.header.boundary, header.boundary);
  EXPECT_EQ(read.header.sampling, header.sampling);
  EXPECT_EQ(read.header.eta, header.eta);
  EXPECT_EQ(read.header.pixel_pitch_mm, header.pixel_pitch_mm);
  EXPECT_EQ(read.header.noise_floor, header.noise_floor);
  EXPECT_EQ(read.header.noise_gain, header.noise_gain);
  EXPECT_EQ(read.header.provenance, header.provenance);
  EXPECT_EQ(read.header.symmetric, false);
  EXPECT_EQ(read.header.offsets, header.offsets);
  expect_same_values(read.reflectance, table.reflectance);
}

TEST(TableFile, MinimalForeignTableHasTheDefaults) {
  const TestFolder folder("table");
  const BssrdfTable table = make_noise_table(make_test_header());
  write_minimal_table(folder.at("t.h5"), table);
  EXPECT_TRUE(is_fast(folder.at("t.h5")));
  const auto source = open_table(folder.at("t.h5"));
  EXPECT_EQ(source->header().boundary, Boundary::excluded);
  EXPECT_EQ(source->header().eta, 1.3);
  EXPECT_TRUE(source->header().symmetric);
  EXPECT_EQ(source->header().sampling, Sampling::point);
  EXPECT_FALSE(source->header().has_noise_model());
  EXPECT_EQ(source->header().provenance, "");
  expect_same_values(read_table(*source).reflectance, table.reflectance);
}

// Other widths and byte orders, other chunks, unknown extras, every kind of string.
TEST(TableFile, ReadsWhatHdf5CanConvert) {
  const TestFolder folder("table");
  const BssrdfTable table = make_noise_table(make_test_header());
  const std::vector<int> offsets = flatten_offsets(table.header);
  const Id plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t chunk[4] = {2, 3, 2, 4};
  H5Pset_chunk(plist.get(), 4, chunk);
  H5Pset_fletcher32(plist.get());
  for (const hid_t type : {H5T_IEEE_F64BE, H5T_IEEE_F32BE, H5T_IEEE_F64LE, H5T_IEEE_F32LE}) {
    {
      TestFile file = write_minimal_table(folder.at("t.h5"), table);
      file.put("reflectance", type, table_shape(table.header), H5T_NATIVE_FLOAT,
               table.reflectance.data(), plist.get());
      file.put("offsets", H5T_STD_I64BE, {table.header.offsets.size(), 2}, H5T_NATIVE_INT,
               offsets.data());
      file.put("something", H5T_STD_I64BE, {1}, H5T_NATIVE_INT, offsets.data());
      file.set("else", 3);
      file.set_fixed("format", "parian-bssrdf-table", 40, H5T_STR_SPACEPAD);
      file.set_fixed("boundary", "included", 8, H5T_STR_NULLPAD);
      file.set_fixed("sampling", "area", 20, H5T_STR_NULLTERM);
      const unsigned char version = 1;
      file.set("version", H5T_NATIVE_UCHAR, &version);
      const float eta = 1.5f;
      file.set("eta", H5T_NATIVE_FLOAT, &eta, {1});
    }
    EXPECT_FALSE(is_fast(folder.at("t.h5")));
    const auto source = open_table(folder.at("t.h5"));
    EXPECT_EQ(source->header().boundary, Boundary::included);
    EXPECT_EQ(source->header().sampling, Sampling::area);
    EXPECT_EQ(source->header().eta, 1.5);
    expect_same_values(read_table(*source).reflectance, table.reflectance);
  }
}

// h5py stores True as an enumeration over int8.
TEST(TableFile, ReadsEnumerationsAsNumbers) {
  const TestFolder folder("table");
  const BssrdfTable table = make_noise_table(make_test_header());
  {
    TestFile file = write_minimal_table(folder.at("t.h5"), table);
    const Id type(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
    signed char value = 0;
    H5Tenum_insert(type.get(), "FALSE", &value);
    value = 1;
    H5Tenum_insert(type.get(), "TRUE", &value);
    file.set("symmetric", type.get(), &value);
  }
  EXPECT_TRUE(open_table(folder.at("t.h5"))->header().symmetric);
}

// Files of HDF5's newer formats index chunks otherwise: found by search, or read through HDF5.
TEST(TableFile, ReadsNewerFileFormatsAndUserBlocks) {
  const TestFolder folder("table");
  const BssrdfTable table = make_noise_table(make_test_header());
  const std::vector<hsize_t> shape = table_shape(table.header);
  for (const bool user_block : {false, true}) {
    const Id create(H5Pcreate(H5P_FILE_CREATE), H5Pclose),
        access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    if (user_block) H5Pset_userblock(create.get(), 512);
    H5Pset_libver_bounds(access.get(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    const Id plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const hsize_t chunk[4] = {1, 1, shape[2], shape[3]};
    H5Pset_chunk(plist.get(), 4, chunk);
    {
      TestFile file(folder.at("t.h5"), create.get(), access.get());
      file.set("format", std::string("parian-bssrdf-table"));
      file.set("version", 1);
      file.set("pixel_pitch_mm", 1);
      const std::vector<int> offsets = flatten_offsets(table.header);
      file.put("offsets", H5T_NATIVE_INT, {shape[1], 2}, H5T_NATIVE_INT, offsets.data());
      file.put("reflectance", H5T_IEEE_F32LE, shape, H5T_NATIVE_FLOAT, table.reflectance.data(),
               plist.get());
    }
    EXPECT_EQ(is_fast(folder.at("t.h5")), !user_block);
    expect_same_values(read_table(*open_table(folder.at("t.h5"))).reflectance, table.reflectance);
  }
}

// More chunks than one node of the index holds, in an order of their own.
TEST(TableFile, WalksDeepChunkIndices) {
  const TestFolder folder("table");
  TableHeader header = make_test_header(1);
  header.width = header.height = 3;
  header.symmetric = true;
  header.offsets = {{0, 0}, {1, 0}, {0, 1}};
  const hsize_t channels = 3, offsets = 2500, size = 2;
  const Id plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t chunk[4] = {1, 1, size, size};
  H5Pset_chunk(plist.get(), 4, chunk);
  const Guard guard;
  std::vector<float> values(channels * offsets * size * size);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  TestFile(folder.at("t.h5"))
      .put("reflectance", H5T_IEEE_F32LE, {channels, offsets, size, size}, H5T_NATIVE_FLOAT,
           values.data(), plist.get());
  const File file = open_file(folder.at("t.h5"));
  const RawFile raw(file.path, RawFile::Mode::read, file.path);
  const auto layout = locate_slices(file, open_dataset(file, "reflectance", "[C][D][H][W]"), raw);
  ASSERT_TRUE(layout.has_value());
  ASSERT_EQ(layout->slices.size(), channels * offsets);
  for (std::size_t i = 0; i < layout->slices.size(); ++i) {
    float first = -1;
    ASSERT_EQ(layout->slices[i].bytes, 16u);
    raw.read(layout->slices[i].address, &first, sizeof(first));
    ASSERT_EQ(first, values[4 * i]);
  }
}

TEST(TableFile, ReadsFromSeveralThreads) {
  const TestFolder folder("table");
  const BssrdfTable table = make_noise_table(make_test_header());
  save(folder.at("fast.h5"), table);
  save(folder.at("deflated.h5"), table, 1);
  {
    TestFile file = write_minimal_table(folder.at("slow.h5"), table);
    file.put("reflectance", H5T_IEEE_F64LE, table_shape(table.header), H5T_NATIVE_FLOAT,
             table.reflectance.data());
  }
  for (const char* name : {"fast.h5", "deflated.h5", "slow.h5"}) {
    const auto source = open_table(folder.at(name));
    const std::size_t slices = table.header.offsets.size() * 3;
    std::vector<float> values(slices * table.header.pixels());
    parallel_for(slices, [&](std::size_t i) {
      source->read_slice(static_cast<int>(i / table.header.offsets.size()),
                         static_cast<int>(i % table.header.offsets.size()),
                         &values[i * table.header.pixels()]);
    });
    expect_same_values(values, table.reflectance);
  }
}

// A file that another program wrote with h5py.
TEST(TableFile, OpensTheBundledStone) {
  const std::string path = PARIAN_SOURCE_DIR "/data/stone-72x64.h5";
  EXPECT_TRUE(is_fast(path));
  const auto source = open_table(path);
  EXPECT_EQ(source->header().width, 72);
  EXPECT_EQ(source->header().height, 64);
  EXPECT_EQ(source->header().channels, 3);
  EXPECT_EQ(source->header().offsets.size(), 307u);
  EXPECT_EQ(source->header().pixel_pitch_mm, 0.5);
  EXPECT_THAT(source->header().provenance, testing::HasSubstr("\"seed\":21"));
  std::vector<float> slice(source->header().pixels());
  source->read_slice(2, 306, slice.data());
  std::size_t measured = 0;
  for (const float value : slice) measured += value > 0 ? 1 : 0;
  EXPECT_GT(measured, 1000u);
}

// Outside the grid NaN is written whatever the caller has there; 0 would not be readable again.
TEST(TableFile, WritesWhatReadersAccept) {
  const TestFolder folder("table");
  TableHeader header = make_test_header(1);
  header.offsets = {{0, 0}, {2, 1}};
  const auto sink = create_table(folder.at("t.h5"), header);
  const std::vector<float> zeros(header.pixels(), 0.0f);
  sink->write_slice(0, 0, zeros.data());
  sink->write_slice(0, 1, zeros.data());
  EXPECT_EQ(folder.count(), 1u);  // the temporary
  EXPECT_FALSE(std::filesystem::exists(folder.at("t.h5")));
  sink->finish();
  std::vector<float> slice(header.pixels());
  open_table(folder.at("t.h5"))->read_slice(0, 1, slice.data());
  EXPECT_EQ(slice[0], std::numeric_limits<float>::min());
  EXPECT_TRUE(std::isnan(slice[3]));
  EXPECT_TRUE(std::isnan(slice[15]));
}

TEST(TableFile, UnfinishedTablesLeaveNothingBehind) {
  const TestFolder folder("table");
  write_text(folder.at("t.h5"), "old");
  const BssrdfTable table = make_noise_table(make_test_header());
  for (const int deflate : {0, 6}) {
    {
      const auto sink = create_table(folder.at("t.h5"), table.header, {.deflate = deflate});
      sink->write_slice(0, 0, slice_of(table, 0, 0));
      EXPECT_EQ(folder.count(), 2u);
      EXPECT_EQ(catch_error([&] { sink->finish(); }).kind, ErrorKind::contract);
      EXPECT_EQ(catch_error([&] { sink->write_slice(0, 0, slice_of(table, 0, 0)); }).kind,
                ErrorKind::contract);
    }
    EXPECT_EQ(folder.count(), 1u);
    EXPECT_EQ(read_file(folder.at("t.h5"), 9), "old");
  }
}

}  // namespace
}  // namespace parian

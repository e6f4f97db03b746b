// For tests and the fuzzer: HDF5 files written with the C API alone, as foreign writers do.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/random.h"
#include "io/hdf5/handle_internal.h"
#include "io/json/test_folder.h"
#include "material/bssrdf_table.h"

namespace parian::hdf5 {

// A file written through the C API.
struct TestFile {
  explicit TestFile(const std::string& path, hid_t create = H5P_DEFAULT, hid_t access = H5P_DEFAULT)
      : file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, create, access), H5Fclose) {}

  // Replaces an attribute of that name. Memory type = file type: `data` is what is stored.
  void set(const char* name, hid_t type, const void* data, const std::vector<hsize_t>& shape = {}) {
    remove_attribute(name);
    const Id space(make_space(shape), H5Sclose);
    const Id attribute(H5Acreate2(file.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose);
    if (attribute.valid() && data != nullptr) H5Awrite(attribute.get(), type, data);
  }
  void set(const char* name, double value) { set(name, H5T_NATIVE_DOUBLE, &value); }
  void set(const char* name, int value) { set(name, H5T_NATIVE_INT, &value); }
  void set(const char* name, const std::string& text) {
    const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), H5T_VARIABLE);
    H5Tset_cset(type.get(), H5T_CSET_UTF8);
    const char* data = text.c_str();
    set(name, type.get(), &data);
  }
  void set_fixed(const char* name, const std::string& text, std::size_t size, H5T_str_t pad) {
    const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), size);
    H5Tset_strpad(type.get(), pad);
    std::string padded = text;
    padded.resize(size, pad == H5T_STR_SPACEPAD ? ' ' : '\0');
    set(name, type.get(), padded.data());
  }
  void remove_attribute(const char* name) {
    if (H5Aexists(file.get(), name) > 0) H5Adelete(file.get(), name);
  }
  void remove_dataset(const char* name) {
    if (H5Lexists(file.get(), name, H5P_DEFAULT) > 0) H5Ldelete(file.get(), name, H5P_DEFAULT);
  }
  // Replaces a dataset; null data: nothing is written.
  void put(const char* name, hid_t file_type, const std::vector<hsize_t>& shape, hid_t memory_type,
           const void* data, hid_t plist = H5P_DEFAULT) {
    remove_dataset(name);
    const Id space(make_space(shape), H5Sclose);
    const Id dataset(
        H5Dcreate2(file.get(), name, file_type, space.get(), H5P_DEFAULT, plist, H5P_DEFAULT),
        H5Dclose);
    if (dataset.valid() && data != nullptr)
      H5Dwrite(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
  }
  static hid_t make_space(const std::vector<hsize_t>& shape) {
    return shape.empty() ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  }
  Id file;
};

// Positive noise inside the grid, a few missing values, NaN outside.
inline BssrdfTable make_noise_table(TableHeader header, std::uint64_t seed = 1) {
  BssrdfTable table = make_bssrdf_table(std::move(header));
  Rng rng = make_rng(seed);
  for (float& value : table.reflectance) {
    const double random = sample_uniform(rng);
    value = random < 0.1 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(random);
  }
  for (int c = 0; c < table.header.channels; ++c)
    for (int d = 0; d < static_cast<int>(table.header.offsets.size()); ++d)
      clean_slice(table.header, "", c, d, slice_of(table, c, d));
  return table;
}

inline TableHeader make_test_header(int channels = 3) {
  TableHeader header;
  header.width = 5;
  header.height = 4;
  header.channels = channels;
  header.pixel_pitch_mm = 0.25;
  header.offsets = half_disc_offsets(2);
  return header;
}

inline std::vector<int> flatten_offsets(const TableHeader& header) {
  std::vector<int> values;
  for (const Offset offset : header.offsets) {
    values.push_back(offset.dx);
    values.push_back(offset.dy);
  }
  return values;
}

inline std::vector<hsize_t> table_shape(const TableHeader& header) {
  return {static_cast<hsize_t>(header.channels), header.offsets.size(),
          static_cast<hsize_t>(header.height), static_cast<hsize_t>(header.width)};
}

// The least that a table must hold, contiguous, native types.
inline TestFile write_minimal_table(const std::string& path, const BssrdfTable& table) {
  TestFile file(path);
  file.set("format", std::string("parian-bssrdf-table"));
  file.set("version", 1);
  file.set("pixel_pitch_mm", table.header.pixel_pitch_mm);
  const std::vector<int> offsets = flatten_offsets(table.header);
  file.put("offsets", H5T_NATIVE_INT, {table.header.offsets.size(), 2}, H5T_NATIVE_INT,
           offsets.data());
  file.put("reflectance", H5T_IEEE_F32LE, table_shape(table.header), H5T_NATIVE_FLOAT,
           table.reflectance.data());
  return file;
}

}  // namespace parian::hdf5

#include "io/hdf5/read_internal.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/names.h"
#include "io/json/files.h"

namespace parian::hdf5 {
namespace {

constexpr std::size_t max_attribute_bytes = std::size_t{64} << 20;

std::string attribute_place(const std::string& name) {
  return "attribute '" + name + "'";
}

std::string describe_class(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
    case H5T_ENUM:
      return "whole numbers";
    case H5T_FLOAT:
      return "floating-point numbers";
    case H5T_STRING:
      return "a string";
    case H5T_COMPOUND:
      return "compound values";
    default:
      return "values of another type";
  }
}

struct Attribute {
  std::string place;
  Id id;
  Id type;
  std::size_t count = 0;
};

// Number of values of a dataspace, from its shape, without overflow.
std::size_t count_values(const File& file, const std::string& place, hid_t space) {
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (count < 0) throw_failure(file.path, place);
  return static_cast<std::size_t>(count);
}

std::optional<Attribute> open_attribute(const File& file, const std::string& name) {
  Attribute attribute{.place = attribute_place(name), .id = {}, .type = {}};
  const htri_t exists = H5Aexists(file.id.get(), name.c_str());
  if (exists < 0) throw_failure(file.path, attribute.place);
  if (exists == 0) return {};
  const auto need = [&](hid_t id) { return require(id, file.path, attribute.place); };
  attribute.id = Id(need(H5Aopen(file.id.get(), name.c_str(), H5P_DEFAULT)), H5Aclose);
  attribute.type = Id(need(H5Aget_type(attribute.id.get())), H5Tclose);
  const Id space(need(H5Aget_space(attribute.id.get())), H5Sclose);
  attribute.count = count_values(file, attribute.place, space.get());
  const std::size_t bytes = H5Tget_size(attribute.type.get());
  if (bytes == 0) throw_failure(file.path, attribute.place);
  if (attribute.count > max_attribute_bytes / bytes)
    throw Error({file.path, attribute.place, "an attribute of at most 64 MiB",
                 fmt::format("{} values of {} bytes", attribute.count, bytes)});
  return attribute;
}

// h5py writes True as an enumeration over a small integer: read such as that integer.
Id number_type(const File& file, const Attribute& attribute) {
  const H5T_class_t kind = H5Tget_class(attribute.type.get());
  const hid_t type =
      kind == H5T_ENUM ? H5Tget_super(attribute.type.get()) : H5Tcopy(attribute.type.get());
  Id number(require(type, file.path, attribute.place), H5Tclose);
  if (kind != H5T_ENUM && kind != H5T_INTEGER && kind != H5T_FLOAT)
    throw Error({file.path, attribute.place, "numbers", describe_class(attribute.type.get())});
  return number;
}

// The attribute's values converted to `memory_type`, each `size` bytes (at most 8).
std::vector<unsigned char> read_converted(const File& file, const Attribute& attribute,
                                          hid_t memory_type, std::size_t size) {
  const Id from = number_type(file, attribute);
  // H5Tconvert works in place: room for the wider of the two.
  const std::size_t stride = std::max(size, H5Tget_size(from.get()));
  std::vector<unsigned char> buffer(attribute.count * stride);
  if (attribute.count == 0) return buffer;
  if (H5Aread(attribute.id.get(), attribute.type.get(), buffer.data()) < 0 ||
      H5Tconvert(from.get(), memory_type, attribute.count, buffer.data(), nullptr, H5P_DEFAULT) < 0)
    throw_failure(file.path, attribute.place);
  return buffer;
}

void check_single(const File& file, const Attribute& attribute) {
  if (attribute.count != 1)
    throw Error(
        {file.path, attribute.place, "a single value", fmt::format("{} values", attribute.count)});
}

std::string read_variable_text(const File& file, const Attribute& attribute) {
  char* text = nullptr;
  if (H5Aread(attribute.id.get(), attribute.type.get(), &text) < 0)
    throw_failure(file.path, attribute.place);
  std::string copy = text == nullptr ? "" : text;
  H5free_memory(text);
  return copy;
}

std::string read_fixed_text(const File& file, const Attribute& attribute) {
  std::string text(H5Tget_size(attribute.type.get()), '\0');
  if (H5Aread(attribute.id.get(), attribute.type.get(), text.data()) < 0)
    throw_failure(file.path, attribute.place);
  text.resize(std::strlen(text.c_str()));
  if (H5Tget_strpad(attribute.type.get()) == H5T_STR_SPACEPAD)
    text.resize(text.find_last_not_of(' ') + 1);
  return text;
}

void check_regular_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw_read_error(path, errno);
  if (S_ISDIR(status.st_mode)) throw_read_error(path, EISDIR);
  if (!S_ISREG(status.st_mode))
    throw Error({.file = path, .expected = "an HDF5 file", .found = "a pipe or device"});
  if (::access(path.c_str(), R_OK) != 0) throw_read_error(path, errno);
}

}  // namespace

File open_file(const std::string& path) {
  check_regular_file(path);
  if (H5Fis_hdf5(path.c_str()) <= 0)
    throw Error({.file = path, .expected = "an HDF5 file", .found = "no HDF5 signature"});
  File file{path, Id(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose)};
  if (!file.id.valid())
    throw Error({.file = path,
                 .expected = "a whole HDF5 file",
                 .found = "a truncated or damaged one (" + last_failure().message + ")"});
  return file;
}

void check_format(const File& file, const std::string& format) {
  const std::optional<std::string> found = find_text(file, "format");
  if (found != format)
    throw Error({file.path, attribute_place("format"), "'" + format + "'",
                 found ? "'" + found->substr(0, 60) + "'" : "no such attribute"});
  const double version = get_number(file, "version");
  if (version != 1)
    throw Error({file.path, attribute_place("version"), "1", fmt::format("{}", version)});
}

std::optional<std::string> find_text(const File& file, const std::string& name) {
  const std::optional<Attribute> attribute = open_attribute(file, name);
  if (!attribute) return {};
  const hid_t type = attribute->type.get();
  if (H5Tget_class(type) != H5T_STRING)
    throw Error({file.path, attribute->place, "a string", describe_class(type)});
  check_single(file, *attribute);
  return H5Tis_variable_str(type) > 0 ? read_variable_text(file, *attribute)
                                      : read_fixed_text(file, *attribute);
}

std::optional<std::vector<double>> find_numbers(const File& file, const std::string& name) {
  const std::optional<Attribute> attribute = open_attribute(file, name);
  if (!attribute) return {};
  const auto bytes = read_converted(file, *attribute, H5T_NATIVE_DOUBLE, sizeof(double));
  std::vector<double> values(attribute->count);
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
  return values;
}

std::optional<double> find_number(const File& file, const std::string& name) {
  const std::optional<std::vector<double>> values = find_numbers(file, name);
  if (!values) return {};
  if (values->size() != 1)
    throw Error({file.path, attribute_place(name), "a single value",
                 fmt::format("{} values", values->size())});
  return values->front();
}

std::optional<std::uint64_t> find_u64(const File& file, const std::string& name) {
  const std::optional<Attribute> attribute = open_attribute(file, name);
  if (!attribute) return {};
  check_single(file, *attribute);
  const auto bytes = read_converted(file, *attribute, H5T_NATIVE_UINT64, sizeof(std::uint64_t));
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

double get_number(const File& file, const std::string& name) {
  if (const std::optional<double> value = find_number(file, name)) return *value;
  throw Error({file.path, attribute_place(name), "a number", "no such attribute"});
}

int find_choice(const File& file, const std::string& name, const std::vector<std::string>& choices,
                int otherwise) {
  const std::optional<std::string> text = find_text(file, name);
  if (!text) return otherwise;
  const auto found = std::find(choices.begin(), choices.end(), *text);
  if (found == choices.end())
    throw Error(
        {file.path, attribute_place(name), list_names(choices), "'" + text->substr(0, 60) + "'"});
  return static_cast<int>(found - choices.begin());
}

bool has_dataset(const File& file, const std::string& name) {
  return H5Lexists(file.id.get(), name.c_str(), H5P_DEFAULT) > 0;
}

std::string describe_shape(const std::vector<std::uint64_t>& shape) {
  if (shape.empty()) return "a single value";
  std::string text;
  for (const std::uint64_t size : shape) text += fmt::format("[{}]", size);
  return text;
}

Dataset open_dataset(const File& file, const std::string& name, const std::string& axes,
                     Numbers numbers) {
  Dataset dataset{.place = "dataset '" + name + "'", .id = {}, .type = {}, .shape = {}};
  const auto fail = [&](const std::string& expected, const std::string& found) {
    throw Error({file.path, dataset.place, expected, found});
  };
  if (!has_dataset(file, name)) fail("shape " + axes, "no such dataset");
  dataset.id = Id(H5Dopen2(file.id.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.id.valid()) fail("a dataset", "something else (" + last_failure().message + ")");
  const auto need = [&](hid_t id) { return require(id, file.path, dataset.place); };
  dataset.type = Id(need(H5Dget_type(dataset.id.get())), H5Tclose);
  const Id space(need(H5Dget_space(dataset.id.get())), H5Sclose);
  if (H5Sget_simple_extent_type(space.get()) == H5S_NULL) fail("shape " + axes, "no values");
  const int rank = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> sizes(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank < 0 || H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr) < 0)
    throw_failure(file.path, dataset.place);
  dataset.shape.assign(sizes.begin(), sizes.end());
  if (rank != std::count(axes.begin(), axes.end(), '['))
    fail("shape " + axes, describe_shape(dataset.shape));
  const H5T_class_t kind = H5Tget_class(dataset.type.get());
  if (kind != H5T_INTEGER && (numbers == Numbers::whole || kind != H5T_FLOAT))
    fail(numbers == Numbers::whole ? "whole numbers" : "numbers",
         describe_class(dataset.type.get()));
  return dataset;
}

// HDF5 allocates whole chunks, however few bytes they are stored in.
static void check_chunk_size(const File& file, const Dataset& dataset, hid_t plist) {
  if (H5Pget_layout(plist) != H5D_CHUNKED) return;
  std::vector<hsize_t> sizes(dataset.shape.size());
  if (H5Pget_chunk(plist, static_cast<int>(sizes.size()), sizes.data()) < 0)
    throw_failure(file.path, dataset.place);
  auto bytes = static_cast<double>(H5Tget_size(dataset.type.get()));
  for (const hsize_t size : sizes) bytes *= static_cast<double>(size);
  if (bytes > 0x1p30)
    throw Error({file.path, dataset.place, "chunks of at most 1 GiB",
                 fmt::format("chunks of {:.0f} bytes", bytes)});
}

void check_stored(const File& file, const Dataset& dataset, std::uint64_t values) {
  const Id plist(require(H5Dget_create_plist(dataset.id.get()), file.path, dataset.place),
                 H5Pclose);
  if (H5Pget_external_count(plist.get()) > 0)
    throw Error({file.path, dataset.place, "values inside the file", "external storage"});
  check_chunk_size(file, dataset, plist.get());
  // Deflate, the densest filter in use, makes data at most 1032 times smaller.
  constexpr double most_compressed = 1032;
  const auto stored = static_cast<double>(H5Dget_storage_size(dataset.id.get()));
  const double needed = 4.0 * static_cast<double>(values) / most_compressed;
  if (stored < needed || (stored == 0 && values > 0))
    throw Error({file.path, dataset.place,
                 fmt::format("stored values for the shape {}", describe_shape(dataset.shape)),
                 fmt::format("{} bytes", stored)});
}

template <typename T>
std::vector<T> read_all(const File& file, const Dataset& dataset) {
  double values = 1;
  for (const std::uint64_t size : dataset.shape) values *= static_cast<double>(size);
  if (values > 0x1p40)
    throw Error({file.path, dataset.place, "fewer values", describe_shape(dataset.shape)});
  check_stored(file, dataset, static_cast<std::uint64_t>(values));
  std::vector<T> data(static_cast<std::size_t>(values));
  const hid_t type = std::is_same_v<T, float>    ? H5T_NATIVE_FLOAT
                     : std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE
                                                 : H5T_NATIVE_INT64;
  if (!data.empty() &&
      H5Dread(dataset.id.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()) < 0)
    throw_failure(file.path, dataset.place);
  return data;
}

template std::vector<float> read_all(const File&, const Dataset&);
template std::vector<double> read_all(const File&, const Dataset&);
template std::vector<std::int64_t> read_all(const File&, const Dataset&);

}  // namespace parian::hdf5

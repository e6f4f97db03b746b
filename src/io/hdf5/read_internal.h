// Reading attributes and datasets of any numeric width, byte order and string kind. All functions
// are called under a Guard; errors name the file and the attribute or dataset.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/handle_internal.h"
#include "material/slices.h"

namespace parian::hdf5 {

struct File {
  std::string path;
  Id id;
};

// Tells apart: no such file, not HDF5, truncated or damaged.
File open_file(const std::string& path);
// The root attributes "format" and "version".
void check_format(const File& file, const std::string& format);

// Root attributes; empty when there is none of that name.
std::optional<std::string> find_text(const File& file, const std::string& name);
std::optional<std::vector<double>> find_numbers(const File& file, const std::string& name);
std::optional<double> find_number(const File& file, const std::string& name);
// A whole number of 64 bits, for seeds.
std::optional<std::uint64_t> find_u64(const File& file, const std::string& name);
double get_number(const File& file, const std::string& name);
// Index of the text among the choices; `otherwise` when there is no such attribute.
int find_choice(const File& file, const std::string& name, const std::vector<std::string>& choices,
                int otherwise);

struct Dataset {
  std::string place;  // "dataset 'offsets'"
  Id id;
  Id type;
  std::vector<std::uint64_t> shape;

  std::uint64_t size(int axis) const { return shape[static_cast<std::size_t>(axis)]; }
};

enum class Numbers { any, whole };
// `axes` is how errors state the expected shape, "[D][2]"; its brackets are the rank.
Dataset open_dataset(const File& file, const std::string& name, const std::string& axes,
                     Numbers numbers = Numbers::any);
bool has_dataset(const File& file, const std::string& name);
// "[307][2]"
std::string describe_shape(const std::vector<std::uint64_t>& shape);

// Throws unless the file holds enough bytes to fill `values` 4-byte values of the dataset, by any
// compression: what a shape claims is not allocated before.
void check_stored(const File& file, const Dataset& dataset, std::uint64_t values);
// The whole dataset, converted; T is float, double or std::int64_t. Checks what is stored first.
template <typename T>
std::vector<T> read_all(const File& file, const Dataset& dataset);

}  // namespace parian::hdf5

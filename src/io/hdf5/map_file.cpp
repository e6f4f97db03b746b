#include "io/hdf5/map_file.h"

#include <fmt/format.h>

#include "base/error.h"
#include "io/hdf5/read_internal.h"
#include "io/hdf5/write_internal.h"

namespace parian {
namespace {

using namespace hdf5;

constexpr std::uint64_t max_size = 65535;  // of the grid
constexpr std::uint64_t max_knots = 4096;

void read_profiles(const File& file, ProfileMap& map) {
  const Dataset dataset = open_dataset(file, "log_profile", "[C][K][H][W]");
  const auto& shape = dataset.shape;
  const bool fits = (shape[0] == 1 || shape[0] == 3) && shape[1] >= 2 && shape[1] <= max_knots &&
                    shape[2] >= 1 && shape[2] <= max_size && shape[3] >= 1 && shape[3] <= max_size;
  if (!fits)
    throw Error({file.path, dataset.place,
                 "shape [C][K][H][W] with C = 1 or 3, K in [2, 4096], H and W in [1, 65535]",
                 describe_shape(shape)});
  const Dataset knots = open_dataset(file, "knots_mm", "[K]");
  if (knots.size(0) != shape[1])
    throw Error({file.path, knots.place,
                 fmt::format("shape [{}], as 'log_profile' has {} knots", shape[1], shape[1]),
                 describe_shape(knots.shape)});
  map.channels = static_cast<int>(shape[0]);
  map.height = static_cast<int>(shape[2]);
  map.width = static_cast<int>(shape[3]);
  map.knots_mm = read_all<double>(file, knots);
  map.log_profile = read_all<float>(file, dataset);
}

std::vector<float> read_plane(const File& file, const std::string& name, const ProfileMap& map) {
  if (!has_dataset(file, name)) return {};
  const Dataset dataset = open_dataset(file, name, "[C][H][W]");
  const std::vector<std::uint64_t> expected{static_cast<std::uint64_t>(map.channels),
                                            static_cast<std::uint64_t>(map.height),
                                            static_cast<std::uint64_t>(map.width)};
  if (dataset.shape != expected)
    throw Error({file.path, dataset.place,
                 fmt::format("shape {}, as of 'log_profile'", describe_shape(expected)),
                 describe_shape(dataset.shape)});
  return read_all<float>(file, dataset);
}

HoldOut read_hold_out(const File& file) {
  HoldOut hold_out;
  hold_out.fraction = find_number(file, "hold_out_fraction").value_or(0);
  if (!(hold_out.fraction >= 0 && hold_out.fraction < 1))
    throw Error({file.path, "attribute 'hold_out_fraction'", "a fraction in [0, 1)",
                 fmt::format("{}", hold_out.fraction)});
  hold_out.seed = find_u64(file, "hold_out_seed").value_or(hold_out.seed);
  return hold_out;
}

}  // namespace

ProfileMap load_profile_map(const std::string& path) {
  const Guard guard;
  const File file = open_file(path);
  check_format(file, "parian-profile-map");
  ProfileMap map;
  map.pixel_pitch_mm = get_number(file, "pixel_pitch_mm");
  map.boundary = find_choice(file, "boundary", {"excluded", "included"}, 0) == 1
                     ? Boundary::included
                     : Boundary::excluded;
  map.eta = find_number(file, "eta").value_or(map.eta);
  if (!(map.eta >= 1 && map.eta <= 4))
    throw Error(
        {path, "attribute 'eta'", "a refractive index in [1, 4]", fmt::format("{}", map.eta)});
  map.hold_out = read_hold_out(file);
  map.provenance = find_text(file, "provenance").value_or("");
  read_profiles(file, map);
  map.gain = read_plane(file, "gain", map);
  map.dilation = read_plane(file, "dilation", map);
  check(map, path);
  return map;
}

void save_profile_map(const std::string& path, const ProfileMap& map) {
  check(map, path);
  const Guard guard;
  NewFile file(path);
  file.create();
  file.write_text("format", "parian-profile-map");
  file.write_int("version", 1);
  file.write_number("pixel_pitch_mm", map.pixel_pitch_mm);
  file.write_text("boundary", map.boundary == Boundary::included ? "included" : "excluded");
  file.write_number("eta", map.eta);
  if (map.hold_out.fraction > 0) {
    file.write_number("hold_out_fraction", map.hold_out.fraction);
    file.write_u64("hold_out_seed", map.hold_out.seed);
  }
  file.write_text("provenance", map.provenance);
  const auto channels = static_cast<hsize_t>(map.channels);
  const auto height = static_cast<hsize_t>(map.height), width = static_cast<hsize_t>(map.width);
  const hsize_t knots = map.knots_mm.size();
  file.add_dataset("knots_mm", H5T_NATIVE_DOUBLE, {knots}, map.knots_mm.data());
  file.add_dataset("log_profile", H5T_NATIVE_FLOAT, {channels, knots, height, width},
                   map.log_profile.data());
  if (!map.gain.empty())
    file.add_dataset("gain", H5T_NATIVE_FLOAT, {channels, height, width}, map.gain.data());
  if (!map.dilation.empty())
    file.add_dataset("dilation", H5T_NATIVE_FLOAT, {channels, height, width}, map.dilation.data());
  file.close_hdf5();
  file.commit();
}

std::string read_format(const std::string& path) {
  const Guard guard;
  try {
    return find_text(open_file(path), "format").value_or("");
  } catch (const Error& error) {
    const bool other =
        error.parts.expected == "an HDF5 file" || error.parts.place == "attribute 'format'";
    if (other) return {};
    throw;
  }
}

}  // namespace parian

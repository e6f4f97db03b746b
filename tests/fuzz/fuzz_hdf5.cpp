// HDF5 files of the right format with wrong types, shapes, attributes and values, or cut short. All
// are valid for HDF5 itself.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "fuzz_case.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/photon_file.h"
#include "io/hdf5/table_file.h"
#include "io/hdf5/test_files_internal.h"
#include "io/hdf5/transport_file.h"

namespace parian::fuzz {
namespace {

namespace fs = std::filesystem;

hid_t odd_type(Case& c) {
  return c.pick<hid_t>({H5T_NATIVE_INT, H5T_NATIVE_SCHAR, H5T_STD_U64BE, H5T_NATIVE_FLOAT,
                        H5T_IEEE_F64BE, H5T_IEEE_F32BE, H5T_NATIVE_LDOUBLE, H5T_NATIVE_HBOOL,
                        H5T_STD_B16LE, H5T_STD_REF_OBJ, H5T_UNIX_D32LE});
}

std::vector<hsize_t> odd_shape(Case& c) {
  std::vector<hsize_t> shape(c.below(6));
  for (hsize_t& size : shape) size = c.pick<hsize_t>({0, 1, 2, 3, 4, 5, 7, 16});
  return shape;
}

std::size_t count_of(const std::vector<hsize_t>& shape) {
  std::size_t count = 1;
  for (const hsize_t size : shape) count *= static_cast<std::size_t>(size);
  return count;
}

// Bytes enough for `count` values of any of the types above.
std::vector<double> odd_data(Case& c, std::size_t count) {
  std::vector<double> data(2 * count + 2);
  for (double& value : data) value = odd_number(c);
  return data;
}

void mutate_attribute(Case& c, hdf5::TestFile& file,
                      std::initializer_list<std::string> names = {
                          "format", "version", "pixel_pitch_mm", "boundary", "eta", "symmetric",
                          "sampling", "noise_floor", "noise_gain", "provenance",
                          "hold_out_fraction", "hold_out_seed"}) {
  const auto name = c.pick<std::string>(names);
  const std::size_t kind = c.below(6);
  c.note(fmt::format("attribute {} kind {}", name, kind));
  if (kind == 0) return file.remove_attribute(name.c_str());
  if (kind == 1)
    return file.set(name.c_str(), c.pick<std::string>({"", "included", "area", "\xff\xfe", "parian",
                                                       std::string(5000, 'z')}));
  if (kind == 2) return file.set(name.c_str(), odd_number(c));
  if (kind == 3) {
    const double bad = c.pick<double>({NAN, INFINITY, -INFINITY});
    return file.set(name.c_str(), bad);
  }
  if (kind == 4)
    return file.set_fixed(name.c_str(), "included", 1 + c.below(12),
                          c.one_in(2) ? H5T_STR_SPACEPAD : H5T_STR_NULLPAD);
  const std::vector<hsize_t> shape = odd_shape(c);
  if (count_of(shape) > 2000) return;
  file.set(name.c_str(), odd_type(c), odd_data(c, count_of(shape)).data(), shape);
}

hid_t make_odd_plist(Case& c, const std::vector<hsize_t>& shape) {
  const hid_t plist = H5Pcreate(H5P_DATASET_CREATE);
  const bool chunkable = !shape.empty() && count_of(shape) > 0;
  if (!chunkable || c.one_in(3)) return plist;
  std::vector<hsize_t> chunk;
  chunk.reserve(shape.size());
  for (const hsize_t size : shape) chunk.push_back(1 + c.below(static_cast<std::size_t>(size)));
  if (shape.size() == 4 && c.one_in(2)) chunk = {1, 1, shape[2], shape[3]};
  H5Pset_chunk(plist, static_cast<int>(chunk.size()), chunk.data());
  if (c.one_in(2)) H5Pset_shuffle(plist);
  if (c.one_in(2)) H5Pset_deflate(plist, 1);
  if (c.one_in(4)) H5Pset_fletcher32(plist);
  return plist;
}

void mutate_dataset(Case& c, hdf5::TestFile& file, const std::vector<std::string>& names,
                    const std::vector<std::vector<hsize_t>>& shapes) {
  const std::size_t which = c.below(names.size());
  const char* name = names[which].c_str();
  if (c.one_in(6)) {
    c.note(fmt::format("dataset {} removed", name));
    file.remove_dataset(name);
    if (c.one_in(2)) {
      const hdf5::Id group(H5Gcreate2(file.file.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           H5Gclose);
    }
    return;
  }
  std::vector<hsize_t> shape = shapes[which];
  if (c.one_in(3)) shape = odd_shape(c);
  if (!shape.empty() && c.one_in(3))
    shape[c.below(shape.size())] = c.pick<hsize_t>({0, 1, 2, 3, 9});
  if (count_of(shape) > 20000) return;
  const hid_t type = c.one_in(2) ? odd_type(c) : H5T_IEEE_F32LE;
  const hdf5::Id plist(make_odd_plist(c, shape), H5Pclose);
  c.note(fmt::format("dataset {} shape {}", name, fmt::join(shape, "x")));
  const std::vector<double> data = odd_data(c, count_of(shape));
  file.put(name, type, shape, type, c.one_in(5) ? nullptr : data.data(), plist.get());
}

void truncate_file(Case& c, const std::string& path) {
  if (!c.one_in(4)) return;
  const std::size_t size = static_cast<std::size_t>(fs::file_size(path));
  const std::size_t rest = c.below(size);
  c.note(fmt::format("truncated to {}", rest));
  fs::resize_file(path, rest);
}

}  // namespace

void fuzz_table(Case& c) {
  static const BssrdfTable table = hdf5::make_noise_table(hdf5::make_test_header());
  const std::string path = c.at("table.h5");
  {
    const hdf5::Guard guard;
    hdf5::TestFile file = hdf5::write_minimal_table(path, table);
    for (std::size_t edits = c.below(3); edits > 0; --edits) mutate_attribute(c, file);
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_dataset(c, file, {"offsets", "reflectance"},
                     {{table.header.offsets.size(), 2}, hdf5::table_shape(table.header)});
  }
  truncate_file(c, path);
  const BssrdfTable read = read_table(*open_table(path));
  for (const float value : read.reflectance)
    if (std::isinf(value)) throw std::logic_error("an infinite value was accepted");
}

void fuzz_map(Case& c) {
  static const ProfileMap map = make_profile_map(4, 3, 3, 0.5, {0, 0.5, 1}, -1);
  const std::string path = c.at("map.h5");
  {
    const hdf5::Guard guard;
    hdf5::TestFile file(path);
    file.set("format", std::string("parian-profile-map"));
    file.set("version", 1);
    file.set("pixel_pitch_mm", 0.5);
    file.put("knots_mm", H5T_NATIVE_DOUBLE, {3}, H5T_NATIVE_DOUBLE, map.knots_mm.data());
    file.put("log_profile", H5T_NATIVE_FLOAT, {3, 3, 3, 4}, H5T_NATIVE_FLOAT,
             map.log_profile.data());
    for (std::size_t edits = c.below(3); edits > 0; --edits) mutate_attribute(c, file);
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_dataset(c, file, {"knots_mm", "log_profile", "gain", "dilation"},
                     {{3}, {3, 3, 3, 4}, {3, 3, 4}, {3, 3, 4}});
  }
  truncate_file(c, path);
  check(load_profile_map(path), path);
}

void fuzz_transport(Case& c) {
  const std::string path = c.at("transport.h5");
  const std::vector<double> knots{0, 1, 4};
  const std::vector<float> values(5 * 3 * 12, 0.5f);
  {
    const hdf5::Guard guard;
    hdf5::TestFile file(path);
    file.set("format", std::string("parian-transport"));
    file.set("version", 1);
    file.set("eta", 1.3);
    for (const char* name :
         {"mesh_hash", "parameter_hash", "lights", "lights_done", "light_hash_1"}) {
      const std::uint64_t one = 1;
      file.set(name, H5T_NATIVE_UINT64, &one);
    }
    const std::uint64_t places = 5;
    file.set("places", H5T_NATIVE_UINT64, &places);
    file.put("multiple_knots_mm", H5T_NATIVE_DOUBLE, {3}, H5T_NATIVE_DOUBLE, knots.data());
    file.put("single_knots_mm", H5T_NATIVE_DOUBLE, {3}, H5T_NATIVE_DOUBLE, knots.data());
    file.put("multiple_1", H5T_NATIVE_FLOAT, {5, 3, 3}, H5T_NATIVE_FLOAT, values.data());
    file.put("multiple_1_scale", H5T_NATIVE_FLOAT, {3}, H5T_NATIVE_FLOAT, values.data());
    file.put("single_1", H5T_NATIVE_FLOAT, {5, 3, 12}, H5T_NATIVE_FLOAT, values.data());
    file.put("single_1_scale", H5T_NATIVE_FLOAT, {3}, H5T_NATIVE_FLOAT, values.data());
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_attribute(c, file,
                       {"format", "version", "eta", "knots", "degree", "places", "mesh_hash",
                        "lights", "lights_done", "light_hash_1", "light_1", "provenance"});
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_dataset(c, file,
                     {"multiple_knots_mm", "single_knots_mm", "multiple_1", "multiple_1_scale",
                      "single_1", "single_1_scale"},
                     {{3}, {3}, {5, 3, 3}, {3}, {5, 3, 12}, {3}});
  }
  truncate_file(c, path);
  const TransportFile read = load_transport(path);
  for (const LightTransport& light : read.transport.lights)
    if (light.multiple.places != read.transport.places)
      throw std::logic_error("transport of other places was accepted");
}

namespace {

// 4 x 3 pixels, radius 1: 3 offsets of one channel.
PhotonSimulation make_simulation() {
  const Document material =
      Document::Object{{"name", "all"}, {"sigma_a", 0.1}, {"sigma_s_prime", 1}};
  const Document description = Document::Object{{"name", "plain"},
                                                {"materials", Document::Array{material}},
                                                {"layout", Document::Object{{"kind", "uniform"}}},
                                                {"channels", 1},
                                                {"pitch_mm", 1},
                                                {"size", Document::Array{4, 3}},
                                                {"radius_px", 1}};
  return {read_sample(description, {}), {.photons = 16}};
}

}  // namespace

void fuzz_photons(Case& c) {
  static const PhotonSimulation simulation = make_simulation();
  const std::string path = c.at("photons.h5");
  const std::vector<float> values(3 * 3 * 4, 0.5f);
  const std::vector<double> totals(11, 0.5);
  {
    const hdf5::Guard guard;
    hdf5::TestFile file(path);
    file.set("format", std::string("parian-photon-progress"));
    file.set("version", 1);
    const std::uint64_t fingerprint = simulation.fingerprint(), steps = 3;
    file.set("fingerprint", H5T_NATIVE_UINT64, &fingerprint);
    file.set("steps", H5T_NATIVE_UINT64, &steps);
    file.put("totals", H5T_NATIVE_DOUBLE, {1, 11}, H5T_NATIVE_DOUBLE, totals.data());
    for (const char* name : {"forward_1", "backward_1", "squares_1"})
      file.put(name, H5T_NATIVE_FLOAT, {3, 3, 4}, H5T_NATIVE_FLOAT, values.data());
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_attribute(c, file, {"format", "version", "fingerprint", "steps"});
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_dataset(c, file, {"totals", "forward_1", "backward_1", "squares_1"},
                     {{1, 11}, {3, 3, 4}, {3, 3, 4}, {3, 3, 4}});
  }
  truncate_file(c, path);
  check_progress(simulation, load_photon_progress(path, simulation), path);
}

}  // namespace parian::fuzz

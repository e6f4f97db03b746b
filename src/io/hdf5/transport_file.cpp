#include "io/hdf5/transport_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/hdf5/read_internal.h"
#include "io/hdf5/write_internal.h"

namespace parian {
namespace {

using namespace hdf5;

constexpr std::uint64_t max_places = 100'000'000, max_functions = 66, max_lights = 4096;

// IEEE 754 binary16, as NumPy's float16: HDF5 1.10 has no name for it.
Id make_half_type() {
  Id type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
  H5Tset_fields(type.get(), 15, 10, 5, 0, 10);
  H5Tset_ebias(type.get(), 15);
  H5Tset_size(type.get(), 2);
  return type;
}

std::size_t blocked_index(const PackedTransport& packed, std::size_t place, std::size_t i) {
  const std::size_t row = packed.functions * packed.components;
  return (place / transport_lanes * row + i) * transport_lanes + place % transport_lanes;
}

// [place][function][component], as the file has it.
std::vector<std::uint16_t> to_rows(const PackedTransport& packed) {
  const std::size_t row = packed.functions * packed.components;
  std::vector<std::uint16_t> rows(packed.places * row);
  for (std::size_t place = 0; place < packed.places; ++place)
    for (std::size_t i = 0; i < row; ++i)
      rows[place * row + i] = packed.half[blocked_index(packed, place, i)];
  return rows;
}

struct Wanted {
  std::string name;  // "multiple_1"
  std::uint64_t places, functions, components;
};

std::vector<std::uint16_t> read_rows(const File& file, const Wanted& wanted) {
  const Dataset dataset = open_dataset(file, wanted.name, "[V][J][K]");
  const std::vector<std::uint64_t> shape{wanted.places, wanted.functions, wanted.components};
  if (dataset.shape != shape)
    throw Error({file.path, dataset.place, "shape " + describe_shape(shape),
                 describe_shape(dataset.shape)});
  const std::uint64_t count = wanted.places * wanted.functions * wanted.components;
  check_stored(file, dataset, count);
  std::vector<std::uint16_t> rows(count);
  const Id type = make_half_type();
  if (H5Dread(dataset.id.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()) < 0)
    throw Error({file.path, dataset.place, "readable values", "damaged data"});
  for (std::size_t i = 0; i < rows.size(); ++i)
    if ((rows[i] & 0x7c00u) == 0x7c00u)
      throw Error({file.path,
                   fmt::format("{}, [{}][{}][{}]", dataset.place,
                               i / (wanted.functions * wanted.components),
                               i / wanted.components % wanted.functions, i % wanted.components),
                   "a finite value", "NaN or infinity"});
  return rows;
}

PackedTransport read_packed(const File& file, const Wanted& wanted) {
  PackedTransport packed{.places = wanted.places,
                         .functions = wanted.functions,
                         .components = wanted.components,
                         .scale = {},
                         .half = {}};
  const std::vector<std::uint16_t> rows = read_rows(file, wanted);
  const std::size_t row = packed.functions * packed.components;
  const std::size_t blocks = (packed.places + transport_lanes - 1) / transport_lanes;
  packed.half.assign(blocks * transport_lanes * row, 0);
  for (std::size_t place = 0; place < packed.places; ++place)
    for (std::size_t i = 0; i < row; ++i)
      packed.half[blocked_index(packed, place, i)] = rows[place * row + i];
  const Dataset scale = open_dataset(file, wanted.name + "_scale", "[J]");
  if (scale.size(0) != wanted.functions)
    throw Error({file.path, scale.place, fmt::format("shape [{}]", wanted.functions),
                 describe_shape(scale.shape)});
  packed.scale = read_all<float>(file, scale);
  for (const float value : packed.scale)
    if (!(value > 0 && std::isfinite(value)))
      throw Error({file.path, scale.place, "finite values above 0", fmt::format("{}", value)});
  return packed;
}

SplineBasis read_basis(const File& file, const std::string& name, int degree) {
  const Dataset dataset = open_dataset(file, name, "[m + 1]");
  const std::uint64_t count = dataset.size(0);
  if (count < 2 || count + static_cast<std::uint64_t>(degree) > max_functions)
    throw Error({file.path, dataset.place, "2 to 65 knots", fmt::format("{}", count)});
  SplineBasis basis{.degree = degree, .knots = read_all<double>(file, dataset)};
  for (std::size_t k = 0; k < basis.knots.size(); ++k) {
    const bool fits = k == 0 ? basis.knots[0] == 0 : basis.knots[k] > basis.knots[k - 1];
    if (!fits || !std::isfinite(basis.knots[k]))
      throw Error({file.path, fmt::format("{}, [{}]", dataset.place, k), "increasing knots from 0",
                   fmt::format("{}", basis.knots[k])});
  }
  return basis;
}

std::uint64_t get_u64(const File& file, const std::string& name, std::uint64_t most) {
  const auto value = find_u64(file, name);
  if (!value || *value > most)
    throw Error({file.path, fmt::format("attribute '{}'", name),
                 fmt::format("a whole number up to {}", most),
                 value ? fmt::format("{}", *value) : "no such attribute"});
  return *value;
}

constexpr std::uint64_t any = ~std::uint64_t{0};

LightTransport read_light(const File& file, const HomogeneousTransport& transport, std::size_t i) {
  LightTransport light;
  light.name = find_text(file, fmt::format("light_{}", i + 1)).value_or("");
  light.multiple = read_packed(file, {fmt::format("multiple_{}", i + 1), transport.places,
                                      transport.multiple_basis.size(), 3});
  const std::string single = fmt::format("single_{}", i + 1);
  if (has_dataset(file, single))
    light.single = read_packed(file, {single, transport.places, transport.single_basis.size(), 12});
  return light;
}

}  // namespace

TransportFile load_transport(const std::string& path) {
  const Guard guard;
  const File file = open_file(path);
  check_format(file, "parian-transport");
  TransportFile loaded;
  HomogeneousTransport& transport = loaded.transport;
  transport.eta = get_number(file, "eta");
  if (!(transport.eta >= 1 && transport.eta <= 4))
    throw Error({path, "attribute 'eta'", "a refractive index in [1, 4]",
                 fmt::format("{}", transport.eta)});
  transport.knots = find_choice(file, "knots", {"balanced", "published"}, 0) == 1
                        ? KnotChoice::published
                        : KnotChoice::balanced;
  const int degree = 1 + find_choice(file, "degree", {"linear", "quadratic"}, 0);
  transport.places = get_u64(file, "places", max_places);
  transport.multiple_basis = read_basis(file, "multiple_knots_mm", degree);
  transport.single_basis = read_basis(file, "single_knots_mm", degree);
  loaded.provenance = find_text(file, "provenance").value_or("");
  loaded.fingerprint.mesh = get_u64(file, "mesh_hash", any);
  loaded.fingerprint.parameters = get_u64(file, "parameter_hash", any);
  const std::uint64_t lights = get_u64(file, "lights", max_lights);
  const std::uint64_t done = get_u64(file, "lights_done", lights);
  for (std::uint64_t i = 0; i < lights; ++i)
    loaded.fingerprint.lights.push_back(get_u64(file, fmt::format("light_hash_{}", i + 1), any));
  for (std::uint64_t i = 0; i < done; ++i)
    transport.lights.push_back(read_light(file, transport, i));
  return loaded;
}

void save_transport(const std::string& path, const TransportFile& saved) {
  const Guard guard;
  const HomogeneousTransport& transport = saved.transport;
  const Id half = make_half_type();
  NewFile file(path);
  file.create();
  file.write_text("format", "parian-transport");
  file.write_int("version", 1);
  file.write_number("eta", transport.eta);
  file.write_text("knots", transport.knots == KnotChoice::published ? "published" : "balanced");
  file.write_text("degree", transport.multiple_basis.degree == 2 ? "quadratic" : "linear");
  file.write_u64("places", transport.places);
  file.write_u64("mesh_hash", saved.fingerprint.mesh);
  file.write_u64("parameter_hash", saved.fingerprint.parameters);
  file.write_u64("lights", saved.fingerprint.lights.size());
  file.write_u64("lights_done", transport.lights.size());
  for (std::size_t i = 0; i < saved.fingerprint.lights.size(); ++i)
    file.write_u64(fmt::format("light_hash_{}", i + 1).c_str(), saved.fingerprint.lights[i]);
  file.write_text("provenance", saved.provenance);
  const auto add_knots = [&](const char* name, const SplineBasis& basis) {
    file.add_dataset(name, H5T_NATIVE_DOUBLE, {basis.knots.size()}, basis.knots.data());
  };
  add_knots("multiple_knots_mm", transport.multiple_basis);
  add_knots("single_knots_mm", transport.single_basis);
  std::vector<std::vector<std::uint16_t>> rows;  // stay until the file is closed
  rows.reserve(2 * transport.lights.size());
  const auto add = [&](const std::string& name, const PackedTransport& packed) {
    if (packed.functions == 0) return;
    rows.push_back(to_rows(packed));
    file.add_dataset(name.c_str(), half.get(), {packed.places, packed.functions, packed.components},
                     rows.back().data());
    file.add_dataset((name + "_scale").c_str(), H5T_NATIVE_FLOAT, {packed.functions},
                     packed.scale.data());
  };
  for (std::size_t i = 0; i < transport.lights.size(); ++i) {
    const LightTransport& light = transport.lights[i];
    file.write_text(fmt::format("light_{}", i + 1).c_str(), light.name);
    add(fmt::format("multiple_{}", i + 1), light.multiple);
    add(fmt::format("single_{}", i + 1), light.single);
  }
  file.close_hdf5();
  file.commit();
}

void check_fingerprint(const TransportFile& file, const std::string& path,
                       const TransportFingerprint& expected, bool with_parameters) {
  const auto fail = [&](const std::string& place, const std::string& what) {
    throw Error({path, place, what, "that of another"});
  };
  if (file.fingerprint.mesh != expected.mesh)
    fail("attribute 'mesh_hash'", "the hash of the scene's mesh");
  if (file.fingerprint.lights.size() != expected.lights.size())
    throw Error({path, "attribute 'lights'",
                 fmt::format("{}, as the scene has", expected.lights.size()),
                 fmt::format("{}", file.fingerprint.lights.size())});
  for (std::size_t i = 0; i < expected.lights.size(); ++i)
    if (file.fingerprint.lights[i] != expected.lights[i])
      fail(fmt::format("attribute 'light_hash_{}'", i + 1),
           fmt::format("the hash of the scene's light {}", i + 1));
  if (with_parameters && file.fingerprint.parameters != expected.parameters)
    fail("attribute 'parameter_hash'", "the hash of these parameters");
}

}  // namespace parian

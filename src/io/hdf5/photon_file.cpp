#include "io/hdf5/photon_file.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "io/hdf5/read_internal.h"
#include "io/hdf5/write_internal.h"

namespace parian {
namespace {

using namespace hdf5;

constexpr const char* format_name = "parian-photon-progress";
constexpr std::uint64_t max_steps = 1'000'000'000'000;
// sum[4], squares[4], roulette, balance, flights
constexpr std::size_t totals_per_channel = 11;

std::uint64_t get_u64(const File& file, const std::string& name) {
  const auto value = find_u64(file, name);
  if (!value)
    throw Error(
        {file.path, fmt::format("attribute '{}'", name), "a whole number", "no such attribute"});
  return *value;
}

template <typename T>
std::vector<T> read_finite(const File& file, const std::string& name, const std::string& axes,
                           const std::vector<std::uint64_t>& shape, bool positive) {
  const Dataset dataset = open_dataset(file, name, axes);
  if (dataset.shape != shape)
    throw Error({file.path, dataset.place, "shape " + describe_shape(shape),
                 describe_shape(dataset.shape)});
  std::vector<T> values = read_all<T>(file, dataset);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || (positive && values[i] < 0))
      throw Error({file.path, fmt::format("{}, value {}", dataset.place, i),
                   positive ? "a finite value from 0" : "a finite value",
                   fmt::format("{}", values[i])});
  return values;
}

void unpack(const std::vector<double>& values, std::vector<PhotonRoundTotals>& totals) {
  const double* at = values.data();
  for (PhotonRoundTotals& channel : totals) {
    for (double& sum : channel.sum) sum = *at++;
    for (double& square : channel.squares) square = *at++;
    channel.roulette = *at++;
    channel.balance = *at++;
    channel.flights = *at++;
  }
}

std::vector<double> pack(const std::vector<PhotonRoundTotals>& totals) {
  std::vector<double> values;
  for (const PhotonRoundTotals& channel : totals) {
    values.insert(values.end(), channel.sum.begin(), channel.sum.end());
    values.insert(values.end(), channel.squares.begin(), channel.squares.end());
    values.insert(values.end(), {channel.roulette, channel.balance, channel.flights});
  }
  return values;
}

std::vector<std::uint64_t> shape_of(const TableHeader& header) {
  return {header.offsets.size(), static_cast<std::uint64_t>(header.height),
          static_cast<std::uint64_t>(header.width)};
}

std::string name_of(const char* kind, std::size_t channel) {
  return fmt::format("{}_{}", kind, channel + 1);
}

}  // namespace

PhotonProgress load_photon_progress(const std::string& path, const PhotonSimulation& simulation) {
  const Guard guard;
  const File file = open_file(path);
  check_format(file, format_name);
  if (get_u64(file, "fingerprint") != simulation.fingerprint())
    throw Error({path, "attribute 'fingerprint'", "that of this sample and these parameters",
                 "that of another"});
  PhotonProgress progress;
  progress.steps = get_u64(file, "steps");
  if (progress.steps > max_steps)
    throw Error({path, "attribute 'steps'", fmt::format("a whole number up to {}", max_steps),
                 fmt::format("{}", progress.steps)});
  const TableHeader& header = simulation.header();
  const auto channels = static_cast<std::size_t>(header.channels);
  progress.totals.resize(channels);
  unpack(read_finite<double>(file, "totals", "[C][11]", {channels, totals_per_channel}, false),
         progress.totals);
  const auto read = [&](const char* kind, std::size_t c) {
    return read_finite<float>(file, name_of(kind, c), "[D][H][W]", shape_of(header), true);
  };
  for (std::size_t c = 0; c < channels; ++c)
    progress.sums.push_back({read("forward", c), read("backward", c), read("squares", c)});
  return progress;
}

void save_photon_progress(const std::string& path, const PhotonSimulation& simulation) {
  const Guard guard;
  const PhotonProgress& progress = simulation.progress();
  const std::vector<double> totals = pack(progress.totals);
  const std::vector<std::uint64_t> counts = shape_of(simulation.header());
  const std::vector<hsize_t> shape(counts.begin(), counts.end());
  NewFile file(path);
  file.create();
  file.write_text("format", format_name);
  file.write_int("version", 1);
  file.write_u64("fingerprint", simulation.fingerprint());
  file.write_u64("steps", progress.steps);
  file.add_dataset("totals", H5T_NATIVE_DOUBLE, {progress.totals.size(), totals_per_channel},
                   totals.data());
  for (std::size_t c = 0; c < progress.sums.size(); ++c) {
    const PhotonSums& sums = progress.sums[c];
    const auto add = [&](const char* kind, const std::vector<float>& plane) {
      file.add_dataset(name_of(kind, c).c_str(), H5T_NATIVE_FLOAT, shape, plane.data());
    };
    add("forward", sums.forward);
    add("backward", sums.backward);
    add("squares", sums.squares);
  }
  file.close_hdf5();
  file.commit();
}

}  // namespace parian

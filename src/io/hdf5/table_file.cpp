#include "io/hdf5/table_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "io/hdf5/slice_layout_internal.h"

namespace parian {
namespace {

using namespace hdf5;

constexpr std::uint64_t max_size = 65535;       // of the grid
constexpr std::uint64_t max_offsets = 1000000;  // D
constexpr std::size_t max_cache = std::size_t{256} << 20;

void check_shape(const File& file, const Dataset& dataset) {
  const auto& shape = dataset.shape;
  const bool fits = (shape[0] == 1 || shape[0] == 3) && shape[1] >= 1 && shape[1] <= max_offsets &&
                    shape[2] >= 1 && shape[2] <= max_size && shape[3] >= 1 && shape[3] <= max_size;
  if (!fits)
    throw Error({file.path, dataset.place,
                 "shape [C][D][H][W] with C = 1 or 3, D in [1, 1000000], H and W in [1, 65535]",
                 describe_shape(shape)});
  // At least one whole slice is stored, or the sizes are not worth an allocation.
  check_stored(file, dataset, shape[2] * shape[3]);
}

std::vector<Offset> read_offsets(const File& file, std::uint64_t count) {
  const Dataset dataset = open_dataset(file, "offsets", "[D][2]", Numbers::whole);
  if (dataset.size(0) != count || dataset.size(1) != 2)
    throw Error({file.path, dataset.place,
                 fmt::format("shape [{}][2], as 'reflectance' has {} offsets", count, count),
                 describe_shape(dataset.shape)});
  const std::vector<std::int64_t> values = read_all<std::int64_t>(file, dataset);
  std::vector<Offset> offsets(static_cast<std::size_t>(count));
  constexpr auto limit = static_cast<std::int64_t>(max_size);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const std::int64_t dx = values[2 * i], dy = values[2 * i + 1];
    if (std::max(dx, dy) > limit || std::min(dx, dy) < -limit)
      throw Error({file.path, fmt::format("offsets[{}]", i), "components in [-65535, 65535]",
                   fmt::format("({}, {})", dx, dy)});
    offsets[i] = {static_cast<int>(dx), static_cast<int>(dy)};
  }
  return offsets;
}

void read_noise(const File& file, TableHeader& header) {
  const auto floor = find_numbers(file, "noise_floor");
  const auto gain = find_numbers(file, "noise_gain");
  if (!floor && !gain) return;
  const std::vector<double> zeros(static_cast<std::size_t>(header.channels), 0.0);
  header.noise_floor = floor.value_or(zeros);
  header.noise_gain = gain.value_or(zeros);
}

TableHeader read_header(const File& file, const Dataset& reflectance) {
  TableHeader header;
  header.channels = static_cast<int>(reflectance.size(0));
  header.height = static_cast<int>(reflectance.size(2));
  header.width = static_cast<int>(reflectance.size(3));
  header.pixel_pitch_mm = get_number(file, "pixel_pitch_mm");
  header.boundary = find_choice(file, "boundary", {"excluded", "included"}, 0) == 1
                        ? Boundary::included
                        : Boundary::excluded;
  header.eta = find_number(file, "eta").value_or(header.eta);
  header.sampling =
      find_choice(file, "sampling", {"point", "area"}, 0) == 1 ? Sampling::area : Sampling::point;
  const double symmetric = find_number(file, "symmetric").value_or(1);
  if (symmetric != 0 && symmetric != 1)
    throw Error({file.path, "attribute 'symmetric'", "0 or 1", fmt::format("{}", symmetric)});
  header.symmetric = symmetric == 1;
  read_noise(file, header);
  header.provenance = find_text(file, "provenance").value_or("");
  header.offsets = read_offsets(file, reflectance.size(1));
  check(header, file.path);
  return header;
}

class TableSource final : public SliceSource {
 public:
  explicit TableSource(const std::string& path);

  const TableHeader& header() const override { return header_; }
  std::string name() const override { return file_.path; }
  void read_slice(int channel, int offset_index, float* slice) const override;

 private:
  bool read_raw(std::size_t index, float* slice) const;
  void read_through_hdf5(int channel, int offset_index, float* slice) const;
  void open_with_cache();
  std::string place(int channel, int offset_index) const {
    return fmt::format("reflectance[{}][{}]", channel, offset_index);
  }

  File file_;
  Dataset reflectance_;
  TableHeader header_;
  std::optional<RawFile> raw_;
  std::optional<SliceLayout> layout_;
  bool has_nan_fill_ = false;
};

TableSource::TableSource(const std::string& path) {
  const Guard guard;
  file_ = open_file(path);
  check_format(file_, "parian-bssrdf-table");
  reflectance_ = open_dataset(file_, "reflectance", "[C][D][H][W]");
  check_shape(file_, reflectance_);
  header_ = read_header(file_, reflectance_);
  raw_.emplace(path, RawFile::Mode::read, path);
  layout_ = locate_slices(file_, reflectance_, *raw_);
  const Id plist(H5Dget_create_plist(reflectance_.id.get()), H5Pclose);
  float fill = 0;
  if (H5Pget_fill_value(plist.get(), H5T_NATIVE_FLOAT, &fill) >= 0)
    has_nan_fill_ = std::isnan(fill);
  if (!layout_) open_with_cache();
}

// Chunks that span several slices would be read, and inflated, once per slice: caches as many as
// one slice touches, so that slices read in order find them again.
void TableSource::open_with_cache() {
  const Id plist(H5Dget_create_plist(reflectance_.id.get()), H5Pclose);
  hsize_t chunk[4] = {};
  if (H5Pget_layout(plist.get()) != H5D_CHUNKED || H5Pget_chunk(plist.get(), 4, chunk) != 4) return;
  const auto size_of = [&](int axis) { return reflectance_.size(axis); };
  const double chunks = std::ceil(static_cast<double>(size_of(2)) / static_cast<double>(chunk[2])) *
                        std::ceil(static_cast<double>(size_of(3)) / static_cast<double>(chunk[3]));
  double bytes = static_cast<double>(H5Tget_size(reflectance_.type.get()));
  for (const hsize_t size : chunk) bytes *= static_cast<double>(size);
  const Id access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  const double cache = std::min(chunks * bytes, static_cast<double>(max_cache));
  H5Pset_chunk_cache(access.get(), 12421,
                     std::max(std::size_t{1} << 20u, static_cast<std::size_t>(cache)), 1);
  reflectance_.id = Id();
  reflectance_.id = Id(require(H5Dopen2(file_.id.get(), "reflectance", access.get()), file_.path,
                               reflectance_.place),
                       H5Dclose);
}

void TableSource::read_slice(int channel, int offset_index, float* slice) const {
  PARIAN_CHECK_LE(0, channel);
  PARIAN_CHECK_LT(channel, header_.channels);
  PARIAN_CHECK_LE(0, offset_index);
  const std::size_t offsets = header_.offsets.size();
  PARIAN_CHECK_LT(static_cast<std::size_t>(offset_index), offsets);
  if (!layout_) {
    read_through_hdf5(channel, offset_index, slice);
  } else if (!read_raw(static_cast<std::size_t>(channel) * offsets +
                           static_cast<std::size_t>(offset_index),
                       slice)) {
    const bool missing = layout_
                             ->slices[static_cast<std::size_t>(channel) * offsets +
                                      static_cast<std::size_t>(offset_index)]
                             .bytes == 0;
    throw Error({file_.path, place(channel, offset_index),
                 missing ? "written values" : "a whole deflate stream",
                 missing ? "a chunk that was never written" : "damaged data"});
  }
  clean_slice(header_, file_.path, channel, offset_index, slice);
}

// False when the slice is damaged, or was never written and the fill value is not NaN.
bool TableSource::read_raw(std::size_t index, float* slice) const {
  const Extent& extent = layout_->slices[index];
  if (extent.bytes == 0) {
    std::fill_n(slice, header_.pixels(), std::numeric_limits<float>::quiet_NaN());
    return has_nan_fill_;
  }
  if (!layout_->deflated) {
    raw_->read(extent.address, slice, header_.pixels() * sizeof(float));
    return true;
  }
  std::vector<unsigned char> stored(static_cast<std::size_t>(extent.bytes));
  raw_->read(extent.address, stored.data(), stored.size());
  return inflate_slice(*layout_, stored, slice, header_.pixels());
}

void TableSource::read_through_hdf5(int channel, int offset_index, float* slice) const {
  const Guard guard;
  const std::string where = place(channel, offset_index);
  const hsize_t start[4] = {static_cast<hsize_t>(channel), static_cast<hsize_t>(offset_index), 0,
                            0};
  const hsize_t count[4] = {1, 1, reflectance_.size(2), reflectance_.size(3)};
  const Id file_space(require(H5Dget_space(reflectance_.id.get()), file_.path, where), H5Sclose);
  const Id memory_space(require(H5Screate_simple(4, count, nullptr), file_.path, where), H5Sclose);
  if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start, nullptr, count, nullptr) < 0 ||
      H5Dread(reflectance_.id.get(), H5T_NATIVE_FLOAT, memory_space.get(), file_space.get(),
              H5P_DEFAULT, slice) < 0)
    throw_failure(file_.path, where);
}

}  // namespace

std::unique_ptr<SliceSource> open_table(const std::string& path) {
  return std::make_unique<TableSource>(path);
}

}  // namespace parian

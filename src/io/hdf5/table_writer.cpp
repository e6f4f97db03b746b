// The writing half of table_file.h.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "io/hdf5/slice_layout_internal.h"
#include "io/hdf5/table_file.h"
#include "io/hdf5/write_internal.h"

namespace parian {
namespace {

using namespace hdf5;

// Unfiltered tables: HDF5 lays the file out, all disk space is claimed at once, and slices are then
// written to their addresses past HDF5. Deflated tables: each slice goes through HDF5.
class TableSink final : public SliceSink {
 public:
  TableSink(const std::string& path, const TableHeader& header, const TableWriteParams& params);

  void write_slice(int channel, int offset_index, const float* slice) override;
  void finish() override;

 private:
  void write_header();
  void write_through_hdf5(int channel, int offset_index);
  void prepare(int channel, int offset_index, const float* slice);

  TableHeader header_;
  int deflate_;
  NewFile file_;
  Id reflectance_;
  std::vector<std::int32_t> offsets_;  // written when HDF5's part is closed
  std::optional<RawFile> raw_;
  SliceLayout layout_;
  std::vector<bool> written_;
  std::vector<float> buffer_;
};

std::vector<std::int32_t> flatten(const std::vector<Offset>& offsets) {
  std::vector<std::int32_t> values;
  for (const Offset offset : offsets) {
    values.push_back(offset.dx);
    values.push_back(offset.dy);
  }
  return values;
}

TableSink::TableSink(const std::string& path, const TableHeader& header,
                     const TableWriteParams& params)
    : header_(header), deflate_(params.deflate), file_(path), offsets_(flatten(header.offsets)) {
  PARIAN_CHECK_LE(0, deflate_);
  PARIAN_CHECK_LE(deflate_, 9);
  check(header_, path);
  const std::size_t slices = header_.offsets.size() * static_cast<std::size_t>(header_.channels);
  written_.resize(slices);
  buffer_.resize(header_.pixels());
  const Guard guard;
  write_header();
  const std::vector<hsize_t> shape{static_cast<hsize_t>(header_.channels), header_.offsets.size(),
                                   static_cast<hsize_t>(header_.height),
                                   static_cast<hsize_t>(header_.width)};
  reflectance_ = file_.add_chunked("reflectance", shape, {1, 1, shape[2], shape[3]}, deflate_);
  if (deflate_ > 0) return;
  reflectance_.close();
  file_.close_hdf5();
  raw_.emplace(file_.temporary(), RawFile::Mode::write, path);
  const File laid_out = open_file(file_.temporary());
  const Dataset dataset = open_dataset(laid_out, "reflectance", "[C][D][H][W]");
  std::optional<SliceLayout> layout = locate_slices(laid_out, dataset, *raw_);
  PARIAN_CHECK(layout.has_value());
  layout_ = std::move(*layout);
}

void TableSink::write_header() {
  file_.create();
  file_.write_text("format", "parian-bssrdf-table");
  file_.write_int("version", 1);
  file_.write_number("pixel_pitch_mm", header_.pixel_pitch_mm);
  file_.write_text("boundary", header_.boundary == Boundary::included ? "included" : "excluded");
  file_.write_number("eta", header_.eta);
  file_.write_int("symmetric", header_.symmetric ? 1 : 0);
  file_.write_text("sampling", header_.sampling == Sampling::area ? "area" : "point");
  file_.write_numbers("noise_floor", header_.noise_floor);
  file_.write_numbers("noise_gain", header_.noise_gain);
  file_.write_text("provenance", header_.provenance);
  file_.add_dataset("offsets", H5T_NATIVE_INT32, {header_.offsets.size(), 2}, offsets_.data());
}

// What readers accept: NaN outside the grid, no infinities. A model's value that underflows to 0
// becomes the smallest normal float where 0 would need a noise model.
void TableSink::prepare(int channel, int offset_index, const float* slice) {
  std::copy_n(slice, buffer_.size(), buffer_.begin());
  if (!header_.has_noise_model())
    for (float& value : buffer_)
      if (value >= 0 && value < std::numeric_limits<float>::min())
        value = std::numeric_limits<float>::min();
  clean_slice(header_, file_.path(), channel, offset_index, buffer_.data());
}

void TableSink::write_slice(int channel, int offset_index, const float* slice) {
  PARIAN_CHECK_LE(0, channel);
  PARIAN_CHECK_LT(channel, header_.channels);
  PARIAN_CHECK_LE(0, offset_index);
  PARIAN_CHECK_LT(static_cast<std::size_t>(offset_index), header_.offsets.size());
  const std::size_t index = static_cast<std::size_t>(channel) * header_.offsets.size() +
                            static_cast<std::size_t>(offset_index);
  PARIAN_CHECK(!written_[index]);
  prepare(channel, offset_index, slice);
  if (raw_) {
    raw_->write(layout_.slices[index].address, buffer_.data(), buffer_.size() * sizeof(float));
  } else {
    write_through_hdf5(channel, offset_index);
  }
  written_[index] = true;
}

void TableSink::write_through_hdf5(int channel, int offset_index) {
  const Guard guard;
  file_.reserve(buffer_.size() * sizeof(float));
  const hsize_t start[4] = {static_cast<hsize_t>(channel), static_cast<hsize_t>(offset_index), 0,
                            0};
  const hsize_t count[4] = {1, 1, static_cast<hsize_t>(header_.height),
                            static_cast<hsize_t>(header_.width)};
  const Id file_space(file_.check(H5Dget_space(reflectance_.get())), H5Sclose);
  const Id memory_space(file_.check(H5Screate_simple(4, count, nullptr)), H5Sclose);
  file_.check(
      H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start, nullptr, count, nullptr));
  file_.check(H5Dwrite(reflectance_.get(), H5T_NATIVE_FLOAT, memory_space.get(), file_space.get(),
                       H5P_DEFAULT, buffer_.data()));
}

void TableSink::finish() {
  const auto count = std::count(written_.begin(), written_.end(), true);
  PARIAN_CHECK_EQ(static_cast<std::size_t>(count), written_.size());
  if (!raw_) {
    const Guard guard;
    if (!reflectance_.close()) file_.check(-1);
    file_.close_hdf5();
  }
  file_.commit();
}

}  // namespace

std::unique_ptr<SliceSink> create_table(const std::string& path, const TableHeader& header,
                                        const TableWriteParams& params) {
  return std::make_unique<TableSink>(path, header, params);
}

}  // namespace parian

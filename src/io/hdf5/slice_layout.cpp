#include "io/hdf5/slice_layout_internal.h"

#include <zlib.h>

#include <bit>
#include <cstring>

namespace parian::hdf5 {
namespace {

// Above this number of slices the linear searches of HDF5 1.10 take longer than they save.
constexpr std::uint64_t max_searched = 4096;

std::uint64_t slice_bytes(const Dataset& dataset) {
  return dataset.size(2) * dataset.size(3) * sizeof(float);
}

// Raw addresses hold only where the file is one plain file that begins at its byte 0.
bool has_plain_addresses(const File& file) {
  const Id plist(H5Fget_create_plist(file.id.get()), H5Pclose);
  hsize_t userblock = 1;
  std::size_t address_bytes = 0, length_bytes = 0;
  return plist.valid() && H5Pget_userblock(plist.get(), &userblock) >= 0 && userblock == 0 &&
         H5Pget_sizes(plist.get(), &address_bytes, &length_bytes) >= 0 && address_bytes == 8 &&
         length_bytes == 8;
}

// No filters, deflate, or shuffle then deflate.
bool read_filters(hid_t plist, SliceLayout& layout) {
  const int filters = H5Pget_nfilters(plist);
  if (filters < 0 || filters > 2) return false;
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(plist, static_cast<unsigned>(i), &flags, &values,
                                               nullptr, 0, nullptr, &config);
    const bool last = i + 1 == filters;
    if (filter == H5Z_FILTER_DEFLATE && last) {
      layout.deflated = true;
    } else if (filter == H5Z_FILTER_SHUFFLE && !last) {
      layout.shuffled = true;
    } else {
      return false;
    }
  }
  return true;
}

bool is_slice_chunked(hid_t plist, const Dataset& dataset) {
  hsize_t chunk[4] = {};
  return H5Pget_chunk(plist, 4, chunk) == 4 && chunk[0] == 1 && chunk[1] == 1 &&
         chunk[2] == dataset.size(2) && chunk[3] == dataset.size(3);
}

std::optional<std::vector<Extent>> locate_contiguous(const Dataset& dataset) {
  const haddr_t begin = H5Dget_offset(dataset.id.get());
  if (begin == HADDR_UNDEF) return {};
  std::vector<Extent> slices(static_cast<std::size_t>(dataset.size(0) * dataset.size(1)));
  for (std::size_t i = 0; i < slices.size(); ++i)
    slices[i] = {begin + i * slice_bytes(dataset), slice_bytes(dataset)};
  return slices;
}

// For indices that walk_chunk_index does not know: files of HDF5's newer formats.
std::optional<std::vector<Extent>> search_chunks(const Dataset& dataset) {
  if (dataset.size(0) * dataset.size(1) > max_searched) return {};
  std::vector<Extent> slices;
  for (hsize_t c = 0; c < dataset.size(0); ++c) {
    for (hsize_t d = 0; d < dataset.size(1); ++d) {
      const hsize_t at[4] = {c, d, 0, 0};
      haddr_t address = HADDR_UNDEF;
      hsize_t bytes = 0;
      unsigned skipped_filters = 0;
      if (H5Dget_chunk_info_by_coord(dataset.id.get(), at, &skipped_filters, &address, &bytes) < 0)
        return {};
      if (address == HADDR_UNDEF) bytes = 0;
      if (bytes > 0 && skipped_filters != 0) return {};
      slices.push_back({address, bytes});
    }
  }
  return slices;
}

bool are_inside(const SliceLayout& layout, const Dataset& dataset, std::uint64_t file_size) {
  for (const Extent& extent : layout.slices) {
    if (extent.bytes == 0) continue;
    if (extent.address > file_size || extent.bytes > file_size - extent.address) return false;
    if (!layout.deflated && extent.bytes != slice_bytes(dataset)) return false;
  }
  return true;
}

// The k-th bytes of all values lie together, most of them equal: undoes that.
void unshuffle(const std::vector<unsigned char>& planes, float* values, std::size_t count) {
  auto* bytes = reinterpret_cast<unsigned char*>(values);
  const unsigned char* plane = planes.data();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 4; ++k) bytes[4 * i + k] = plane[k * count + i];
}

}  // namespace

std::optional<SliceLayout> locate_slices(const File& file, const Dataset& dataset,
                                         const RawFile& raw) {
  const Id plist(H5Dget_create_plist(dataset.id.get()), H5Pclose);
  const bool plain = std::endian::native == std::endian::little &&
                     H5Tequal(dataset.type.get(), H5T_IEEE_F32LE) > 0 && has_plain_addresses(file);
  if (!plist.valid() || !plain) return {};
  SliceLayout layout;
  std::optional<std::vector<Extent>> slices;
  const H5D_layout_t kind = H5Pget_layout(plist.get());
  if (kind == H5D_CONTIGUOUS) {
    slices = locate_contiguous(dataset);
  } else if (kind == H5D_CHUNKED && is_slice_chunked(plist.get(), dataset) &&
             read_filters(plist.get(), layout)) {
    H5O_info_t info{};
    if (H5Oget_info2(dataset.id.get(), &info, H5O_INFO_BASIC) < 0) return {};
    slices = walk_chunk_index(raw, info.addr, dataset.shape);
    if (!slices) slices = search_chunks(dataset);
  }
  if (!slices) return {};
  layout.slices = std::move(*slices);
  if (!are_inside(layout, dataset, raw.size())) return {};
  return layout;
}

bool inflate_slice(const SliceLayout& layout, const std::vector<unsigned char>& stored,
                   float* values, std::size_t count) {
  uLongf bytes = count * sizeof(float);
  if (!layout.shuffled)
    return uncompress(reinterpret_cast<Bytef*>(values), &bytes, stored.data(), stored.size()) ==
               Z_OK &&
           bytes == count * sizeof(float);
  std::vector<unsigned char> planes(bytes);
  if (uncompress(planes.data(), &bytes, stored.data(), stored.size()) != Z_OK ||
      bytes != planes.size())
    return false;
  unshuffle(planes, values, count);
  return true;
}

}  // namespace parian::hdf5

#include "material/bssrdf_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace parian {
namespace {

class MemorySource : public SliceSource {
 public:
  MemorySource(const BssrdfTable& table, std::string name) : table_(table), name_(std::move(name)) {
    check(table.header, name_);
  }
  const TableHeader& header() const override { return table_.header; }
  std::string name() const override { return name_; }
  void read_slice(int channel, int offset_index, float* slice) const override {
    std::copy_n(slice_of(table_, channel, offset_index), table_.header.pixels(), slice);
    clean_slice(table_.header, name_, channel, offset_index, slice);
  }

 private:
  const BssrdfTable& table_;
  std::string name_;
};

}  // namespace

BssrdfTable make_bssrdf_table(TableHeader header) {
  check(header, {});
  BssrdfTable table{std::move(header), {}};
  const std::size_t count = static_cast<std::size_t>(table.header.channels) *
                            table.header.offsets.size() * table.header.pixels();
  table.reflectance.assign(count, std::numeric_limits<float>::quiet_NaN());
  return table;
}

std::unique_ptr<SliceSource> make_slices(const BssrdfTable& table, std::string name) {
  return std::make_unique<MemorySource>(table, std::move(name));
}

BssrdfTable read_table(const SliceSource& source) {
  BssrdfTable table = make_bssrdf_table(source.header());
  for_each_slice(source, {}, "", [&](int channel, int offset_index, const float* slice) {
    std::copy_n(slice, table.header.pixels(), slice_of(table, channel, offset_index));
  });
  return table;
}

std::vector<Offset> half_disc_offsets(double radius) {
  std::vector<Offset> offsets;
  const int reach = static_cast<int>(std::floor(radius));
  for (int dy = 0; dy <= reach; ++dy)
    for (int dx = dy == 0 ? 0 : -reach; dx <= reach; ++dx)
      if (static_cast<double>(dx) * dx + static_cast<double>(dy) * dy <= radius * radius + 1e-9)
        offsets.push_back({dx, dy});
  return offsets;
}

std::vector<Offset> half_disc_offsets(double radius, int width, int height) {
  std::vector<Offset> offsets = half_disc_offsets(radius);
  std::erase_if(offsets, [&](Offset d) { return std::abs(d.dx) >= width || d.dy >= height; });
  return offsets;
}

}  // namespace parian

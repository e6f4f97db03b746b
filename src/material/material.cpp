#include "material/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "material/bssrdf_table.h"
#include "material/diffusion.h"
#include "material/dilated_slices_internal.h"
#include "material/field_internal.h"
#include "material/plane_eval_internal.h"

namespace parian {
namespace {

// Profile maps and blends.
template <typename Grid>
void eval_model_slice(const Grid& grid, const TableHeader&, int channel, Offset offset,
                      float* slice) {
  eval_slice(grid, channel, offset, slice);
}

void eval_model_slice(const Dipole& dipole, const TableHeader& header, int channel, Offset offset,
                      float* slice) {
  const double r = length_px(offset) * header.pixel_pitch_mm;
  const double value =
      eval_curve(make_reflectance_curve(dipole, static_cast<std::size_t>(channel)), r);
  std::fill_n(slice, header.pixels(), std::numeric_limits<float>::quiet_NaN());
  const PixelRange range = pairs_in_grid(header, offset);
  for (int y = range.y0; y < range.y1; ++y)
    for (int x = range.x0; x < range.x1; ++x)
      slice[static_cast<std::size_t>(y) * static_cast<std::size_t>(header.width) +
            static_cast<std::size_t>(x)] = static_cast<float>(value);
}

template <typename Grid>
void check_grid(const Grid& map, const TableHeader& like, const std::string& name) {
  if (map.width != like.width || map.height != like.height || map.channels != like.channels)
    throw Error({name, "grid",
                 fmt::format("{} x {} pixels, {} channels, as the table", like.width, like.height,
                             like.channels),
                 fmt::format("{} x {} pixels, {} channels", map.width, map.height, map.channels)});
  if (std::abs(map.pixel_pitch_mm / like.pixel_pitch_mm - 1) > 1e-6)
    throw Error({name, "pixel_pitch_mm", fmt::format("{}, as the table", like.pixel_pitch_mm),
                 fmt::format("{}", map.pixel_pitch_mm)});
}

void check_grid(const Dipole& dipole, const TableHeader& like, const std::string& name) {
  if (dipole.channels.size() != static_cast<std::size_t>(like.channels))
    throw Error({name, "channels", fmt::format("{}, as the table", like.channels),
                 fmt::format("{}", dipole.channels.size())});
}

class ModelSource : public SliceSource {
 public:
  ModelSource(const Material& material, TableHeader header, std::string name)
      : material_(material), header_(std::move(header)), name_(std::move(name)) {}
  const TableHeader& header() const override { return header_; }
  std::string name() const override { return name_; }
  void read_slice(int channel, int offset_index, float* slice) const override {
    const Offset offset = header_.offsets.at(static_cast<std::size_t>(offset_index));
    std::visit([&](const auto& model) { eval_model_slice(model, header_, channel, offset, slice); },
               material_);
  }

 private:
  const Material& material_;
  TableHeader header_;
  std::string name_;
};

// Of a map with dilations, its own or a blend's written out.
class DilatedSource : public SliceSource {
 public:
  DilatedSource(const ProfileMap& map, TableHeader header, std::string name)
      : dilated_(make_dilated_map(map)), header_(std::move(header)), name_(std::move(name)) {}
  DilatedSource(std::unique_ptr<const ProfileMap> map, TableHeader header, std::string name)
      : DilatedSource(*map, std::move(header), std::move(name)) {
    owned_ = std::move(map);
  }
  const TableHeader& header() const override { return header_; }
  std::string name() const override { return name_; }
  void read_slice(int channel, int offset_index, float* slice) const override {
    const Offset offset = header_.offsets.at(static_cast<std::size_t>(offset_index));
    std::vector<float> log_p(header_.pixels());
    eval_log_plane(dilated_, channel, length_px(offset) * header_.pixel_pitch_mm, log_p.data());
    pair_planes(header_.width, header_.height, offset, log_p.data(), slice);
  }

 private:
  std::unique_ptr<const ProfileMap> owned_;
  DilatedMap dilated_;
  TableHeader header_;
  std::string name_;
};

void read_profile(const ProfileMap& map, int channel, int x, int y, Profile& profile) {
  get_profile(map, channel, x, y, profile);
}
void read_profile(const ProfileBlend& blend, int channel, int x, int y, Profile& profile) {
  profile = get_profile(blend, channel, x, y);
}

template <typename Grid>
double support_of(const Grid& map) {
  std::vector<double> rows(static_cast<std::size_t>(map.height), 0.0);
  parallel_for(rows.size(), [&](std::size_t y) {
    Profile profile;
    for (int c = 0; c < map.channels; ++c)
      for (int x = 0; x < map.width; ++x) {
        read_profile(map, c, x, static_cast<int>(y), profile);
        rows[y] = std::max(rows[y], profile.support_mm);
      }
  });
  return rows.empty() ? 0 : *std::max_element(rows.begin(), rows.end());
}

double support_of(const Dipole& dipole) {
  double support = 0;
  for (std::size_t c = 0; c < dipole.channels.size(); ++c)
    support = std::max(support, support_of(make_reflectance_curve(dipole, c)));
  return support;
}

// All offsets within the support.
template <typename Grid>
TableHeader make_header(const Grid& map) {
  TableHeader header;
  header.width = map.width;
  header.height = map.height;
  header.channels = map.channels;
  header.pixel_pitch_mm = map.pixel_pitch_mm;
  const double reach = std::hypot(map.width, map.height);
  header.offsets = half_disc_offsets(std::min(reach, support_of(map) / map.pixel_pitch_mm),
                                     map.width, map.height);
  return header;
}

}  // namespace

std::string describe_kind(const Material& material) {
  if (std::holds_alternative<ProfileMap>(material)) return "profile map";
  return std::holds_alternative<ProfileBlend>(material) ? "profile blend" : "dipole";
}

bool has_profiles(const Material& material) {
  return !std::holds_alternative<Dipole>(material);
}

Profile get_profile(const Material& material, int channel, int x, int y) {
  PARIAN_CHECK(has_profiles(material));
  if (const auto* map = std::get_if<ProfileMap>(&material)) return get_profile(*map, channel, x, y);
  return get_profile(std::get<ProfileBlend>(material), channel, x, y);
}

HoldOut hold_out_of(const Material& material) {
  if (const auto* map = std::get_if<ProfileMap>(&material)) return map->hold_out;
  const auto* blend = std::get_if<ProfileBlend>(&material);
  return blend != nullptr ? blend->hold_out : HoldOut{};
}

Boundary boundary_of(const Material& material) {
  if (const auto* map = std::get_if<ProfileMap>(&material)) return map->boundary;
  if (const auto* blend = std::get_if<ProfileBlend>(&material)) return blend->boundary;
  return Boundary::excluded;
}

double eta_of(const Material& material) {
  return std::visit([](const auto& model) { return model.eta; }, material);
}

double support_mm(const Material& material) {
  return std::visit([](const auto& model) { return support_of(model); }, material);
}

TableHeader natural_header(const Material& material) {
  if (const auto* map = std::get_if<ProfileMap>(&material)) return make_header(*map);
  if (const auto* blend = std::get_if<ProfileBlend>(&material)) return make_header(*blend);
  throw Error(
      {.expected = "a material with a grid of its own", .found = "a " + describe_kind(material)});
}

std::unique_ptr<SliceSource> make_slices(const Material& material, TableHeader like,
                                         std::string name) {
  std::visit([&](const auto& model) { check_grid(model, like, name); }, material);
  like.boundary = boundary_of(material);
  like.eta = eta_of(material);
  like.noise_floor.clear();
  like.noise_gain.clear();
  if (const auto* map = std::get_if<ProfileMap>(&material); map && !map->dilation.empty())
    return std::make_unique<DilatedSource>(*map, std::move(like), std::move(name));
  if (const auto* blend = std::get_if<ProfileBlend>(&material); blend && !blend->dilation.empty())
    return std::make_unique<DilatedSource>(
        std::make_unique<const ProfileMap>(make_profile_map(*blend)), std::move(like),
        std::move(name));
  return std::make_unique<ModelSource>(material, std::move(like), std::move(name));
}

}  // namespace parian

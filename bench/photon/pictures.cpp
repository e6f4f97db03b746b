// The bundled photon table and the volume that it was made from, as pictures.
#include <algorithm>
#include <cmath>

#include "bench/common/pictures.h"
#include "bench/photon/study.h"
#include "io/hdf5/table_file.h"
#include "io/json/json.h"
#include "judge/relight.h"

namespace parian::photon {
namespace {

constexpr int channel = 1;  // green

// sigma_s (1 - g) in the plane y = height / 2, depth downwards.
Image draw_slab(const PhotonVolume& volume) {
  Image values = make_image(volume.nx, volume.nz, 1);
  const std::size_t first = channel * volume.voxels();
  for (int z = 0; z < volume.nz; ++z)
    for (int x = 0; x < volume.nx; ++x)
      at(values, x, z, 0) =
          volume.sigma_s[first +
                         static_cast<std::size_t>((z * volume.ny + volume.ny / 2) * volume.nx + x)];
  const ColorScale scale{.min = 0, .max = 3, .label = "[1/mm]"};
  const double left = -volume.margin * volume.voxel_mm;
  constexpr int magnification = 3;
  return arrange(
      {{draw_panel({colorize(values, scale, magnification), "sigma_s'", "x [mm]", "z [mm]", left,
                    left + volume.nx * volume.voxel_mm, 0, volume.nz * volume.voxel_mm}),
        draw_color_bar(scale, volume.nz * magnification)}},
      4);
}

Image draw_uniform(const SliceSource& table) {
  const TableHeader& header = table.header();
  const std::vector<Image> lit = relight(
      table, {make_flat_light(FlatLight::uniform, header.width, header.height, header.channels)});
  const float largest = *std::max_element(lit[0].values.begin(), lit[0].values.end());
  return magnify(scale(lit[0], 0.9f / largest), 6);
}

Image draw_slice(const BssrdfTable& table, int x, int y) {
  const int reach = static_cast<int>(radius_px(table.header)), side = 2 * reach + 1;
  Image values = make_image(side, side, 1, NAN);
  for (const Offset d : table.header.offsets) {
    const auto value = [&](Offset o) {
      return static_cast<float>(table_value(table, channel, x, y, o));
    };
    at(values, reach + d.dx, reach + d.dy, 0) = value(d);
    at(values, reach - d.dx, reach - d.dy, 0) = value({-d.dx, -d.dy});
  }
  const ColorScale scale = log_scale(0.1, 3, "[1/mm^2]");
  const double edge = (reach + 0.5) * table.header.pixel_pitch_mm;
  return arrange({{draw_panel({colorize(values, scale, 14), "R_d around one pixel", "mm", "", -edge,
                               edge, edge, -edge}),
                   draw_color_bar(scale, side * 14)}},
                 4);
}

}  // namespace

void study_pictures(const Page& page) {
  const std::string data = PARIAN_SOURCE_DIR "/data/";
  const Sample sample = read_sample(load_document(data + "samples/embedded-stones.json"), {});
  write_picture(page, "slab", draw_slab(make_photon_volume(sample)));
  const auto source = open_table(data + "embedded-stones-48.h5");
  write_picture(page, "uniform", draw_uniform(*source));
  write_picture(page, "slice", draw_slice(read_table(*source), 20, 24));
}

}  // namespace parian::photon

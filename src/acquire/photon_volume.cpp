#include "acquire/photon_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"

namespace parian {
namespace {

constexpr double max_voxels = 1 << 27;  // of all channels: 1 GB in the kernel's form

// Whether anything changes with depth.
bool is_extruded(const Sample& sample) {
  const auto* image = std::get_if<ImageLayout>(&sample.layout);
  const bool is_stack = image != nullptr && !image->deeper.empty();
  const bool is_varied = sample.materials.size() > 1 || sample.variation.relative > 0;
  return !is_stack && !(is_varied && (sample.depth.solid || sample.depth.tilt_deg != 0));
}

PhotonVolume make_grid(const Sample& sample) {
  const SampleDepth& depth = sample.depth;
  PhotonVolume volume;
  volume.channels = sample.channels;
  volume.voxels_per_pixel = depth.voxels_per_pixel;
  volume.voxel_mm = sample.pixel_pitch_mm / depth.voxels_per_pixel;
  volume.thickness_mm = depth.thickness_mm;
  volume.eta = sample.eta;
  volume.width = sample.width;
  volume.height = sample.height;
  volume.margin = depth.margin_px * depth.voxels_per_pixel;
  volume.nx = sample.width * depth.voxels_per_pixel + 2 * volume.margin;
  volume.ny = sample.height * depth.voxels_per_pixel + 2 * volume.margin;
  const double grid_mm = depth.thickness_mm > 0 ? depth.thickness_mm
                         : depth.grid_mm > 0    ? depth.grid_mm
                                                : sample.radius_px * sample.pixel_pitch_mm;
  const double layers = is_extruded(sample) ? 1 : std::ceil(grid_mm / volume.voxel_mm - 1e-6);
  const double voxels = static_cast<double>(volume.nx) * volume.ny * layers * volume.channels;
  if (!(voxels <= max_voxels)) {
    const Document* node = find(sample.description, "depth");
    throw_at(node != nullptr ? *node : sample.description,
             fmt::format("at most {} voxels, all channels together", max_voxels),
             fmt::format("{} x {} x {} x {}", volume.nx, volume.ny, layers, volume.channels));
  }
  volume.nz = static_cast<int>(std::max(1.0, layers));
  return volume;
}

LayoutGrid make_layout_grid(const Sample& sample, const PhotonVolume& volume) {
  const double tilt = std::tan(sample.depth.tilt_deg * std::numbers::pi / 180);
  const double direction = sample.depth.tilt_direction_deg * std::numbers::pi / 180;
  return {.width = volume.width * volume.voxels_per_pixel,
          .height = volume.height * volume.voxels_per_pixel,
          .pixel_pitch_mm = volume.voxel_mm,
          .materials = static_cast<int>(sample.materials.size()),
          .seed = sample.seed,
          .margin = volume.margin,
          .layers = volume.nz,
          .solid = sample.depth.solid,
          .slant_x = tilt * std::cos(direction),
          .slant_y = tilt * std::sin(direction)};
}

struct Mixture {
  double sigma_a = 0, sigma_s = 0, sigma_s_g = 0;
};

Mixture mix_voxel(const Sample& sample, const std::vector<float>& weights, std::size_t voxel,
                  std::size_t voxels, std::size_t channel) {
  Mixture sum;
  for (std::size_t m = 0; m < sample.materials.size(); ++m) {
    const DipoleCoefficients& medium = sample.materials[m].channels[channel];
    const double weight = weights[m * voxels + voxel];
    const double sigma_s = weight * medium.sigma_s_prime / (1 - medium.g);
    sum.sigma_a += weight * medium.sigma_a;
    sum.sigma_s += sigma_s;
    sum.sigma_s_g += sigma_s * medium.g;
  }
  return sum;
}

void mix_volume(const Sample& sample, PhotonVolume& volume) {
  const LayoutGrid grid = make_layout_grid(sample, volume);
  const std::vector<float> weights = make_weights(sample.layout, grid);
  const auto nx = static_cast<std::size_t>(volume.nx), ny = static_cast<std::size_t>(volume.ny);
  const std::size_t voxels = volume.voxels();
  const auto place = [&](std::size_t i, int margin) {
    return (static_cast<double>(i) - margin + 0.5) * volume.voxel_mm;
  };
  parallel_for(ny * static_cast<std::size_t>(volume.nz), [&](std::size_t row) {
    for (std::size_t x = 0; x < nx; ++x) {
      const double depth = place(row / ny, 0);
      const VariationFactors factors =
          eval_variation(sample, place(x, volume.margin) - grid.slant_x * depth,
                         place(row % ny, volume.margin) - grid.slant_y * depth, depth);
      const std::size_t i = row * nx + x;
      for (std::size_t c = 0; c < static_cast<std::size_t>(volume.channels); ++c) {
        const Mixture mixture = mix_voxel(sample, weights, i, voxels, c);
        volume.sigma_a[c * voxels + i] = static_cast<float>(mixture.sigma_a * factors.sigma_a);
        volume.sigma_s[c * voxels + i] = static_cast<float>(mixture.sigma_s * factors.sigma_s);
        if (!volume.g.empty())
          volume.g[c * voxels + i] = static_cast<float>(mixture.sigma_s_g / mixture.sigma_s);
      }
    }
  });
}

// The side of cells: four mean free paths of the densest voxel, so that about one flight in fifty
// is cut, as a power of two.
int choose_cell(const PhotonVolume& volume, double largest) {
  const int side = std::max({volume.nx, volume.ny, volume.nz});
  int cell = 4;
  while (cell * largest < 4 && cell < side) cell *= 2;
  return cell;
}

// 1 / the largest sigma_t of each cell and its neighbours.
void fill_majorants(PhotonChannel& channel) {
  PhotonMedium& m = channel.medium;
  const int cell = static_cast<int>(m.cell_voxels);
  const auto at = [&](int x, int y, int z) {
    return static_cast<std::size_t>((z * m.cells_y + y) * m.cells_x + x);
  };
  const auto cells = static_cast<std::size_t>(m.cells_x * m.cells_y * m.cells_z);
  std::vector<float> largest(cells, 0.f);
  for (int z = 0; z < m.nz; ++z)
    for (int y = 0; y < m.ny; ++y)
      for (int x = 0; x < m.nx; ++x) {
        const auto voxel = static_cast<std::size_t>((z * m.ny + y) * m.nx + x);
        float& bound = largest[at(x / cell, y / cell, z / cell)];
        bound = std::max(bound, channel.voxels[2 * voxel]);
      }
  channel.inverse_majorant.resize(cells);
  for (int z = 0; z < m.cells_z; ++z)
    for (int y = 0; y < m.cells_y; ++y)
      for (int x = 0; x < m.cells_x; ++x) {
        float bound = 0;
        for (int k = std::max(0, z - 1); k <= std::min(m.cells_z - 1, z + 1); ++k)
          for (int j = std::max(0, y - 1); j <= std::min(m.cells_y - 1, y + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(m.cells_x - 1, x + 1); ++i)
              bound = std::max(bound, largest[at(i, j, k)]);
        channel.inverse_majorant[at(x, y, z)] = 1 / bound;
      }
}

}  // namespace

PhotonVolume make_photon_volume(const Sample& sample) {
  PhotonVolume volume = make_grid(sample);
  const std::size_t count = volume.voxels() * static_cast<std::size_t>(volume.channels);
  volume.sigma_a.resize(count);
  volume.sigma_s.resize(count);
  for (const SampleMaterial& material : sample.materials)
    for (const DipoleCoefficients& medium : material.channels)
      if (medium.g != 0) volume.g.resize(count);
  mix_volume(sample, volume);
  return volume;
}

PhotonVolume reduce_by_similarity(PhotonVolume volume) {
  for (std::size_t i = 0; i < volume.g.size(); ++i) volume.sigma_s[i] *= 1 - volume.g[i];
  volume.g.clear();
  return volume;
}

PhotonChannel make_photon_channel(const PhotonVolume& volume, int channel, int cell_voxels) {
  PARIAN_CHECK(channel >= 0 && channel < volume.channels);
  const std::size_t voxels = volume.voxels();
  const std::size_t first = static_cast<std::size_t>(channel) * voxels;
  PARIAN_CHECK_EQ(volume.sigma_s.size(), voxels * static_cast<std::size_t>(volume.channels));
  PhotonChannel made;
  made.voxels.resize(2 * voxels);
  float largest = 0;
  for (std::size_t i = 0; i < voxels; ++i) {
    const float sigma_a = volume.sigma_a[first + i], sigma_s = volume.sigma_s[first + i];
    made.voxels[2 * i] = (sigma_a + sigma_s) * static_cast<float>(volume.voxel_mm);
    made.voxels[2 * i + 1] = sigma_s / (sigma_a + sigma_s);
    largest = std::max(largest, made.voxels[2 * i]);
  }
  PARIAN_CHECK(largest > 0);
  if (!volume.g.empty())
    made.g.assign(volume.g.begin() + static_cast<std::ptrdiff_t>(first),
                  volume.g.begin() + static_cast<std::ptrdiff_t>(first + voxels));
  const int cell = cell_voxels > 0 ? cell_voxels : choose_cell(volume, largest);
  PhotonMedium& m = made.medium;
  m.nx = volume.nx, m.ny = volume.ny, m.nz = volume.nz;
  m.cell_voxels = static_cast<float>(cell);
  m.cells_x = (m.nx + cell - 1) / cell;
  m.cells_y = (m.ny + cell - 1) / cell;
  m.cells_z = (m.nz + cell - 1) / cell;
  m.eta = static_cast<float>(volume.eta);
  m.thickness = volume.thickness_mm > 0 ? static_cast<float>(volume.thickness_mm / volume.voxel_mm)
                                        : std::numeric_limits<float>::infinity();
  fill_majorants(made);
  m.voxels = made.voxels.data();
  m.g = made.g.empty() ? nullptr : made.g.data();
  m.inverse_majorant = made.inverse_majorant.data();
  return made;
}

bool can_share(const PhotonVolume& volume, int channel) {
  const std::size_t first = static_cast<std::size_t>(channel) * volume.voxels();
  float low_g = 1, high_g = -1, largest = 0;
  double sum = 0;
  for (std::size_t i = first; i < first + volume.voxels(); ++i) {
    const float sigma_t = volume.sigma_a[i] + volume.sigma_s[i];
    const float g = volume.g.empty() ? 0 : volume.g[i];
    largest = std::max(largest, sigma_t);
    sum += static_cast<double>(sigma_t);
    low_g = std::min(low_g, g);
    high_g = std::max(high_g, g);
  }
  constexpr double most_contrast = 4;
  const double mean = sum / static_cast<double>(volume.voxels());
  return high_g - low_g < 1e-5f && static_cast<double>(largest) <= most_contrast * mean;
}

PhotonChannel make_shared_channel(const PhotonVolume& volume, int channel) {
  PARIAN_CHECK(can_share(volume, channel));
  const int side = std::max({volume.nx, volume.ny, volume.nz});
  PhotonChannel made = make_photon_channel(volume, channel, side);
  PhotonMedium& m = made.medium;
  // A little above the largest coefficient, so that collisions are nowhere certain.
  const float inverse = made.inverse_majorant[0] / 1.05f;
  made.inverse_majorant.assign(1, inverse);
  m.inverse_majorant = made.inverse_majorant.data();
  m.cell_voxels = 64 / (1 / inverse);  // no flight is longer than 17 mean free paths
  m.cells_x = m.cells_y = m.cells_z = 1;
  m.pad = static_cast<int>(shared_side) * volume.voxels_per_pixel;
  const int nx = m.nx + 2 * m.pad, ny = m.ny + 2 * m.pad;
  const std::size_t count =
      static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(m.nz);
  made.log_events.resize(2 * count);
  parallel_for(static_cast<std::size_t>(ny) * static_cast<std::size_t>(m.nz), [&](std::size_t row) {
    const int y =
        std::clamp(static_cast<int>(row % static_cast<std::size_t>(ny)) - m.pad, 0, m.ny - 1);
    const int z = static_cast<int>(row / static_cast<std::size_t>(ny));
    for (int x = 0; x < nx; ++x) {
      const int inside = std::clamp(x - m.pad, 0, m.nx - 1);
      const auto voxel = static_cast<std::size_t>((z * m.ny + y) * m.nx + inside);
      const float sigma_t = made.voxels[2 * voxel], albedo = made.voxels[2 * voxel + 1];
      const std::size_t i = row * static_cast<std::size_t>(nx) + static_cast<std::size_t>(x);
      made.log_events[i] = std::log(1 - sigma_t * inverse);
      made.log_events[count + i] = std::log(std::max(1e-30f, sigma_t * albedo * inverse));
    }
  });
  return made;
}

}  // namespace parian

// A sample in depth: voxels of scattering and absorption between two planes, as photons see them.
#pragma once

#include <vector>

#include "acquire/photon_kernel.h"
#include "acquire/sample.h"

namespace parian {

// Voxels are cubes. The grid covers the sample's pixels and a margin around them; beyond it, to the
// sides and (half-infinite) below, the nearest voxel goes on without end.
struct PhotonVolume {
  int nx = 1, ny = 1, nz = 1;
  int channels = 1;
  double voxel_mm = 1;
  double thickness_mm = 0;  // 0: half-infinite
  double eta = 1.3;
  // Where the pixels of the table are: squares of voxels_per_pixel, from (margin, margin) on.
  int width = 1, height = 1;
  int voxels_per_pixel = 1;
  int margin = 0;              // voxels
  std::vector<float> sigma_a;  // [channel][z][y][x], 1/mm
  std::vector<float> sigma_s;  // [channel][z][y][x], 1/mm
  std::vector<float> g;        // [channel][z][y][x], empty: 0

  std::size_t voxels() const {
    return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
           static_cast<std::size_t>(nz);
  }
};

// The sample's materials mixed by its layout over every voxel (docs/samples.md): sigma_a and
// sigma_s linearly, g by what scatters, so that sigma_s (1 - g) is linear too. Throws Error when
// there are too many voxels.
PhotonVolume make_photon_volume(const Sample& sample);

// The same in the diffusive regime: sigma_s (1 - g) scatters isotropically.
PhotonVolume reduce_by_similarity(PhotonVolume volume);

// One channel, prepared for the kernel, which points into it.
struct PhotonChannel {
  std::vector<float> voxels;
  std::vector<float> g;
  std::vector<float> inverse_majorant;
  // Where paths may be shifted: ln of the probability that a flight ends without a collision, and
  // with one that scatters, [2][z][y][x] over the padded grid.
  std::vector<float> log_events;
  PhotonMedium medium;

  PhotonChannel() = default;
  PhotonChannel(PhotonChannel&&) = default;
  PhotonChannel& operator=(PhotonChannel&&) = default;
};

// Bounds on sigma_t are kept for cells of `cell_voxels` voxels a side; 0: chosen, so that most
// flights end within a cell; at least the grid's size: one bound for all.
PhotonChannel make_photon_channel(const PhotonVolume& volume, int channel, int cell_voxels = 0);

// For paths that are shifted by whole pixels (photon_trace.h): one bound for all, so that a flight
// has the same distribution everywhere. Needs the same g everywhere, and is worth it where the
// bound is not far above the mean.
PhotonChannel make_shared_channel(const PhotonVolume& volume, int channel);
bool can_share(const PhotonVolume& volume, int channel);

}  // namespace parian

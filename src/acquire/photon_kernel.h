// The inner loop of the photon engine: many photons side by side, each advanced from event to event
// by Woodcock tracking in a grid of voxels between two Fresnel boundaries.
//
// Lengths are in voxels, coefficients in 1/voxel; z = 0 is the surface, z grows into the medium.
// Beyond the grid the nearest voxel continues, to the sides and, in a half-infinite medium, below.
#pragma once

#include <cstddef>
#include <cstdint>

namespace parian {

// One channel of a medium as the kernel reads it. Pointers belong to the caller.
struct PhotonMedium {
  const float* voxels = nullptr;            // [z][y][x]{sigma_t, albedo}
  const float* g = nullptr;                 // [z][y][x], null: isotropic scattering
  const float* inverse_majorant = nullptr;  // [z][y][x] of cells: 1 / bound on sigma_t
  int nx = 1, ny = 1, nz = 1;
  // A cell's bound holds in the cell and its neighbours, so a flight from within it may go as far
  // as a cell is long before it needs another bound.
  float cell_voxels = 1;
  int cells_x = 1, cells_y = 1, cells_z = 1;
  float eta = 1.5f;
  float thickness = 0;  // infinity: half-infinite
  // Of the tables that recorded flights refer to: the grid with `pad` voxels more on all sides.
  int pad = 0;
};

enum class PhotonState : std::uint32_t { flying, left_top, left_bottom, absorbed, empty };

// Photons side by side. Random numbers come from one sfc32 generator per photon (three words and a
// counter), seeded by the photon's number: what a photon does depends on nothing but that.
struct PhotonLanes {
  static constexpr std::size_t count = 256;
  float x[count], y[count], z[count];
  float ux[count], uy[count], uz[count];
  float weight[count], absorbed[count];
  std::uint32_t a[count], b[count], c[count], counter[count];
  std::uint32_t state[count];  // PhotonState
  std::uint32_t pixel[count];  // in which light entered, as the caller numbers them
  float entry_x[count], entry_y[count];
  std::int32_t shift_x[count], shift_y[count];  // voxels by which recorded places are shifted back
  // Written by mark_lanes.
  float target[count];             // the weight that is wanted where the photon is
  std::uint32_t attention[count];  // not 0: left, or its weight is far from the target
};

// Advances the first `active` lanes (rounded up to 16) by `steps` flights. A photon that leaves
// stays where it left, with its direction inside the medium.
void fly_isotropic(PhotonLanes* lanes, const PhotonMedium* medium, std::size_t active, int steps);
void fly_anisotropic(PhotonLanes* lanes, const PhotonMedium* medium, std::size_t active, int steps);

// The same for paths that are to be shifted: absorption ends a photon instead of taking weight, so
// that weights do not depend on the place, and each flight leaves in row[lane] where it ended,
//   ((real (nz) + z) (ny + 2 pad) + y) (nx + 2 pad) + x, real = 1 where it was scattered,
// shifted back by the lane's shift and cut to the padded grid, or -1 where nothing happened. Rows
// are taken in turn from `trail`, [rows][lane], beginning with row `first`.
void record_isotropic(PhotonLanes* lanes, const PhotonMedium* medium, std::size_t active, int steps,
                      std::int32_t* trail, std::size_t rows, std::size_t first);
void record_anisotropic(PhotonLanes* lanes, const PhotonMedium* medium, std::size_t active,
                        int steps, std::int32_t* trail, std::size_t rows, std::size_t first);

// sum[j][i] += table[place + (j row + i) pixel] for each place of the lane's trail.
inline constexpr std::size_t shared_side = 8;
void add_trail(const float* table, const std::int32_t* trail, std::size_t rows, std::size_t first,
               std::size_t count, std::size_t pixel, std::size_t row, float* sum);

// Weights that photons should have by the distance s from where they entered, s^2 = dx^2 + dy^2 +
// (depth_factor z)^2: 1 up to `near`, then near / s, but not below `least`; and beyond `reach`,
// from where light hardly comes back, least (s / reach)^4 up to `most`. Photons below `low` times
// that are for Russian roulette, those above `high` for splitting. The default leaves all photons
// alike.
struct WeightWindow {
  float near = 1e15f, reach = 1e15f;
  float depth_factor = 1;
  float least = 1, most = 1;
  float low = 1e-3f, high = 1e30f;
  float restored = 1e-2f;  // what survives roulette weighs this times the target
};
void mark_lanes(PhotonLanes* lanes, const WeightWindow* window, std::size_t active);

// Photons number first_id, first_id + 1, ... of stream `key` fill the lanes, entering the square of
// side `side` at (entry_x, entry_y), which the caller has set. Lambertian light outside the surface
// is refracted into the medium; what is reflected is missing from the weight. Light that is not
// Lambertian enters along the normal.
void launch_photons(PhotonLanes* lanes, const std::uint64_t* ids, std::uint64_t key, float side,
                    float eta, bool lambertian, std::size_t count);

// The next number of a lane's generator, and a uniform one in (0, 1).
[[gnu::always_inline]] inline std::uint32_t sample_sfc32(std::uint32_t& a, std::uint32_t& b,
                                                         std::uint32_t& c, std::uint32_t& counter) {
  const std::uint32_t value = a + b + counter++;
  a = b ^ (b >> 9u);
  b = c + (c << 3u);
  c = ((c << 21u) | (c >> 11u)) + value;
  return value;
}
[[gnu::always_inline]] inline float to_open_uniform(std::uint32_t value) {
  return static_cast<float>(static_cast<std::int32_t>(value >> 9u)) * 0x1.0p-23f + 0x1.0p-24f;
}

}  // namespace parian

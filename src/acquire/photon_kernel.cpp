#include "acquire/photon_kernel.h"

#include <cmath>

#include "base/hot.h"
#include "base/random.h"
#include "math/fast_log.h"
#include "math/fast_sincos.h"

namespace parian {
namespace {

struct Direction {
  float x, y, z;
};

// The lanes' arrays as plain pointers, which is what compilers vectorise.
struct Arrays {
  float *PARIAN_RESTRICT x, *PARIAN_RESTRICT y, *PARIAN_RESTRICT z;
  float *PARIAN_RESTRICT ux, *PARIAN_RESTRICT uy, *PARIAN_RESTRICT uz;
  float *PARIAN_RESTRICT weight, *PARIAN_RESTRICT absorbed;
  std::uint32_t *PARIAN_RESTRICT a, *PARIAN_RESTRICT b, *PARIAN_RESTRICT c,
      *PARIAN_RESTRICT counter;
  std::uint32_t* PARIAN_RESTRICT state;
  const std::int32_t *PARIAN_RESTRICT shift_x, *PARIAN_RESTRICT shift_y;
};

enum class Mode { weights, record };

[[gnu::always_inline]] inline float clamp(float value, float most) {
  const float low = value > 0 ? value : 0;
  return low < most ? low : most;
}

// Unpolarised reflectance from inside, at cosine c: with cosine t outside,
//   F = 1/2 [((c - n t) / (c + n t))^2 + ((n c - t) / (n c + t))^2], 1 beyond the critical angle.
[[gnu::always_inline]] inline float reflect_fresnel(float c, float eta) {
  const float t2 = 1 - eta * eta * (1 - c * c);
  const float t = std::sqrt(t2 > 0 ? t2 : 0);
  const float s_minus = eta * c - t, s_plus = eta * c + t;
  const float p_minus = c - eta * t, p_plus = c + eta * t;
  const float s = s_minus * p_plus, p = p_minus * s_plus, both = s_plus * p_plus;
  const float reflected = 0.5f * (s * s + p * p) / (both * both);
  return t2 > 0 ? reflected : 1.0f;
}

// cos of the angle: (1 + g^2 - ((1 - g^2) / (1 - g + 2 g u))^2) / 2 g; |g| below 1e-3 counts as 0,
// where the mean cosine differs by less than what the tallies can tell.
[[gnu::always_inline]] inline float sample_henyey_greenstein(float g, float u) {
  const float magnitude = g < 0 ? -g : g;
  const float safe = magnitude < 1e-3f ? 1.0f : g;
  const float ratio = (1 - g * g) / (1 - g + 2 * g * u);
  const float cosine = (1 + g * g - ratio * ratio) / (2 * safe);
  const float isotropic = 2 * u - 1;
  const float value = magnitude < 1e-3f ? isotropic : cosine;
  return value < -1.0f ? -1.0f : (value > 1.0f ? 1.0f : value);
}

// Turns a direction by a polar angle with this cosine and an azimuth of u turns, in the basis of
// Duff et al. 2017; one Newton step keeps the length at 1.
[[gnu::always_inline]] inline Direction turn(Direction d, float cosine, float u) {
  const float s2 = 1 - cosine * cosine;
  const float sine = std::sqrt(s2 > 0 ? s2 : 0);
  const SinCos azimuth = fast_sincos_turn(u);
  const float p = sine * azimuth.cos, q = sine * azimuth.sin;
  const float sign = d.z < 0 ? -1.0f : 1.0f;
  const float a = -1 / (sign + d.z);
  const float b = d.x * d.y * a;
  const float x = cosine * d.x + p * (1 + sign * d.x * d.x * a) + q * b;
  const float y = cosine * d.y + p * (sign * b) + q * (sign + d.y * d.y * a);
  const float z = cosine * d.z - p * (sign * d.x) - q * d.y;
  const float scale = 1.5f - 0.5f * (x * x + y * y + z * z);
  return {x * scale, y * scale, z * scale};
}

[[gnu::always_inline]] inline Direction turn_isotropic(float u, float v) {
  const float cosine = 2 * u - 1;
  const float sine = std::sqrt(1 - cosine * cosine);
  const SinCos azimuth = fast_sincos_turn(v);
  return {sine * azimuth.cos, sine * azimuth.sin, cosine};
}

// One flight of one lane: ln u / majorant far, at most a cell; then a boundary, or a collision with
// probability sigma_t / majorant.
// Where in the padded grid, along one axis of n voxels.
[[gnu::always_inline]] inline int place_of(float position, std::int32_t shift, int n, int pad) {
  const int voxel = static_cast<int>(std::floor(position)) - shift;
  const int low = voxel > -pad ? voxel : -pad;
  return (low < n ? low : n) + pad;
}

template <bool anisotropic, Mode mode>
[[gnu::always_inline]] inline void fly_lane(const Arrays& lanes, const PhotonMedium& m,
                                            const float* PARIAN_RESTRICT voxels,
                                            const float* PARIAN_RESTRICT inverse_majorant,
                                            const float* PARIAN_RESTRICT anisotropy, float per_cell,
                                            std::int32_t* PARIAN_RESTRICT record, std::size_t i) {
  const bool is_flying = lanes.state[i] == 0;
  const float x = lanes.x[i], y = lanes.y[i], z = lanes.z[i];
  const Direction d{lanes.ux[i], lanes.uy[i], lanes.uz[i]};
  std::uint32_t a = lanes.a[i], b = lanes.b[i], c = lanes.c[i], counter = lanes.counter[i];
  const float u1 = to_open_uniform(sample_sfc32(a, b, c, counter));
  const float u2 = to_open_uniform(sample_sfc32(a, b, c, counter));
  const float u3 = to_open_uniform(sample_sfc32(a, b, c, counter));
  const float u4 = to_open_uniform(sample_sfc32(a, b, c, counter));
  lanes.a[i] = a, lanes.b[i] = b, lanes.c[i] = c, lanes.counter[i] = counter;

  const int cx = static_cast<int>(clamp(x * per_cell, static_cast<float>(m.cells_x) - 0.5f));
  const int cy = static_cast<int>(clamp(y * per_cell, static_cast<float>(m.cells_y) - 0.5f));
  const int cz = static_cast<int>(clamp(z * per_cell, static_cast<float>(m.cells_z) - 0.5f));
  const float inverse = inverse_majorant[(cz * m.cells_y + cy) * m.cells_x + cx];
  const float wanted = -fast_log(u1) * inverse;
  const bool is_cut = wanted > m.cell_voxels;
  const float far = is_cut ? m.cell_voxels : wanted;
  const float s = is_flying ? far : 0.0f;

  const float end_z = z + s * d.z;
  const bool at_top = end_z<0, at_bottom = end_z> m.thickness;
  const bool at_boundary = at_top | at_bottom;
  const float boundary_z = at_bottom ? m.thickness : 0.0f;
  const float cosine = d.z < 0 ? -d.z : d.z;
  const float way = (at_bottom ? m.thickness - z : z) / cosine;
  const float t = at_boundary ? way : s;
  const float px = x + t * d.x, py = y + t * d.y;
  const float pz = at_boundary ? boundary_z : end_z;
  const bool leaves = at_boundary & (u2 >= reflect_fresnel(cosine, m.eta));

  const int vx = static_cast<int>(clamp(px, static_cast<float>(m.nx) - 0.5f));
  const int vy = static_cast<int>(clamp(py, static_cast<float>(m.ny) - 0.5f));
  const int vz = static_cast<int>(clamp(pz, static_cast<float>(m.nz) - 0.5f));
  const int voxel = (vz * m.ny + vy) * m.nx + vx;
  const float sigma_t = voxels[2 * voxel], albedo = voxels[2 * voxel + 1];
  const bool at_place = is_flying & !is_cut & !at_boundary;
  const bool collides = at_place & (u2 < sigma_t * inverse);
  const bool is_absorbed = mode == Mode::record && (collides & !(u2 < sigma_t * albedo * inverse));

  Direction scattered;
  if constexpr (anisotropic)
    scattered = turn(d, sample_henyey_greenstein(anisotropy[voxel], u3), u4);
  else
    scattered = turn_isotropic(u3, u4);
  const bool is_reflected = at_boundary & !leaves;
  const float passed_z = is_reflected ? -d.z : d.z;
  const std::uint32_t left = at_top ? 1u : 2u;
  std::uint32_t state = leaves ? left : lanes.state[i];
  if constexpr (mode == Mode::weights) {
    const float weight = lanes.weight[i];
    const float kept = collides ? weight * albedo : weight;
    lanes.absorbed[i] += weight - kept;
    lanes.weight[i] = kept;
  } else {
    state = is_absorbed ? 3u : state;
    const int x0 = place_of(px, lanes.shift_x[i], m.nx, m.pad);
    const int y0 = place_of(py, lanes.shift_y[i], m.ny, m.pad);
    const int z0 = vz + (collides ? m.nz : 0);
    const int place = (z0 * (m.ny + 2 * m.pad) + y0) * (m.nx + 2 * m.pad) + x0;
    record[i] = at_place ? place : -1;
  }
  lanes.x[i] = px, lanes.y[i] = py, lanes.z[i] = pz;
  lanes.ux[i] = collides ? scattered.x : d.x;
  lanes.uy[i] = collides ? scattered.y : d.y;
  lanes.uz[i] = collides ? scattered.z : passed_z;
  lanes.state[i] = state;
}

template <bool anisotropic, Mode mode>
[[gnu::always_inline]] inline void fly(PhotonLanes* lanes, const PhotonMedium* medium,
                                       std::size_t active, int steps, std::int32_t* trail,
                                       std::size_t rows, std::size_t first) {
  const PhotonMedium m = *medium;
  const float per_cell = 1 / m.cell_voxels;
  const Arrays arrays{lanes->x,  lanes->y,       lanes->z,        lanes->ux,      lanes->uy,
                      lanes->uz, lanes->weight,  lanes->absorbed, lanes->a,       lanes->b,
                      lanes->c,  lanes->counter, lanes->state,    lanes->shift_x, lanes->shift_y};
  const std::size_t end = (active + 15) / 16 * 16;
  for (int step = 0; step < steps; ++step) {
    std::int32_t* record = trail;
    if constexpr (mode == Mode::record)
      record += (first + static_cast<std::size_t>(step)) % rows * PhotonLanes::count;
    PARIAN_INDEPENDENT
    for (std::size_t i = 0; i < end; ++i)
      fly_lane<anisotropic, mode>(arrays, m, m.voxels, m.inverse_majorant, m.g, per_cell, record,
                                  i);
  }
}

}  // namespace

PARIAN_HOT void fly_isotropic(PhotonLanes* PARIAN_RESTRICT lanes,
                              const PhotonMedium* PARIAN_RESTRICT medium, std::size_t active,
                              int steps) {
  fly<false, Mode::weights>(lanes, medium, active, steps, nullptr, 1, 0);
}

PARIAN_HOT void fly_anisotropic(PhotonLanes* PARIAN_RESTRICT lanes,
                                const PhotonMedium* PARIAN_RESTRICT medium, std::size_t active,
                                int steps) {
  fly<true, Mode::weights>(lanes, medium, active, steps, nullptr, 1, 0);
}

PARIAN_HOT void record_isotropic(PhotonLanes* PARIAN_RESTRICT lanes,
                                 const PhotonMedium* PARIAN_RESTRICT medium, std::size_t active,
                                 int steps, std::int32_t* PARIAN_RESTRICT trail, std::size_t rows,
                                 std::size_t first) {
  fly<false, Mode::record>(lanes, medium, active, steps, trail, rows, first);
}

PARIAN_HOT void record_anisotropic(PhotonLanes* PARIAN_RESTRICT lanes,
                                   const PhotonMedium* PARIAN_RESTRICT medium, std::size_t active,
                                   int steps, std::int32_t* PARIAN_RESTRICT trail, std::size_t rows,
                                   std::size_t first) {
  fly<true, Mode::record>(lanes, medium, active, steps, trail, rows, first);
}

PARIAN_HOT void add_trail(const float* PARIAN_RESTRICT table,
                          const std::int32_t* PARIAN_RESTRICT trail, std::size_t rows,
                          std::size_t first, std::size_t count, std::size_t pixel, std::size_t row,
                          float* PARIAN_RESTRICT sum) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t place = trail[(first + k) % rows * PhotonLanes::count];
    if (place < 0) continue;
    const float* at = table + place;
    for (std::size_t j = 0; j < shared_side; ++j) {
      const float* line = at + j * row * pixel;
      if (pixel == 1)
        for (std::size_t i = 0; i < shared_side; ++i) sum[j * shared_side + i] += line[i];
      else
        for (std::size_t i = 0; i < shared_side; ++i) sum[j * shared_side + i] += line[i * pixel];
    }
  }
}

PARIAN_HOT void mark_lanes(PhotonLanes* PARIAN_RESTRICT lanes,
                           const WeightWindow* PARIAN_RESTRICT window, std::size_t active) {
  const WeightWindow w = *window;
  const float near_squared = w.near * w.near, per_reach = 1 / (w.reach * w.reach);
  for (std::size_t i = 0; i < active; ++i) {
    const float dx = lanes->x[i] - lanes->entry_x[i], dy = lanes->y[i] - lanes->entry_y[i];
    const float dz = w.depth_factor * lanes->z[i];
    const float s2 = dx * dx + dy * dy + dz * dz;
    const float falling = std::sqrt(near_squared / (s2 > near_squared ? s2 : near_squared));
    const float inside = falling > w.least ? falling : w.least;
    const float far = s2 * per_reach;
    const float rising = w.least * far * far;
    const float outside = rising < w.most ? rising : w.most;
    const float target = far > 1 ? outside : inside;
    const float weight = lanes->weight[i];
    lanes->target[i] = target;
    const bool is_off = (weight < w.low * target) | (weight > w.high * target);
    lanes->attention[i] = lanes->state[i] | (is_off ? 8u : 0u);
  }
}

PARIAN_HOT void launch_photons(PhotonLanes* PARIAN_RESTRICT lanes,
                               const std::uint64_t* PARIAN_RESTRICT ids, std::uint64_t key,
                               float side, float eta, bool lambertian, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t low = hash_u64(key ^ hash_u64(ids[i]));
    const std::uint64_t high = hash_u64(low);
    std::uint32_t a = static_cast<std::uint32_t>(low), b = static_cast<std::uint32_t>(low >> 32u);
    std::uint32_t c = static_cast<std::uint32_t>(high);
    std::uint32_t counter = static_cast<std::uint32_t>(high >> 32u);
    const float u1 = to_open_uniform(sample_sfc32(a, b, c, counter));
    const float u2 = to_open_uniform(sample_sfc32(a, b, c, counter));
    const float u3 = to_open_uniform(sample_sfc32(a, b, c, counter));
    const float u4 = to_open_uniform(sample_sfc32(a, b, c, counter));
    lanes->a[i] = a, lanes->b[i] = b, lanes->c[i] = c, lanes->counter[i] = counter;
    // Lambertian: sin^2 of the angle outside is uniform; Snell divides it by eta^2.
    const float sine2 = lambertian ? u3 / (eta * eta) : 0.0f;
    const float cosine = std::sqrt(1 - sine2), sine = std::sqrt(sine2);
    const SinCos azimuth = fast_sincos_turn(u4);
    lanes->ux[i] = sine * azimuth.cos, lanes->uy[i] = sine * azimuth.sin, lanes->uz[i] = cosine;
    lanes->x[i] = lanes->entry_x[i] + side * u1, lanes->y[i] = lanes->entry_y[i] + side * u2;
    lanes->entry_x[i] = lanes->x[i], lanes->entry_y[i] = lanes->y[i];
    lanes->z[i] = 0;
    // The way in reflects as much as the way out (reciprocity).
    lanes->weight[i] = 1 - reflect_fresnel(cosine, eta);
    lanes->absorbed[i] = 0;
    lanes->state[i] = 0;
  }
}

}  // namespace parian

// Follows a batch of photons from some pixels of a sample and tallies where their light leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "acquire/photon_volume.h"

namespace parian {

// How light enters: Lambertian over the pixel's area, which makes R reciprocal, or as a beam along
// the normal.
enum class PhotonEntry { lambertian, normal };

// Powers, in units of what was sent at the surface. What roulette and splitting have added minus
// what they have taken away keeps the balance exact:
//   launched + roulette = specular + reflected + transmitted + absorbed
struct PhotonTotals {
  double launched = 0;
  double specular = 0;     // reflected at entry, never inside
  double reflected = 0;    // left through the surface, wherever
  double transmitted = 0;  // left through the lower boundary
  double absorbed = 0;
  double roulette = 0;
  double flights = 0;  // work
};
PhotonTotals& operator+=(PhotonTotals& sum, const PhotonTotals& more);
// launched + roulette - the rest; 0 but for rounding.
double balance(const PhotonTotals& totals);

// One pixel's tally: power that left, per offset of (2 radius + 1)^2 around it; light that leaves
// further away or outside of the sample's pixels is in the totals only.
struct PhotonTask {
  const PhotonVolume* volume = nullptr;
  const PhotonChannel* channel = nullptr;
  PhotonEntry entry = PhotonEntry::lambertian;
  WeightWindow window;
  int radius = 1;               // pixels
  std::size_t first_pixel = 0;  // in which light enters, row major
  std::size_t pixels = 1;
  std::uint64_t key = 0;           // of all random numbers
  std::uint64_t first_photon = 0;  // of every pixel
  std::uint64_t photons = 1;       // per pixel
};

// Adds to tally[pixel - first_pixel][dy + radius][dx + radius]. The same bits for the same task.
PhotonTotals trace_photons(const PhotonTask& task, float* tally);

}  // namespace parian

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
  // Every path that leaves counts for all pixels of the task, each with the probability that it
  // would have had from there, shifted by whole pixels, among all of them. That is the expectation
  // of the tally given the path up to a shift: unbiased, and never of larger variance. Takes a
  // channel of make_shared_channel, at most 8 x 8 pixels, and a window without splitting.
  bool shared = false;
  int radius = 1;      // pixels
  int x0 = 0, y0 = 0;  // in which light enters: columns x rows pixels from here
  int columns = 1, rows = 1;
  std::uint64_t key = 0;           // of all random numbers
  std::uint64_t first_photon = 0;  // of every pixel
  std::uint64_t photons = 1;       // per pixel

  std::uint64_t pixels() const {
    return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  }
};

// Adds to tally[y - y0][x - x0][dy + radius][dx + radius]. The same bits for the same task.
PhotonTotals trace_photons(const PhotonTask& task, float* tally);

}  // namespace parian

// The pairs of a table as the 2019 paper's energy sees them (Eq. 5), its value and its gradient:
// offset by offset over whole planes, each offset between two knots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/aligned.h"
#include "material/bssrdf_table.h"

namespace parian::kbmpp {

struct Member {
  Offset offset;
  std::ptrdiff_t shift = 0;  // of the partner in a plane
  std::size_t plane = 0;     // of log_reflectance
};

// The pixels of a plane whose partner lies in the plane: logs are NaN where it is on another row's
// far side.
struct PlaneRange {
  std::size_t begin = 0, end = 0;
};
PlaneRange range_of(const Member& member, std::size_t pixels);

// Offsets of one length: w = m phi, and hat functions low, high at knots segment, segment + 1.
struct Ring {
  std::size_t segment = 0;
  double weight = 0, low = 0, high = 0;
  std::vector<Member> members;
};

struct Pairs {
  int width = 0, height = 0, channels = 0;
  std::size_t knots = 0;
  std::size_t row = 0;  // floats of a row [knot][4]: channels padded to four
  std::vector<Ring> rings;
  // Work of one thread at a time: consecutive rings of one segment.
  struct Task {
    std::size_t channel = 0, segment = 0, begin = 0, end = 0;
  };
  std::vector<Task> tasks;
  std::size_t planes = 0;                // offsets that take part
  AlignedVector<float> log_reflectance;  // 2 ln R [channel][plane][y][x]; NaN takes no part
  bool complete = true;                  // every pair inside the grid takes part
  // Second derivative of the energy by one pixel's row: tridiagonal over knots, per pixel.
  AlignedVector<float> diagonal, off_diagonal;  // [y][x][row]

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  const float* logs(std::size_t channel, std::size_t plane) const {
    return log_reflectance.data() + (channel * planes + plane) * pixels();
  }
};

Pairs make_pairs(const BssrdfTable& table, const std::vector<double>& knots_mm);

// Indices, weights and bases in single precision.
struct Model {
  std::size_t bases = 0, per_pixel = 0;
  AlignedVector<float> base_rows;    // [base][row]
  std::vector<std::uint16_t> index;  // [y][x][k]
  AlignedVector<float> weight;       // [y][x][k]
};

// Space for evaluations; what it holds after one belongs to that model.
struct Workspace {
  AlignedVector<float> rows;             // ln P, [y][x][row]
  AlignedVector<float> gradient;         // of E_LS by `rows`
  AlignedVector<float> base_gradient;    // of E_LS by bases, [base][row]
  AlignedVector<float> weight_gradient;  // of E_LS by weights, [y][x][k]
  AlignedVector<float> planes;           // ln P, [channel][knot][y][x]
  AlignedVector<float> partial;          // [task][low, high][y][x]
  AlignedVector<float> base_partial;     // [block][base][row]
  std::vector<double> task_energy;
};

// E_LS; fills `work`.
double eval_energy(const Pairs& pairs, const Model& model, Workspace& work);

}  // namespace parian::kbmpp

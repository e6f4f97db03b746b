// A measured table seen slice by slice: the interface through which tables reach algorithms, so
// that a table larger than memory can be written, fitted, compared and relit.
//
// A slice is R_d at one channel and one offset d for all pixels x: R_d(x, x + d) in 1/mm^2, row
// major [y][x]. io implements sources over HDF5, acquire over a simulation, make_slices
// (material.h) over a model, tests over memory (bssrdf_table.h).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "image/image.h"

namespace parian {

// Whether the Fresnel losses at entry and exit are inside R_d.
enum class Boundary { excluded, included };
// Whether R_d belongs to pixel centres or is the mean over both pixels' areas.
enum class Sampling { point, area };

// In pixels: dx to the right, dy down.
struct Offset {
  int dx = 0;
  int dy = 0;
  friend bool operator==(const Offset&, const Offset&) = default;
};

double length_px(Offset offset);

// Everything about a table but its values (design: BSSRDF table).
struct TableHeader {
  int width = 0;
  int height = 0;
  int channels = 3;  // 1, or 3: linear Rec. 709
  double pixel_pitch_mm = 1;
  Boundary boundary = Boundary::excluded;
  double eta = 1.3;
  // true: offsets are a subset of the half plane (dy > 0, or dy = 0 and dx >= 0) and each value is
  // the mean of both directions. false: d and -d are both listed; x is where light leaves.
  bool symmetric = true;
  Sampling sampling = Sampling::point;
  // Per channel: the variance of a value R is floor^2 + gain R. Both empty: no noise model.
  std::vector<double> noise_floor;
  std::vector<double> noise_gain;
  std::string provenance;       // JSON text, may be empty
  std::vector<Offset> offsets;  // each once; (0,0) among them

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  bool has_noise_model() const { return !noise_floor.empty(); }
};

// Throws Error with `name` as its file when the header breaks a rule of the format.
void check(const TableHeader& header, const std::string& name);

// Largest |d| in pixels.
double radius_px(const TableHeader& header);

// Index of the offset, or -1.
int find_offset(const TableHeader& header, Offset offset);

// The pixels x of a slice whose partner x + d is inside the grid: [x0, x1) x [y0, y1), maybe empty.
struct PixelRange {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};
PixelRange pairs_in_grid(const TableHeader& header, Offset offset);

// How often a measured pair counts in sums over ordered pairs: 2 for d != 0 of a symmetric table,
// otherwise 1.
inline int pair_count(const TableHeader& header, Offset offset) {
  return header.symmetric && offset != Offset{} ? 2 : 1;
}

class SliceSource {
 public:
  virtual ~SliceSource() = default;
  virtual const TableHeader& header() const = 0;
  // How errors name the table, usually its file; may be empty.
  virtual std::string name() const = 0;
  // Writes width*height values to `slice`: NaN outside the grid and where not measured, otherwise
  // finite. Values <= 0 occur only in tables with a noise model, and in models' slices, which may
  // underflow to 0. May be called from several threads at once. Throws Error on bad data.
  virtual void read_slice(int channel, int offset_index, float* slice) const = 0;
};

class SliceSink {
 public:
  virtual ~SliceSink() = default;
  // Each slice once, in any order, from one thread at a time.
  virtual void write_slice(int channel, int offset_index, const float* slice) = 0;
  // After the last slice; nothing is visible to others before it returns.
  virtual void finish() = 0;
};

// Sets what is outside the grid to NaN and checks the rest: +-inf always throws, values <= 0 throw
// without a noise model. Errors name channel, offset and pixel. Returns the number of values <= 0.
std::size_t clean_slice(const TableHeader& header, const std::string& name, int channel,
                        int offset_index, float* slice);

// Copies all slices, computing several at once, and finishes the sink.
void copy_slices(const SliceSource& source, SliceSink& sink, const Progress& progress = {});

// Calls body(channel, offset_index, slice) for each slice, one at a time, in order of channel and
// offset, while the following slices are read ahead on the other threads.
void for_each_slice(
    const SliceSource& source, const Progress& progress, std::string_view stage,
    const std::function<void(int channel, int offset_index, const float* slice)>& body);

}  // namespace parian

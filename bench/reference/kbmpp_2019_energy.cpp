#include <algorithm>

#include "base/parallel.h"
#include "bench/reference/kbmpp_2019_kernels.h"
#include "bench/reference/kbmpp_2019_pairs.h"

namespace parian::kbmpp {
namespace {

constexpr std::size_t tile = 64;            // pixels transposed at a time: rows stay in L1
constexpr std::size_t project_blocks = 16;  // each with base gradients of its own

std::size_t plane_index(const Pairs& pairs, std::size_t channel, std::size_t knot) {
  return (channel * pairs.knots + knot) * pairs.pixels();
}

void prepare(const Pairs& pairs, const Model& model, Workspace& work) {
  const std::size_t pixels = pairs.pixels();
  work.rows.resize(pixels * pairs.row);
  work.gradient.resize(pixels * pairs.row);
  work.base_gradient.resize(model.bases * pairs.row);
  work.weight_gradient.resize(pixels * model.per_pixel);
  work.planes.resize(static_cast<std::size_t>(pairs.channels) * pairs.knots * pixels);
  work.partial.resize(pairs.tasks.size() * 2 * pixels);
  work.base_partial.resize(project_blocks * model.bases * pairs.row);
  work.task_energy.resize(pairs.tasks.size());
}

// ln P of all pixels, by rows and by planes.
void mix(const Pairs& pairs, const Model& model, Workspace& work) {
  const std::size_t row = pairs.row;
  parallel_for_blocks(pairs.pixels(), 8 * tile, [&](std::size_t first, std::size_t last) {
    for (std::size_t begin = first; begin < last; begin += tile) {
      const std::size_t count = std::min(tile, last - begin);
      float* rows = work.rows.data() + begin * row;
      mix_rows(model.base_rows.data(), model.index.data() + begin * model.per_pixel,
               model.weight.data() + begin * model.per_pixel, count, model.per_pixel, row, rows);
      for (std::size_t c = 0; c < static_cast<std::size_t>(pairs.channels); ++c)
        for (std::size_t h = 0; h < pairs.knots; ++h) {
          float* plane = work.planes.data() + plane_index(pairs, c, h) + begin;
          for (std::size_t i = 0; i < count; ++i) plane[i] = rows[i * row + 4 * h + c];
        }
    }
  });
}

// Energy of a task's rings; their gradient by the planes of both knots goes to `low` and `high`.
double sum_rings(const Pairs& pairs, const Pairs::Task& task, const Workspace& work, float* low,
                 float* high) {
  const std::size_t pixels = pairs.pixels();
  thread_local AlignedVector<float> q, at, partner;
  q.resize(pixels);
  if (at.size() != pixels) {  // otherwise zero: spread leaves them so
    at.assign(pixels, 0.0f);
    partner.assign(pixels, 0.0f);
  }
  std::fill(low, low + pixels, 0.0f);
  std::fill(high, high + pixels, 0.0f);
  const float* a = work.planes.data() + plane_index(pairs, task.channel, task.segment);
  double energy = 0;
  for (std::size_t i = task.begin; i < task.end; ++i) {
    const Ring& ring = pairs.rings[i];
    interpolate(a, a + pixels, static_cast<float>(ring.low), static_cast<float>(ring.high), pixels,
                q.data());
    double squares = 0;
    for (const Member& m : ring.members) {
      const PlaneRange range = range_of(m, pixels);
      squares += add_residuals(q.data(), pairs.logs(task.channel, m.plane), m.shift, range.begin,
                               range.end, at.data(), partner.data());
    }
    energy += 0.5 * ring.weight * squares;
    spread(at.data(), partner.data(), static_cast<float>(ring.weight * ring.low),
           static_cast<float>(ring.weight * ring.high), pixels, low, high);
  }
  return energy;
}

// Adds up the tasks' planes of each channel and knot, in the order of tasks, and turns them into
// rows.
void gather_gradient(const Pairs& pairs, Workspace& work) {
  const std::size_t pixels = pairs.pixels(), row = pairs.row;
  std::vector<std::vector<const float*>> parts(row);
  for (std::size_t t = 0; t < pairs.tasks.size(); ++t)
    for (std::size_t side = 0; side < 2; ++side)
      parts[4 * (pairs.tasks[t].segment + side) + pairs.tasks[t].channel].push_back(
          work.partial.data() + (2 * t + side) * pixels);
  parallel_for_blocks(pixels, 8 * tile, [&](std::size_t first, std::size_t last) {
    for (std::size_t begin = first; begin < last; begin += tile) {
      const std::size_t count = std::min(tile, last - begin);
      float* rows = work.gradient.data() + begin * row;
      for (std::size_t j = 0; j < row; ++j) {
        float sum[tile] = {};
        for (const float* part : parts[j])
          for (std::size_t i = 0; i < count; ++i) sum[i] += part[begin + i];
        for (std::size_t i = 0; i < count; ++i) rows[i * row + j] = sum[i];
      }
    }
  });
}

// The chain rule through Eq. 4, by fixed blocks of pixels.
void project(const Pairs& pairs, const Model& model, Workspace& work) {
  const std::size_t pixels = pairs.pixels(), size = model.bases * pairs.row;
  const std::size_t block = (pixels + project_blocks - 1) / project_blocks;
  const std::size_t blocks = (pixels + block - 1) / block;
  parallel_for(blocks, [&](std::size_t b) {
    const std::size_t begin = b * block, count = std::min(block, pixels - begin);
    float* to = work.base_partial.data() + b * size;
    std::fill(to, to + size, 0.0f);
    project_rows(model.base_rows.data(), model.index.data() + begin * model.per_pixel,
                 model.weight.data() + begin * model.per_pixel,
                 work.gradient.data() + begin * pairs.row, count, model.per_pixel, pairs.row, to,
                 work.weight_gradient.data() + begin * model.per_pixel);
  });
  std::fill(work.base_gradient.begin(), work.base_gradient.end(), 0.0f);
  for (std::size_t b = 0; b < blocks; ++b)
    for (std::size_t j = 0; j < size; ++j) work.base_gradient[j] += work.base_partial[b * size + j];
}

}  // namespace

double eval_energy(const Pairs& pairs, const Model& model, Workspace& work) {
  const std::size_t pixels = pairs.pixels();
  prepare(pairs, model, work);
  mix(pairs, model, work);
  parallel_for(pairs.tasks.size(), [&](std::size_t t) {
    float* low = work.partial.data() + 2 * t * pixels;
    work.task_energy[t] = sum_rings(pairs, pairs.tasks[t], work, low, low + pixels);
  });
  gather_gradient(pairs, work);
  project(pairs, model, work);
  double energy = 0;
  for (const double e : work.task_energy) energy += e;
  return energy;
}

}  // namespace parian::kbmpp

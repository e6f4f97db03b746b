// Weights, indices, relit flats and errors as in Fig. 3, 4, 5, 9 and 10 of the 2019 paper.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/common/assets.h"
#include "bench/compression/study.h"
#include "bench/reference/lsp_clusters.h"
#include "compress/pictures.h"
#include "judge/false_color.h"
#include "judge/relight.h"
#include "judge/row_sums.h"
#include "render/render.h"

namespace parian::compression {
namespace {

Image to_rgb(const Image& image) {
  if (image.channels == 3) return image;
  Image rgb = make_image(image.width, image.height, 3);
  for (std::size_t i = 0; i < image.values.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) rgb.values[3 * i + c] = image.values[i];
  return rgb;
}

Image stack(const std::vector<Image>& rows, int gap = 6) {
  int width = 0, height = -gap;
  for (const Image& row : rows) {
    width = std::max(width, row.width);
    height += row.height + gap;
  }
  Image page = make_image(width, height, 3, 1);
  int top = 0;
  for (const Image& row : rows) {
    for (int y = 0; y < row.height; ++y)
      for (int x = 0; x < row.width; ++x)
        for (int c = 0; c < 3; ++c) at(page, x, top + y, c) = at(row, x, y, c);
    top += row.height + gap;
  }
  return page;
}

// |rho' - rho| / |rho| as colours, 0 to `most`.
Image draw_albedo_error(const Image& albedo, const Image& reference, float most) {
  Image errors = make_image(albedo.width, albedo.height, 1);
  for (int y = 0; y < albedo.height; ++y)
    for (int x = 0; x < albedo.width; ++x) {
      float miss = 0, norm = 0;
      for (int c = 0; c < albedo.channels; ++c) {
        const float d = at(albedo, x, y, c) - at(reference, x, y, c);
        miss += d * d;
        norm += at(reference, x, y, c) * at(reference, x, y, c);
      }
      at(errors, x, y, 0) = std::sqrt(miss / norm);
    }
  return false_color(errors, static_cast<double>(most));
}

// Uniform, disc and line light, and the albedo's error, side by side.
Image draw_row(const Sample& sample, const SliceSource& slices, const Image& reference) {
  const float brightness = *std::max_element(reference.values.begin(), reference.values.end());
  const TableHeader& header = sample.table.header;
  std::vector<Image> lights;
  for (FlatLight light : {FlatLight::uniform, FlatLight::disc, FlatLight::line})
    lights.push_back(make_flat_light(light, header.width, header.height, 1));
  std::vector<Image> row = relight(slices, lights);
  for (Image& image : row) image = scale(image, 0.9f / brightness);
  row.push_back(draw_albedo_error(measure_row_sums(slices).albedo, reference, 0.1f));
  return place_side_by_side(row, 6);
}

void draw_methods(const Page& page, const Sample& sample) {
  const auto source = make_slices(sample.table, sample.name);
  const Image reference = measure_row_sums(*source).albedo;
  std::vector<Image> rows{draw_row(sample, *source, reference)};
  const Material map = sample.map;
  rows.push_back(draw_row(sample, *make_slices(map, sample.table.header), reference));
  const Compressed two = compress_sample(sample, make_params(128, 2));
  rows.push_back(
      draw_row(sample, *compress_lsp_clusters(sample.table, two.bytes).slices, reference));
  for (int k : {1, 2, 3, 5}) {
    const Compressed compressed = compress_sample(sample, make_params(128, k));
    const Material blend = compressed.blend;
    rows.push_back(draw_row(sample, *make_slices(blend, sample.table.header), reference));
    if (k != 3) continue;
    write_picture(page, fmt::format("weights-{}", sample.name),
                  magnify(to_rgb(make_weight_image(compressed.blend)), 2));
    write_picture(page, fmt::format("indices-{}", sample.name),
                  magnify(make_index_image(compressed.blend), 2));
  }
  write_picture(page, fmt::format("methods-{}", sample.name), stack(rows));
}

// Fig. 10: M = 8, 32, 128.
void draw_bases(const Page& page, const Sample& sample) {
  const auto source = make_slices(sample.table, sample.name);
  const Image reference = measure_row_sums(*source).albedo;
  std::vector<Image> rows{draw_row(sample, *source, reference)};
  for (int bases : {8, 32, 128}) {
    const Material blend = compress_sample(sample, make_params(bases, 2)).blend;
    rows.push_back(draw_row(sample, *make_slices(blend, sample.table.header), reference));
  }
  write_picture(page, fmt::format("bases-{}", sample.name), stack(rows));
}

// Fig. 7: the dragon with the map, with the blend, and ten times their difference.
void draw_dragon(const Page& page, const Sample& sample) {
  constexpr double size_mm = 80;
  Scene scene;
  scene.mesh = make_bench_mesh("dragon-100250.ply", 2, size_mm);
  scene.lights = {make_bench_environment()};
  const Bounds3 box = bounds(scene.mesh);
  scene.camera.target = center(box);
  scene.camera.position = center(box) + Vec3{0.3f, 0.35f, 1} * (1.9f * static_cast<float>(size_mm));
  scene.camera.width = 420;
  scene.camera.height = 315;
  std::vector<Image> images;
  for (const Material& material :
       {Material(sample.map), Material(compress_sample(sample, make_params(128, 2)).blend)}) {
    scene.material = material;
    images.push_back(render(scene).image);
  }
  Image difference = images[0];
  for (std::size_t i = 0; i < difference.values.size(); ++i)
    difference.values[i] = 10 * std::abs(images[0].values[i] - images[1].values[i]);
  images.push_back(difference);
  write_picture(page, "dragon", place_side_by_side(images, 6));
}

}  // namespace

void study_pictures(const Page& page) {
  const Sample stone = load_sample("artificial-stone");
  draw_methods(page, stone);
  draw_bases(page, stone);
  draw_dragon(page, stone);
  draw_methods(page, load_sample("blue-wax"));
}

}  // namespace parian::compression

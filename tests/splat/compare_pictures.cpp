#include "tests/splat/compare_pictures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/image/image_file.h"

namespace parian {
namespace {

Vec3 pixel(const Image& image, std::size_t i) {
  return {image.values[3 * i], image.values[3 * i + 1], image.values[3 * i + 2]};
}

}  // namespace

PictureErrors compare_pictures(const Image& reference, const Image& image,
                               const std::vector<float>& coverage) {
  double most = 0;
  for (std::size_t i = 0; i < coverage.size(); ++i)
    most = std::max(most, static_cast<double>(length(pixel(reference, i))));
  std::vector<double> errors;
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const Vec3 wanted = pixel(reference, i), found = pixel(image, i);
    if (coverage[i] < 0.999f || wanted == Vec3{}) continue;
    errors.push_back(static_cast<double>(distance(wanted, found)) /
                     (static_cast<double>(length(wanted)) + 1e-3 * most));
  }
  PictureErrors result;
  result.pixels = errors.size();
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  for (const double error : errors) result.mean += error / static_cast<double>(errors.size());
  result.p99 = errors[errors.size() * 99 / 100];
  result.max = errors.back();
  return result;
}

Image render_reference(Scene scene, int samples, int rays) {
  scene.specular.enabled = false;
  RenderParams params;
  params.samples = samples;
  params.rays = rays;
  params.antialias = 1;
  params.method = GatherMethod::tree;
  params.quality = 0.0005;
  return render(scene, params).image;
}

std::string dump_pictures(const std::string& name, const Image& reference, const Image& image) {
  const std::string folder = std::filesystem::temp_directory_path() / name;
  Image difference = image;
  for (std::size_t i = 0; i < image.values.size(); ++i)
    difference.values[i] =
        std::clamp(0.5f + 10 * (image.values[i] - reference.values[i]), 0.0f, 1.0f);
  save_image(folder + ".png", image);
  save_image(folder + "-reference.png", reference);
  save_image(folder + "-difference.png", difference);
  return "pictures: " + folder + "*.png";
}

}  // namespace parian

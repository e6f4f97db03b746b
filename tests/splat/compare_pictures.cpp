#include "tests/splat/compare_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "io/image/image_file.h"

namespace parian {
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

void expect_close(const Image& reference, const Image& image, const std::vector<float>& coverage,
                  const std::string& name) {
  const RelativeErrors errors = relative_errors(reference, image, coverage);
  EXPECT_GT(errors.pixels, 2000u);
  EXPECT_LE(errors.mean, 0.02);
  EXPECT_LE(errors.p99, 0.08);
  ::testing::Test::RecordProperty("mean", std::to_string(errors.mean));
  ::testing::Test::RecordProperty("p99", std::to_string(errors.p99));
  if (::testing::Test::HasFailure()) ADD_FAILURE() << dump_pictures(name, reference, image);
}

}  // namespace parian

// Environment light: lookup, and directions drawn by its brightness.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace parian {

// Bilinear, times the light's scale; columns wrap around.
inline constexpr double max_radiance = 1e12;

// An image from outside as EnvironmentLight wants it: three channels. Values below 0, which lossy
// compression leaves, count as 0; `negative` gets their number. Throws Error with `name` as its
// file for two or more than three channels, for a width other than twice the height, and for values
// that are not finite or above max_radiance.
Image make_environment_image(Image image, const std::string& name, std::size_t* negative = nullptr);

Rgb eval_environment(const EnvironmentLight& light, Vec3 direction);
Rgb eval_environment_at(const EnvironmentLight& light, Vec2 uv);
// Direction through a place of the image, both in [0, 1), and back.
Vec3 environment_direction(const EnvironmentLight& light, Vec2 uv);
Vec2 environment_uv(const EnvironmentLight& light, Vec3 direction);

// Proportional to the luminance of the bilinear image, as that is a sum of tents around pixels: a
// pixel is drawn by luminance times the sine of its row, then a place under its tent. The light
// must outlive the sampler. A black image has pdf 0 everywhere.
struct EnvironmentSampler {
  const EnvironmentLight* light = nullptr;
  std::vector<float> row_sine;    // [height]: of the angle from +y at the rows' centres
  std::vector<float> row_cdf;     // [height + 1]
  std::vector<float> column_cdf;  // [height][width + 1]
  float density = 0;              // of places in [0, 1)^2 per luminance times sine; 0: black
};
EnvironmentSampler make_environment_sampler(const EnvironmentLight& light);
struct DirectionSample {
  Vec3 direction;
  float pdf = 0;  // per solid angle
  Vec2 uv;        // its place in the image
};
// random in [0, 1)^2.
DirectionSample sample_environment(const EnvironmentSampler& sampler, Vec2 random);
float pdf_environment(const EnvironmentSampler& sampler, Vec3 direction);
// Radiance and pdf of one place with one lookup.
struct EnvironmentValue {
  Rgb radiance;
  float pdf = 0;  // per solid angle
};
EnvironmentValue eval_with_pdf(const EnvironmentSampler& sampler, Vec2 uv);

// Made by code, for scenes without an image; colours and sizes are chosen by eye.
// Clear sky with a soft sun (front left, 40 degrees high) and a dim ground.
Image make_sky_image(int width = 512, int height = 256);
// Dark surroundings with three soft boxes: front left, right, and behind.
Image make_studio_image(int width = 512, int height = 256);

}  // namespace parian

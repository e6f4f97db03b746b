#include "app/studio/property_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "judge/false_color.h"
#include "material/profile_field.h"
#include "material/properties.h"
#include "scene/camera.h"
#include "scene/mapping.h"
#include "transport/irradiance.h"
#include "transport/row_blend.h"

namespace parian {
namespace {

// Calls body(pixel, hit, ray) for each pixel that sees the mesh.
template <typename Body>
void for_hits(const Stage& stage, const Camera& camera, const Body& body) {
  const CameraFrame frame = make_camera_frame(camera);
  const auto width = static_cast<std::size_t>(camera.width);
  parallel_for(static_cast<std::size_t>(camera.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const CameraRay ray =
          make_camera_ray(frame, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
      const std::optional<Hit> hit =
          stage.tracer.intersect({.origin = ray.origin, .direction = ray.direction});
      if (hit) body(y * width + x, *hit, ray);
    }
  });
}

std::size_t pixel_of(const SampleGrid& grid, const SamplePoint& place) {
  const auto nearest = [](double v, int size) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(std::lround(v)), 0, size - 1));
  };
  return nearest(place.y, grid.height) * static_cast<std::size_t>(grid.width) +
         nearest(place.x, grid.width);
}

using Color3 = std::array<float, 3>;

// Albedos or ranges in mm of each pixel of a material.
struct PropertyGrid {
  SampleGrid grid;
  std::vector<Color3> values;
};

Color3 measure_dipole(const Material& material, bool is_albedo) {
  const ProfileField field = make_profile_field(material);
  ProfileRow row{.half_log = std::vector<float>(field.row()), .support_mm = {}};
  field.eval(0, 0, row.half_log.data(), row.support_mm.data());
  RowScratch scratch;
  const RowProperties found = measure_row(make_row_knots(field.knots_mm), row, scratch);
  Color3 values{};
  for (std::size_t c = 0; c < 3; ++c)
    values[c] = static_cast<float>(is_albedo ? 2 * std::numbers::pi * found.integral[c]
                                             : found.range_mm[c]);
  return values;
}

PropertyGrid measure_grid(const Material& material, bool is_albedo) {
  PropertyGrid found{grid_of(material), {}};
  const SampleGrid& grid = found.grid;
  if (!has_profiles(material)) {
    found.values = {measure_dipole(material, is_albedo)};
    return found;
  }
  found.values.resize(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height));
  const int channels = std::visit(
      [](const auto& m) {
        if constexpr (requires { m.channels.size(); })
          return static_cast<int>(m.channels.size());
        else
          return m.channels;
      },
      material);
  parallel_for(found.values.size(), [&](std::size_t i) {
    const int x = static_cast<int>(i) % grid.width, y = static_cast<int>(i) / grid.width;
    for (int c = 0; c < 3; ++c) {
      const ProfileProperties properties =
          measure_properties(get_profile(material, std::min(c, channels - 1), x, y));
      found.values[i][static_cast<std::size_t>(c)] =
          static_cast<float>(is_albedo ? properties.albedo : properties.range_mm);
    }
  });
  return found;
}

const Color3& value_at(const PropertyGrid& grid, const Mapping& mapping,
                       const SurfacePoint& point) {
  return grid.values[pixel_of(grid.grid, map_to_sample(mapping, grid.grid, point))];
}

float mean_of(const Color3& value) {
  return (value[0] + value[1] + value[2]) / 3;
}

// Albedos and ranges are mixed linearly by the layers' masks (scene/scene.h).
struct LayeredProperty {
  const Stage& stage;
  const StageLayers& layers;
  bool is_albedo;
  PropertyGrid base;
  std::vector<PropertyGrid> over;

  LayeredProperty(const Stage& on, const Material& material, const StageLayers& above, bool albedo)
      : stage(on), layers(above), is_albedo(albedo), base(measure_grid(material, albedo)) {
    for (const auto& layer : above) over.push_back(measure_grid(*layer->material, albedo));
  }

  Color3 at(const SurfacePoint& point) const {
    Color3 value = value_at(base, stage.scene.mapping, point);
    for (std::size_t l = 0; l < layers.size(); ++l) {
      const SurfaceLayer& layer = *layers[l];
      const double part = layer.opacity * (is_albedo ? layer.albedo : layer.range);
      const auto weight = static_cast<float>(part * eval_mask(layer.mask, stage.scene.mesh, point));
      const Color3& other = value_at(over[l], layer.mapping, point);
      for (std::size_t c = 0; c < 3; ++c) value[c] += weight * (other[c] - value[c]);
    }
    return value;
  }

  float largest() const {
    float most = 1e-6f;
    const auto look = [&](const PropertyGrid& grid) {
      for (const Color3& value : grid.values) most = std::max(most, mean_of(value));
    };
    look(base);
    for (const PropertyGrid& grid : over) look(grid);
    return most;
  }
};

// By half of weight(point).
template <typename Weight>
void redden(const Stage& stage, const Camera& camera, Image& image, const Weight& weight) {
  for_hits(stage, camera, [&](std::size_t pixel, const Hit& hit, const CameraRay&) {
    const SurfacePoint point = get_surface_point(stage.scene.mesh, hit.triangle, hit.barycentric);
    const float part = 0.5f * weight(point);
    const Color3 red{0.9f, 0.05f, 0.05f};
    for (std::size_t c = 0; c < 3; ++c) {
      float& value = image.values[3 * pixel + c];
      value += part * (red[c] - value);
    }
  });
}

Image make_picture(const Stage& stage, const Camera& camera) {
  Image image = make_image(camera.width, camera.height, 3);
  const Rgb ground = stage.scene.background;
  for (std::size_t i = 0; i < image.values.size(); i += 3) {
    image.values[i] = ground.x;
    image.values[i + 1] = ground.y;
    image.values[i + 2] = ground.z;
  }
  return image;
}

}  // namespace

SampleGrid grid_of(const Material& material) {
  if (const auto* map = std::get_if<ProfileMap>(&material))
    return {map->width, map->height, map->pixel_pitch_mm};
  if (const auto* blend = std::get_if<ProfileBlend>(&material))
    return {blend->width, blend->height, blend->pixel_pitch_mm};
  return {};
}

Image draw_property(const Stage& stage, const Material& material, const StageLayers& layers,
                    const Camera& camera, bool is_albedo) {
  const LayeredProperty property(stage, material, layers, is_albedo);
  const float full_scale = property.largest();
  Image image = make_picture(stage, camera);
  for_hits(stage, camera, [&](std::size_t pixel, const Hit& hit, const CameraRay& ray) {
    const SurfacePoint point = get_surface_point(stage.scene.mesh, hit.triangle, hit.barycentric);
    const Color3 value = property.at(point);
    const Color3 color =
        is_albedo ? value : map_color(static_cast<double>(mean_of(value) / full_scale));
    const float shade = 0.4f + 0.6f * std::abs(dot(point.normal, ray.direction));
    for (std::size_t c = 0; c < 3; ++c) image.values[3 * pixel + c] = color[c] * shade;
  });
  return image;
}

Image draw_irradiance(const Stage& stage, const Material& material,
                      const std::vector<Light>& lights, const Camera& camera) {
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  std::vector<SurfacePoint> all(pixels);
  std::vector<std::uint8_t> seen(pixels, 0);
  for_hits(stage, camera, [&](std::size_t pixel, const Hit& hit, const CameraRay&) {
    all[pixel] = get_surface_point(stage.scene.mesh, hit.triangle, hit.barycentric);
    seen[pixel] = 1;
  });
  std::vector<SurfacePoint> points;
  points.reserve(pixels);
  std::vector<std::size_t> places;
  places.reserve(pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    if (seen[i] != 0) {
      points.push_back(all[i]);
      places.push_back(i);
    }
  const std::vector<Rgb> irradiance = compute_irradiance(
      points, lights, stage.tracer, Boundary::included, eta_of(material), {.rays = 16});
  Image image = make_picture(stage, camera);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Rgb value = irradiance[k] * 0.31830989f;
    image.values[3 * places[k]] = value.x;
    image.values[3 * places[k] + 1] = value.y;
    image.values[3 * places[k] + 2] = value.z;
  }
  return image;
}

void draw_wireframe(const Stage& stage, const Camera& camera, Image& image) {
  const CameraFrame frame = make_camera_frame(camera);
  const auto pixel_angle = static_cast<float>(2 * frame.half_height / camera.height);
  for_hits(stage, camera, [&](std::size_t pixel, const Hit& hit, const CameraRay&) {
    const auto& corners = stage.scene.mesh.triangles[hit.triangle];
    const Vec3 a = stage.scene.mesh.positions[corners[0]],
               b = stage.scene.mesh.positions[corners[1]],
               c = stage.scene.mesh.positions[corners[2]];
    const float area = length(cross(b - a, c - a));
    const float u = hit.barycentric.x, v = hit.barycentric.y;
    // Distances to the edges: barycentric weight times the height on the edge.
    const float nearest = std::min(
        {(1 - u - v) * area / length(c - b), u * area / length(c - a), v * area / length(b - a)});
    if (nearest > 0.6f * pixel_angle * hit.t) return;
    for (std::size_t k = 0; k < 3; ++k)
      image.values[3 * pixel + k] = 0.5f * image.values[3 * pixel + k] + (k == 1 ? 0.25f : 0.1f);
  });
}

void draw_mask(const Stage& stage, const Material& material, const Mask& mask, const Camera& camera,
               Image& image) {
  const SampleGrid grid = grid_of(material);
  if (mask.width != grid.width || mask.height != grid.height) return;
  redden(stage, camera, image, [&](const SurfacePoint& point) {
    return mask.weight[pixel_of(grid, map_to_sample(stage.scene.mapping, grid, point))];
  });
}

void draw_mask(const Stage& stage, const SurfaceMask& mask, const Camera& camera, Image& image) {
  redden(stage, camera, image, [&](const SurfacePoint& point) {
    return static_cast<float>(eval_mask(mask, stage.scene.mesh, point));
  });
}

}  // namespace parian

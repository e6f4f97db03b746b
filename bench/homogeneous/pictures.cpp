// Fig. 3 to 7 of Xu et al. 2007 on our meshes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/homogeneous/study.h"
#include "render/transport_renderer.h"
#include "transport/precompute.h"

namespace parian {
namespace {

Dipole make_material(double sigma_s, std::array<double, 3> sigma_a, double g, bool single) {
  Dipole material;
  for (const double absorption : sigma_a)
    material.channels.push_back({absorption, (1 - g) * sigma_s, g});
  material.single_scattering = single;
  return material;
}

double relative_error(const Image& a, const Image& b) {
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    sum += std::abs(static_cast<double>(a.values[i] - b.values[i]));
    total += static_cast<double>(b.values[i]);
  }
  return sum / total;
}

Image show(const Scene& scene, const RayTracer& tracer, const Dipole& material, int intervals,
           KnotChoice knots, bool only_single) {
  PrecomputeParams params;
  params.multiple_intervals = params.single_intervals = intervals;
  params.knots = knots;
  params.single = only_single;
  params.samples = 100000;
  Precompute work(scene, tracer, params);
  work.advance();
  HomogeneousTransport transport = work.transport();
  if (only_single) transport.lights[0].multiple = {};
  return TransportRenderer(scene, transport).render(material).image;
}

// Light that leaves where it came in: the same albedo, all lengths a hundred times shorter.
Image show_as_brdf(Scene scene, const RayTracer& tracer, Dipole material, bool only_single) {
  for (DipoleCoefficients& medium : material.channels) {
    medium.sigma_a *= 100;
    medium.sigma_s_prime *= 100;
  }
  material.single_scattering = only_single;
  scene.material = Material(material);
  return show(scene, tracer, material, 64, KnotChoice::balanced, only_single);
}

// Fewer and fewer intervals, in the paper's count of coefficients, beside 64 intervals.
void show_series(const Page& page, const std::string& name, const Dipole& material,
                 const std::vector<int>& intervals, bool only_single) {
  Scene scene = make_dragon_scene(400, 300, material);
  scene.specular.enabled = false;
  const RayTracer tracer(scene.mesh);
  const auto picture = [&](int count, KnotChoice knots) {
    return show(scene, tracer, material, count, knots, only_single);
  };
  const Image many = picture(64, KnotChoice::balanced);
  MarkdownTable table;
  table.header = {"intervals", "functions", "balanced knots", "published knots"};
  std::vector<Image> pictures;
  for (const int count : intervals) {
    pictures.push_back(picture(count, KnotChoice::balanced));
    const auto error = [&](const Image& image) {
      return fmt::format("{:.2g} %", 100 * relative_error(image, many));
    };
    table.rows.push_back({fmt::format("{}", count), fmt::format("{}", count + 1),
                          error(pictures.back()), error(picture(count, KnotChoice::published))});
  }
  pictures.push_back(many);
  pictures.push_back(show_as_brdf(scene, tracer, material, only_single));
  write_picture(page, name, place_side_by_side(pictures, 0));
  write_table(page, name, "Mean error of the picture over its mean.", table);
}

void show_edits(const Page& page) {
  Scene scene = make_dragon_scene(400, 300, make_material(1, {0.01, 0.01, 0.01}, 0, true));
  const RayTracer tracer(scene.mesh);
  PrecomputeParams params;
  params.samples = 100000;
  Precompute work(scene, tracer, params);
  work.advance();
  const TransportRenderer renderer(scene, work.transport());
  const auto picture = [&](double sigma_s, double sigma_a, double g) {
    return renderer.render(make_material(sigma_s, {sigma_a, sigma_a, sigma_a}, g, true)).image;
  };
  write_picture(
      page, "scattering",
      place_side_by_side({picture(0.3, 0.01, 0), picture(1.5, 0.01, 0), picture(4, 0.01, 0)}, 0));
  write_picture(page, "absorption",
                place_side_by_side({picture(1.04, 0.002, 0), picture(1.04, 0.40, 0)}, 0));
  write_picture(page, "phase",
                place_side_by_side({picture(0.5, 0.05, -0.25), picture(0.5, 0.05, 0.25)}, 0));
}

}  // namespace

void study_pictures(const Page& page) {
  show_series(page, "figure-3", make_material(1.8, {0.03, 0.004, 0.03}, 0, false), {4, 8, 16},
              false);
  show_series(page, "figure-4", make_material(1.0, {0.01, 0.01, 0.01}, 0, true), {3, 4, 8}, true);
  show_edits(page);
}

}  // namespace parian

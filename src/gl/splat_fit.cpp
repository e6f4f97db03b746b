#include "gl/splat_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "transport/near_term.h"

namespace parian {
namespace {

// Least squares: [coefficient][place] for a basis in [place][function].
Eigen::MatrixXd solve_fit(const Eigen::MatrixXd& basis, const Eigen::VectorXd& weights) {
  const Eigen::MatrixXd weighted = weights.asDiagonal() * basis;
  return (weighted.transpose() * basis).ldlt().solve(weighted.transpose());
}

// [place][power], of degree 3.
Eigen::MatrixXd make_powers(const std::vector<double>& radii) {
  Eigen::MatrixXd powers(radii.size(), 4);
  for (std::size_t k = 0; k < radii.size(); ++k)
    for (int j = 0; j < 4; ++j) powers(static_cast<int>(k), j) = std::pow(radii[k], j);
  return powers;
}

// Of samples all nodes of their level, as they span more radii than groups.
std::vector<int> fit_nodes(int level) {
  if (level == 0) return {0, 1, 2, 3, 4, 5, 6};
  const std::array<int, 5> nodes = level_nodes(level);
  return {nodes.begin(), nodes.end()};
}
std::vector<double> find_radii(const RadialLevels& radial, const std::vector<int>& nodes) {
  std::vector<double> radii;
  radii.reserve(nodes.size());
  for (const int node : nodes)
    radii.push_back(static_cast<double>(radial.nodes[static_cast<std::size_t>(node)]));
  return radii;
}

// log2 A^2 at the nodes, as if the reference had no end.
std::vector<Vec3> eval_kernel(const ReferenceProfile& reference, const std::vector<double>& radii) {
  std::vector<Vec3> kernel;
  kernel.reserve(radii.size());
  for (const double r : radii)
    kernel.push_back(eval_reference(reference, r) * (2 * std::numbers::log2e_v<float>));
  return kernel;
}

// What counts are errors relative to the kernel. At the ends of a level little is sent; of the
// samples' the near term takes what is nearest.
Eigen::VectorXd weigh_nodes(const std::vector<Vec3>& kernel, int channel, int level) {
  Eigen::VectorXd weights(kernel.size());
  if (level == 0) {
    weights << 0.02, 0.3, 1, 1, 1, 1, 0.3;
  } else {
    weights << 0.5, 1, 1, 1, 0.5;
  }
  for (std::size_t k = 0; k < kernel.size(); ++k) {
    const float fall = component(kernel[k], channel) - component(kernel[0], channel);
    weights[static_cast<int>(k)] *=
        std::exp2(-0.25 * std::clamp(static_cast<double>(fall), -40.0, 40.0));
  }
  return weights;
}

// [3 node + channel]: a node's weight in each coefficient.
std::vector<Vec4> make_fit(const Eigen::MatrixXd& powers, const std::vector<Vec3>& kernel,
                           int level) {
  std::vector<Vec4> fit(3 * kernel.size(), Vec4{});
  for (int c = 0; c < 3; ++c) {
    const Eigen::MatrixXd solution = solve_fit(powers, weigh_nodes(kernel, c, level));
    for (int k = 0; k < solution.cols(); ++k)
      for (int j = 0; j < solution.rows(); ++j)
        fit[static_cast<std::size_t>(3 * k + c)][static_cast<std::size_t>(j)] =
            static_cast<float>(solution(j, k));
  }
  return fit;
}

// Midpoints over the near term.
constexpr int rings = 256;
double ring_radius(int ring, double near_mm) {
  return near_mm * (ring + 0.5) / rings;
}
// int k(r) w dA over a plane, w the near term's weight.
template <class Kernel>
double integrate_near(const Kernel& kernel, double near_mm) {
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double r = ring_radius(i, near_mm);
    sum += 2 * std::numbers::pi * r * near_weight(r, near_mm) * kernel(r);
  }
  return sum * near_mm / rings;
}

}  // namespace

Vec4 make_near_kernel(const ReferenceProfile& reference, double near_mm) {
  std::array<double, 3> integral{};
  for (std::size_t c = 0; c < 3; ++c)
    integral[c] =
        integrate_near([&](double r) { return eval_reference_kernel(reference, r)[c]; }, near_mm);
  std::vector<double> radii(rings);
  Eigen::VectorXd roots(rings), weights(rings);  // by what a relative error of the root changes
  for (int i = 0; i < rings; ++i) {
    const double r = ring_radius(i, near_mm);
    radii[static_cast<std::size_t>(i)] = r;
    const std::array<double, 3> kernel = eval_reference_kernel(reference, r);
    double mean = 0;
    for (std::size_t c = 0; c < 3; ++c)
      if (integral[c] > 0) mean += kernel[c] / (3 * integral[c]);
    roots[i] = std::pow(mean, 0.125);
    weights[i] = r * near_weight(r, near_mm) * std::pow(std::max(mean, 1e-30), 0.75);
  }
  const Eigen::VectorXd fit = solve_fit(make_powers(radii), weights) * roots;
  const double total = integrate_near(
      [&](double r) { return std::pow(fit[0] + r * (fit[1] + r * (fit[2] + r * fit[3])), 8); },
      near_mm);
  Vec4 near_kernel{};
  if (total > 0)
    for (std::size_t j = 0; j < 4; ++j)
      near_kernel[j] = static_cast<float>(fit[static_cast<int>(j)] * std::pow(total, -0.125));
  return near_kernel;
}

FitPrograms make_fit_programs() {
  const auto make = [](const std::vector<std::string>& defines) {
    return make_program({"screen_vertex.glsl"}, {"fit_fragment.glsl"}, defines);
  };
  return {make({"SINGLE", "NODES 7"}), make({"NODES 5"})};
}

void fit_sources(Sources& sources, const FitPrograms& programs, const RadialLevels& radial,
                 const ReferenceProfile& reference) {
  set_additive_blending(false);
  for (int l = 0; l < radial.count; ++l) {
    const SourceLevel& level = sources.levels[static_cast<std::size_t>(l)];
    const Program& program = l == 0 ? programs.single : programs.group;
    std::vector<Attachment> fits;
    fits.reserve(level.fit.size());
    for (const Texture& fit : level.fit) fits.push_back({&fit});
    const Framebuffer target = make_framebuffer(fits, "fits of samples");
    const std::vector<int> nodes = fit_nodes(l);
    const std::vector<double> radii = find_radii(radial, nodes);
    const std::vector<Vec3> of_kernel = eval_kernel(reference, radii);
    std::vector<Vec3> of_reference;
    of_reference.reserve(nodes.size());
    for (const int node : nodes)
      of_reference.push_back(
          eval_reference_node(reference, radial.nodes, static_cast<std::size_t>(node)) *
          std::numbers::log2e_v<float>);
    bind(target);
    use(program);
    bind_texture(program, "source_rows", 0, level.rows);
    if (l == 0) {
      bind_texture(program, "source_flux", 1, sources.flux);
      bind_texture(program, "source_near", 2, sources.near);
    }
    set_uniform(program, "source_lines", level.lines);
    set_uniform(program, "fit_nodes", nodes);
    set_uniform(program, "reference_nodes", of_reference);
    set_uniform(program, "kernel_nodes", of_kernel);
    set_uniform(program, "fit", make_fit(make_powers(radii), of_kernel, l));
    draw_screen();
  }
  check_gl("fits of samples");
}

}  // namespace parian

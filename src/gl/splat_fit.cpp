#include "gl/splat_fit.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

namespace parian {
namespace {

// [node]: its weight in each coefficient of the polynomial in r that fits five values best. At the
// ends of a level little is sent; of the samples' the near term takes what is nearest.
std::vector<Vec4> make_fit(const RadialLevels& radial, int level) {
  const bool is_single = level == 0;
  const int terms = is_single ? 3 : 4;
  const Eigen::Vector<double, 5> weights = is_single
                                               ? Eigen::Vector<double, 5>{0.02, 0.3, 1, 1, 0.3}
                                               : Eigen::Vector<double, 5>{0.5, 1, 1, 1, 0.5};
  Eigen::MatrixXd powers(5, terms);
  const std::array<int, 5> nodes = level_nodes(level);
  for (int k = 0; k < 5; ++k) {
    const auto node = static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)]);
    for (int j = 0; j < terms; ++j)
      powers(k, j) = std::pow(static_cast<double>(radial.nodes[node]), j);
  }
  const Eigen::MatrixXd weighted = weights.asDiagonal() * powers;
  const Eigen::MatrixXd fit = (weighted.transpose() * powers).ldlt().solve(weighted.transpose());
  std::vector<Vec4> columns(5, Vec4{});
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < terms; ++j)
      columns[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)] =
          static_cast<float>(fit(j, k));
  return columns;
}

}  // namespace

FitPrograms make_fit_programs() {
  const auto make = [](const std::vector<std::string>& defines) {
    return make_program({"screen_vertex.glsl"}, {"fit_fragment.glsl"}, defines);
  };
  return {make({"SINGLE"}), make({})};
}

void fit_sources(Sources& sources, const FitPrograms& programs, const RadialLevels& radial,
                 const ReferenceProfile& reference) {
  set_additive_blending(false);
  for (int l = 0; l < radial.count; ++l) {
    const SourceLevel& level = sources.levels[static_cast<std::size_t>(l)];
    const Program& program = l == 0 ? programs.single : programs.group;
    const Framebuffer target =
        make_framebuffer({{&level.fit[0]}, {&level.fit[1]}, {&level.fit[2]}}, "fits of samples");
    const std::array<int, 5> nodes = level_nodes(l);
    std::vector<Vec3> of_reference, of_kernel;
    for (const int node : nodes) {
      const auto k = static_cast<std::size_t>(node);
      const auto log2e = std::numbers::log2e_v<float>;
      of_reference.push_back(eval_reference_node(reference, radial.nodes, k) * log2e);
      of_kernel.push_back(eval_reference(reference, static_cast<double>(radial.nodes[k])) *
                          (2 * log2e));
    }
    bind(target);
    use(program);
    bind_texture(program, "source_rows", 0, level.rows);
    if (l == 0) {
      bind_texture(program, "source_flux", 1, sources.flux);
      bind_texture(program, "source_near", 2, sources.near);
    }
    set_uniform(program, "source_lines", level.lines);
    set_uniform(program, "level_nodes", std::vector<int>(nodes.begin(), nodes.end()));
    set_uniform(program, "reference_nodes", of_reference);
    set_uniform(program, "kernel_nodes", of_kernel);
    set_uniform(program, "fit", make_fit(radial, l));
    draw_screen();
  }
  check_gl("fits of samples");
}

}  // namespace parian

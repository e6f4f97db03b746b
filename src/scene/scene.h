// What is in a picture: plain structs, made by read_scene or by code.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "base/params.h"
#include "image/image.h"
#include "material/bssrdf_table.h"
#include "material/material.h"
#include "mesh/mesh.h"
#include "scene/surface_mask.h"

namespace parian {

// Pinhole. Row 0 of the picture is its top.
struct Camera {
  Vec3 position{0, 0, 100};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 1, 0};
  double fov_deg = 30;  // vertical
  int width = 960;
  int height = 720;
  friend bool operator==(const Camera&, const Camera&) = default;
};
inline constexpr int max_picture_side = 16384;

// Lights that are not `enabled` belong to a description and light nothing: read_scene leaves them
// out unless asked for them, and renderers take all that a scene has.
struct DirectionalLight {
  Vec3 direction{0, 1, 0};  // unit, towards the light
  Rgb irradiance{1, 1, 1};  // W/m^2 on a plane that faces it
  bool enabled = true;
};
struct PointLight {
  Vec3 position;           // mm
  Rgb intensity{1, 1, 1};  // W/sr with lengths in mm: irradiance = intensity / distance^2
  bool enabled = true;
};
// Radiance from all around: a latitude-longitude image, row 0 = +y, the middle column = -z, columns
// grow towards +x as seen from inside; turned by rotation_deg about +y.
struct EnvironmentLight {
  Image image;  // 3 channels, linear
  double rotation_deg = 0;
  Rgb scale{1, 1, 1};
  bool enabled = true;
  std::string file, sky;  // where the image is from, as descriptions say it: one of them
};
using Light = std::variant<DirectionalLight, PointLight, EnvironmentLight>;

// How points of the surface find their place in the sample.
enum class MappingKind {
  uv,   // texture coordinates
  box,  // position projected along the axis that the normal is nearest to
};
struct Mapping {
  MappingKind kind = MappingKind::box;
  // Millimetres of the enlarged sample that a unit of u (and v) covers: uv mapping only. 0: the
  // sample's width.
  double uv_size_mm = 0;
  // The sample is enlarged by this factor before it is laid on; profiles stay as they are in mm.
  double scale = 1;
  double rotation_deg = 0;  // of the sample in its plane, from its x to its y axis
  Vec2 offset_mm;           // of the sample's origin, the corner of its pixel (0, 0)
};

// Rough-dielectric reflection (GGX, Walter et al. 2007) on top of what is scattered.
struct Specular {
  bool enabled = true;
  double roughness = 0.3;  // perceptual: alpha = roughness^2
  double eta = 0;          // 0: the material's
};

// A fitted or homogeneous material, or a measured table without a fit.
using SurfaceMaterial = std::variant<Material, BssrdfTable>;
Boundary boundary_of(const SurfaceMaterial& material);
double eta_of(const SurfaceMaterial& material);

// Another material over what lies below, where its mask says. Profiles are mixed by property: at
// mask m the layer takes over m opacity albedo of the albedo, and so on (SubEdit, section 7.1).
// Each point of the surface has one profile, so R_d stays symmetric.
struct SurfaceLayer {
  std::shared_ptr<const Material> material;
  std::string material_name;
  std::string material_file;  // empty: its coefficients are in the description
  Mapping mapping;
  SurfaceMask mask;
  double opacity = 1;
  double albedo = 1;
  double range = 1;
  double shape = 1;
  bool enabled = true;  // as for lights
};
inline constexpr std::size_t max_layers = 16;

// The plain numbers of each; ranges and JSON keys come from here.
ParamList describe(Camera& camera);
ParamList describe(Mapping& mapping);
ParamList describe(Specular& specular);
ParamList describe(SurfaceLayer& layer);

// Where a mesh is from and how it was placed, as descriptions say it.
struct MeshSource {
  std::string file, shape;  // one of them
  double size_mm = 0;
  Vec3 rotation_deg;
};

struct Scene {
  TriangleMesh mesh;      // clean (clean_mesh), in mm, at its place
  std::string mesh_name;  // how errors name it
  MeshSource mesh_source;
  SurfaceMaterial material;
  std::string material_name;
  std::string material_file;  // empty: its coefficients are in the description
  Mapping mapping;
  std::vector<SurfaceLayer> layers;  // over the material, bottom up
  Specular specular;
  Camera camera;
  std::vector<Light> lights;
  double exposure = 0;            // stops
  std::string output;             // picture to write, as the description has it; may be empty
  bool show_environment = false;  // behind the object; otherwise `background`
  Rgb background{0, 0, 0};
  std::vector<std::string> warnings;  // of reading: one line each
};

// Throws Error with `file` as its file when layers cannot lie on this scene: over a raw table, with
// another boundary or eta than the material's, or with masks and mappings that the mesh cannot
// carry.
void check_layers(const Scene& scene, const std::string& file);
// The same of one layer over a material of this name.
void check_layer(const SurfaceLayer& layer, const Material& below, const std::string& below_name,
                 const TriangleMesh& mesh, const std::string& file, const std::string& place);

// Calls with each path of a file that the scene's description names.
void for_each_file(Scene& scene, const std::function<void(std::string& path)>& visit);

}  // namespace parian

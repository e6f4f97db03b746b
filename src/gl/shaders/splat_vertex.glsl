// A splat: a square around the picture of the sphere that a source reaches at this level, drawn as a
// point where the device has points as large (POINTS), otherwise as a strip. Its depth is the
// sphere's nearest, so that the depth test drops surfaces in front of it.
uniform sampler2D source_positions;
uniform sampler2D source_fit_0;      // fit_fragment.glsl
uniform sampler2D source_fit_1;
uniform sampler2D source_fit_2;
#ifdef SINGLE
uniform sampler2D source_fit_3;
uniform sampler2D source_normals;
uniform float near_mm;
#endif
#ifdef MEAN
uniform sampler2D source_flux;
flat out vec3 splat_flux;
#endif
uniform float reach;  // mm
flat out vec3 splat_position;
flat out vec4 splat_fit_0;
flat out vec4 splat_fit_1;
flat out vec4 splat_fit_2;
#ifdef SINGLE
flat out vec3 splat_near;
flat out vec3 splat_facing;
#endif

uniform sampler2D tiles;  // tiles_fragment.glsl
uniform vec2 level_size;  // texels

// Something in the box lies behind the depth. Boxes over many tiles are not looked into.
bool is_seen(vec4 box, float depth) {
  ivec2 first = ivec2((0.5 + 0.5 * box.xy) * level_size) / TILE;
  ivec2 last = min(ivec2((0.5 + 0.5 * box.zw) * level_size) / TILE, textureSize(tiles, 0) - 1);
  if (last.x - first.x > 5 || last.y - first.y > 5) return true;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x)
      if (texelFetch(tiles, ivec2(x, y), 0).r >= depth) return true;
  return false;
}

// Extent of a sphere's picture along one axis, as tangents; c = centre's coordinate, z its depth.
vec2 sphere_extent(float c, float z, float radius) {
  float root = sqrt(max(0.0, c * c + z * z - radius * radius));
  float below = z * z - radius * radius;
  return vec2(c * z - radius * root, c * z + radius * root) / below;
}

void main() {
  int width = textureSize(source_positions, 0).x;
#ifdef POINTS
  ivec2 texel = source_texel(gl_VertexID, width);
  gl_PointSize = 1.0;
#else
  ivec2 texel = source_texel(gl_InstanceID, width);
#endif
  splat_position = texelFetch(source_positions, texel, 0).xyz;
  splat_fit_0 = texelFetch(source_fit_0, texel, 0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  bool is_dark = splat_fit_0.rgb == vec3(0.0);
  float radius = reach;
#ifdef SINGLE
  // A sample in the dark still counts in the near term's means.
  if (is_dark) radius = min(reach, near_mm);
#else
  if (is_dark) return;
#endif
  vec3 v = to_view(splat_position);
  vec4 box = vec4(-1.0, -1.0, 1.0, 1.0);
  if (v.z > radius * 1.001) {
    vec2 x = sphere_extent(v.x, v.z, radius) / camera_half.x;
    vec2 y = sphere_extent(v.y, v.z, radius) / camera_half.y;
    box = clamp(vec4(x.x, y.x, x.y, y.y), -1.0, 1.0);
  }
  float depth = v.z - radius > camera_range.x ? device_depth(v.z - radius) : -1.0;
  depth = clamp(depth, -0.99999, 1.0);
  if (v.z < -radius || !is_seen(box, 0.5 + 0.5 * depth)) return;

  splat_fit_1 = texelFetch(source_fit_1, texel, 0);
  splat_fit_2 = texelFetch(source_fit_2, texel, 0);
#ifdef SINGLE
  splat_near = texelFetch(source_fit_3, texel, 0).rgb;
  splat_facing =
      vec3(2.0, 2.0, 1.0) * to_camera_axes(texelFetch(source_normals, texel, 0).xyz);
#endif
#ifdef MEAN
  splat_flux = texelFetch(source_flux, texel, 0).rgb;
#endif
#ifdef POINTS
  // Devices drop points whose centre lies outside, so it is that of the part inside.
  vec2 size = 0.5 * (box.zw - box.xy) * level_size;
  gl_PointSize = max(size.x, size.y) + 1.0;
  gl_Position = vec4(0.5 * (box.xy + box.zw), depth, 1.0);
#else
  gl_Position = vec4((gl_VertexID & 1) == 0 ? box.x : box.z, (gl_VertexID & 2) == 0 ? box.y : box.w,
                     depth, 1.0);
#endif
}

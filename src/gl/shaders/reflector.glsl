// A surface point as the viewer sees it, and reflection at a rough dielectric (GGX, Walter et al.
// 2007, height-correlated Smith masking, Heitz 2014): render/specular_internal.h.
uniform sampler2D positions;
uniform sampler2D normals;
uniform sampler2D places;  // zw: the triangle's normal on the viewer's side, octahedral
uniform vec3 viewer;
uniform float alpha;
uniform float eta;

const float pi = 3.14159265;

struct Reflector {
  vec3 position;
  vec3 normal;            // dot(normal, view) > 0
  vec3 geometric_normal;  // likewise
  vec3 view;
};

Reflector get_reflector(ivec2 pixel) {
  Reflector seen;
  seen.position = texelFetch(positions, pixel, 0).xyz;
  seen.view = normalize(viewer - seen.position);
  seen.geometric_normal = decode_octahedral(texelFetch(places, pixel, 0).zw);
  vec4 normal = texelFetch(normals, pixel, 0);
  seen.normal = dot(normal.xyz, seen.geometric_normal) < 0.0 ? -normal.xyz : normal.xyz;
  float cosine = dot(seen.normal, seen.view);
  if (cosine < normal.w - 1e-5) {  // bent towards the viewer until it is seen at that cosine
    vec3 across = normalize(seen.normal - seen.view * cosine);
    seen.normal = normalize(seen.view * normal.w + across * sqrt(1.0 - normal.w * normal.w));
  }
  return seen;
}

float masking_root(float cosine) {
  float a2 = alpha * alpha;
  return sqrt(a2 + (1.0 - a2) * cosine * cosine);
}

float eval_distribution(vec3 normal, vec3 h) {
  float a2 = alpha * alpha;
  vec3 across = cross(normal, h);
  float cosine = dot(normal, h), t = dot(across, across) + a2 * cosine * cosine;
  return a2 / (pi * t * t);
}

// F D G / (4 n.v n.l) times n.l.
float eval_ggx(Reflector seen, vec3 light) {
  float nl = dot(seen.normal, light), nv = dot(seen.normal, seen.view);
  if (nl <= 0.0 || nv <= 0.0) return 0.0;
  vec3 h = normalize(seen.view + light);
  float fresnel = 1.0 - fresnel_transmission(eta, dot(seen.view, h));
  return fresnel * eval_distribution(seen.normal, h) * 0.5 /
         (nl * masking_root(nv) + nv * masking_root(nl)) * nl;
}

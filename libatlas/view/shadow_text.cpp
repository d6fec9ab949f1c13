// The shader texts that look a point up in shadow maps.
#include "libatlas/view/shadow_text.h"

namespace atlas {
namespace {

// All maps are layers of one texture.
//
// A point's place in a map (uv, depth) is biased for that map: a key's texels lie as its own light
// stands, which is not where the current light is. The offset moves a plane out of its own texels
// up to the filter's corners: along each of the map's axes, by the filter's reach times how far the
// normal leans that way, and by as much as the point itself may be off. The depth bias grows with
// the tangent of the angle to the map's light, by which a plane's depth changes across a texel. It
// is never 0, since even a plane that faces the light is only as deep as the map says up to
// rounding. All act here and not on the casters, so that maps hold true depths, which the march
// needs.
constexpr const char* kMaps = R"(
layout(binding = 1) uniform sampler2DArrayShadow maps;
vec3 place(mat4 to_map, vec3 x, vec3 y, vec3 p, vec3 n, float off) {
  float lean = abs(dot(n, x)) + abs(dot(n, y));
  float facing = dot(n, cross(x, y));
  float tangent = sqrt(max(1.0 - facing * facing, 0.0)) / max(facing, 1e-3);
  vec3 m = (to_map * vec4(p + n * (frame.weights.z * lean + off), 1.0)).xyz;
  m.z -= frame.eye.w + frame.corner.w * min(tangent, 8.0);
  return m;
}
vec3 place0(vec3 p, vec3 n, float off) {
  return place(frame.to_map0, frame.map_x0.xyz, frame.map_y0.xyz, p, n, off);
}
)";

constexpr const char* kSecondMap = R"(
vec3 place1(vec3 p, vec3 n, float off) {
  return place(frame.to_map1, frame.map_x1.xyz, frame.map_y1.xyz, p, n, off);
}
)";

constexpr const char* kNearest = R"(
float visibility_at(float layer, vec2 uv, float depth) {
  return texture(maps, vec4((floor(uv * frame.specular.w) + 0.5) * frame.weights.w, layer, depth));
}
)";

constexpr const char* kBilinear = R"(
float visibility_at(float layer, vec2 uv, float depth) {
  return texture(maps, vec4(uv, layer, depth));
}
)";

// The mean of 3x3 bilinear taps is a weighted sum over 4x4 texels, and four gathers read those.
constexpr const char* kPcf3 = R"(
float visibility_at(float layer, vec2 uv, float depth) {
  vec2 texel = uv * frame.specular.w - 0.5;
  vec2 f = fract(texel);
  float s = frame.weights.w;
  vec2 corner = floor(texel) * s;
  vec4 a = textureGather(maps, vec3(corner, layer), depth);
  vec4 b = textureGather(maps, vec3(corner + vec2(2.0 * s, 0.0), layer), depth);
  vec4 c = textureGather(maps, vec3(corner + vec2(0.0, 2.0 * s), layer), depth);
  vec4 d = textureGather(maps, vec3(corner + vec2(2.0 * s), layer), depth);
  vec2 g = 1.0 - f;
  // Gathers come as (0,1) (1,1) (1,0) (0,0).
  float row0 = g.x * a.w + a.z + b.w + f.x * b.z;
  float row1 = g.x * a.x + a.y + b.x + f.x * b.y;
  float row2 = g.x * c.w + c.z + d.w + f.x * d.z;
  float row3 = g.x * c.x + c.y + d.x + f.x * d.y;
  return (g.y * row0 + row1 + row2 + f.y * row3) * (1.0 / 9.0);
}
)";

constexpr const char* kPcf5 = R"(
float visibility_at(float layer, vec2 uv, float depth) {
  float sum = 0.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x)
      sum += texture(maps, vec4(uv + vec2(x, y) * frame.weights.w, layer, depth));
  return sum * 0.04;
}
)";

constexpr const char* kOneMap = R"(
float visibility(vec3 p, vec3 n, float off) {
  vec3 m = place0(p, n, off);
  return visibility_at(frame.ray0.w, m.xy, m.z);
}
)";

constexpr const char* kTwoMaps = R"(
float visibility(vec3 p, vec3 n, float off) {
  vec3 m0 = place0(p, n, off);
  vec3 m1 = place1(p, n, off);
  float v = frame.weights.x * visibility_at(frame.ray0.w, m0.xy, m0.z) +
            frame.weights.y * visibility_at(frame.ray1.w, m1.xy, m1.z);
  return min(v, 1.0);
}
)";

// See docs/player.md, "March". A height is a depth difference towards a key's light. At height h,
// the ray to the current light is over m.xy + h * ray.xy. A sample of height d that is found there
// lies beside the ray by |d - h| times the trace's texels per height, which is called its miss. A
// blocker that one key does not see (a seat's shaded part next to a window's patch) is seen by the
// other key, so both are searched, and the filter is evaluated once, at the sample with the
// smallest miss. There are two constants, in texels. A miss of at most 1 is certain and ends the
// search. If no miss is at most 2.5, the point is lit: with 2, smooth shadows lose a little of
// their rims; with 4, a cabin's seats under a low sun have three times as many wrong pixels; with
// 8, even more. If the first key sees nothing at all above the point along the ray, the point is
// lit as that key says and its search ends, too. A key that stands behind the surface shows the
// surface's other side, nearly as if that were a blocker: it is asked last, and only what it shows
// within a texel counts. If nothing is near, the last part of the ray that is under the height
// field (from `low` on) and then over it again (at `high`) is bisected, which finds steep blockers
// between two samples. What it finds must lie within a texel: within 2.5, it is the rim of an
// opening as often as a blocker. The loops' bounds are not constants, which keeps compilers from
// unrolling them: the software renderer leaves a loop early but never skips a branch.
constexpr const char* kMarch = R"(
layout(binding = 2) uniform sampler2DArray depths;
float height(vec3 m, vec2 uv, float layer) {
  return m.z - texture(depths, vec3(uv, layer)).x;
}
// Which share of its blocker's height the filter compares with: low, so that a lower blocker beside
// it counts too, but above what the receiver itself rises to on the way there. A light that stands
// at the key asks for no height: then the key's own answer is exact.
float share_of_height(float texels) {
  return texels > 0.0 ? clamp(1.5 * texels * frame.march.z, 0.1, 0.5) : 0.0;
}
// Normals are stored in 16 bits, so those of a floor along the light may point to either side.
bool faces(vec3 x, vec3 y, vec3 n) {
  return dot(n, cross(x, y)) > -1e-4;
}
float visibility(vec3 p, vec3 n, float off) {
  bool faced0 = faces(frame.map_x0.xyz, frame.map_y0.xyz, n);
  bool faced1 = faces(frame.map_x1.xyz, frame.map_y1.xyz, n);
  bool swapped = faced1 && !faced0;
  vec3 m = swapped ? place1(p, n, off) : place0(p, n, off);
  vec3 other = swapped ? place0(p, n, off) : place1(p, n, off);
  vec4 ray = swapped ? frame.ray1 : frame.ray0;
  vec2 back = swapped ? frame.behind.zw : frame.behind.xy;
  float texels = swapped ? frame.march.y : frame.march.x;
  vec3 leave = (frame.corner.xyz - p) * frame.inverse.xyz;
  float top = min(min(leave.x, leave.y), leave.z);
  float least = frame.march.z;
  int steps = int(1.0 / frame.ray_y.w + 0.5);
  bool both = faced0 && faced1;
  float over_other = both ? height(other, other.xy, frame.ray1.w) : 0.0;
  vec3 at = m;
  float layer = ray.w, nearest = 1e30;
  bool open = false;
  for (int key = 0; key < int(frame.march.w); ++key) {
    float here = height(m, m.xy, ray.w);
    float best = max(here, height(m, m.xy - back, ray.w));
    if (best <= least) best = 0.0;
    float gap = here > least ? here : 1e20;
    float d = height(m, m.xy + over_other * ray.xy, ray.w);
    float g = abs(d - over_other);
    float under = max(max(over_other, here), d - over_other);
    if (d > least && g < gap) { best = d; gap = g; }
    float rung = top * ray.z * frame.ray_y.w;
    float low = 0.0, high = here > 0.0 ? 1e30 : 0.0;
    for (int i = 1; i < steps; ++i) {
      float h = rung * float(i);
      d = height(m, m.xy + h * ray.xy, ray.w);
      g = abs(d - h);
      under = max(under, d - h);
      if (d > h) { low = h; high = 1e30; } else high = min(high, h);
      if (d > least && g < gap) { best = d; gap = g; }
    }
    d = height(m, m.xy + best * ray.xy, ray.w);
    g = abs(d - best);
    if (d > least && g < gap) { best = d; gap = g; }
    high = min(high, top * ray.z);
    for (int i = 0; i < 4 && gap * texels > 2.5 && high > low; ++i) {
      float h = 0.5 * (low + high);
      d = height(m, m.xy + h * ray.xy, ray.w);
      g = abs(d - h);
      if (d > h) low = h; else high = h;
      if (d > least && g * texels < 1.0) { best = d; gap = g; }
    }
    float miss = gap * texels;
    if (miss < (key == 0 || both ? nearest : min(nearest, 1.0))) {
      nearest = miss;
      layer = ray.w;
      at = vec3(m.xy + best * ray.xy, m.z - share_of_height(texels) * best);
    }
    open = under <= least;
    if (miss <= 1.0 || open) break;
    m = other;
    ray = frame.ray1;
    back = frame.behind.zw;
    texels = frame.march.y;
    over_other = here;
  }
  return nearest <= 2.5 || open ? visibility_at(layer, at.xy, at.z) : 1.0;
}
)";

const char* filter_text(int pcf) {
  return pcf <= 0 ? kNearest : pcf < 3 ? kBilinear : pcf < 5 ? kPcf3 : kPcf5;
}

const char* sampling_text(ShadowSampling shadow) {
  switch (shadow) {
    case ShadowSampling::none:
      return "";
    case ShadowSampling::one:
      return kOneMap;
    case ShadowSampling::two:
      return kTwoMaps;
    case ShadowSampling::march:
      return kMarch;
  }
  return "";
}

}  // namespace

std::string shadow_text(const ShaderFeatures& f) {
  std::string s = kMaps;
  if (f.shadow != ShadowSampling::one) s += kSecondMap;
  s += filter_text(f.pcf);
  return s + sampling_text(f.shadow);
}

}  // namespace atlas

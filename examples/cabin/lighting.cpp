#include "examples/cabin/lighting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numbers>
#include <tuple>
#include <utility>

#include "libatlas/core/parallel.h"

namespace cabin {
namespace {

constexpr float kPiFloat = std::numbers::pi_v<float>;
// The distance from the surface at which rays start, in metres. It is much less than the 8 mm of
// air behind the door's frame.
constexpr float kLift = 2e-4f;

std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

// Returns two numbers in [0, 1) that depend only on the position.
glm::vec2 rotation_at(glm::vec3 p, std::uint32_t seed) {
  std::uint32_t bits[3];
  std::memcpy(bits, &p, sizeof bits);
  const std::uint32_t a = hash(bits[0] ^ hash(bits[1] ^ hash(bits[2] ^ hash(seed))));
  return {float(a >> 8) / 16777216.0f, float(hash(a + 0x9E3779B9u) >> 8) / 16777216.0f};
}

// Returns the i-th point of the R2 sequence (Roberts 2018, after Weyl), shifted, in [0, 1)².
glm::vec2 low_discrepancy(int i, glm::vec2 shift) {
  const double x = shift.x + 0.75487766624669276 * (i + 1),
               y = shift.y + 0.56984029099805327 * (i + 1);
  return {std::min(0.99999994f, float(x - std::floor(x))),
          std::min(0.99999994f, float(y - std::floor(y)))};
}

std::tuple<glm::vec3, glm::vec3> frame_of(glm::vec3 n) {
  // Duff et al. 2017.
  const float sign = std::copysign(1.0f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

// Returns where rays from a vertex start: on the surface of the coarse mesh, or on the smooth one
// where that bulges outwards.
glm::vec3 ray_origin(const Vertex& v) {
  const float bulge = glm::dot(v.position - v.ray_start, v.normal);
  return v.ray_start + v.normal * (std::max(0.0f, bulge) + kLift);
}

// Returns a point of a convex polygon, uniformly distributed by area: chooses a triangle of the
// fan, then a point in it.
glm::vec3 point_of(const AreaLight& light, glm::vec2 r) {
  const std::size_t fan = light.corners.size() - 2;
  std::array<float, 32> area{};
  float total = 0;
  for (std::size_t i = 0; i < fan; ++i)
    total += area[i] = glm::length(glm::cross(light.corners[i + 1] - light.corners[0],
                                              light.corners[i + 2] - light.corners[0]));
  float x = r.x * total;
  std::size_t i = 0;
  while (i + 1 < fan && x >= area[i]) x -= area[i++];
  const float s = std::sqrt(std::clamp(x / area[i], 0.0f, 1.0f));
  return light.corners[0] * (1 - s) + light.corners[i + 1] * (s * (1 - r.y)) +
         light.corners[i + 2] * (s * r.y);
}

float luminance(glm::vec3 c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

// One ray of the radiosity pass and what it hit, in packed form.
struct Link {
  Id triangle;  // ~0: nothing that sends light
  std::uint16_t u, v;
};

}  // namespace

float polygon_form_factor(std::span<const glm::vec3> corners, glm::vec3 point, glm::vec3 normal) {
  std::array<glm::vec3, 40> clipped;
  std::size_t n = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec3 a = corners[i] - point, b = corners[(i + 1) % corners.size()] - point;
    const float da = glm::dot(a, normal), db = glm::dot(b, normal);
    if (da >= 0) clipped[n++] = a;
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) clipped[n++] = a + (b - a) * (da / (da - db));
  }
  if (n < 3) return 0;
  float sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec3 a = clipped[i], b = clipped[(i + 1) % n], c = glm::cross(a, b);
    const float length = glm::length(c);
    if (length > 0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(c, normal) / length;
  }
  return std::max(0.0f, sum / (2 * kPiFloat));
}

Lighting::Lighting(const Tracer& tracer, Lights lights, const LightingOptions& options)
    : tracer_(tracer), options_(options), lights_(std::move(lights.areas)), sun_(lights.sun) {}

glm::vec3 Lighting::direct_at(const Vertex& vertex) const {
  const glm::vec3 n = vertex.normal, origin = ray_origin(vertex);
  const glm::vec2 shift = rotation_at(vertex.ray_start, options_.seed);
  glm::vec3 sum(0);
  const float sun_cosine = glm::dot(n, sun_.towards);
  if (sun_cosine > 0 && sun_.illuminance != glm::vec3(0)) {
    const auto [t, b] = frame_of(sun_.towards);
    const int samples = std::max(4, options_.direct_samples / 6);
    int open = 0;
    for (int i = 0; i < samples; ++i) {
      const glm::vec2 r = low_discrepancy(i, shift);
      const float radius = sun_.radius * std::sqrt(r.x), angle = 2 * kPiFloat * r.y;
      const glm::vec3 d = sun_.towards + radius * (std::cos(angle) * t + std::sin(angle) * b);
      open += !tracer_.blocked(origin, glm::normalize(d), 100);
    }
    sum += sun_.illuminance * (sun_cosine * float(open) / float(samples));
  }
  std::array<float, 128> share{};
  float total = 0;
  for (std::size_t l = 0; l < lights_.size(); ++l) {
    const AreaLight& light = lights_[l];
    if (glm::dot(light.normal, origin - light.corners[0]) <= 0) continue;
    const float f = polygon_form_factor(light.corners, origin, n);
    share[l] = f;
    total += f * luminance(light.exitance);
  }
  for (std::size_t l = 0; l < lights_.size(); ++l) {
    const float part = share[l] * luminance(lights_[l].exitance);
    if (part <= 1e-4f * total) continue;
    const int samples = std::max(1, int(std::lround(options_.direct_samples * part / total)));
    float all = 0, seen = 0;
    for (int i = 0; i < samples; ++i) {
      const glm::vec3 to = point_of(lights_[l], low_discrepancy(i, shift)) - origin;
      const float d2 = glm::dot(to, to), d = std::sqrt(d2);
      const float weight = std::max(0.0f, glm::dot(to, n)) *
                           std::max(0.0f, -glm::dot(to, lights_[l].normal)) / (d2 * d2);
      if (weight <= 0) continue;
      all += weight;
      if (!tracer_.blocked(origin, to / d, d * 0.9995f)) seen += weight;
    }
    if (all > 0) sum += lights_[l].exitance * (share[l] * seen / all);
  }
  return sum;
}

void Lighting::light_directly(Mesh& mesh, std::size_t first, const atlas::Context& context) const {
  mesh.direct.resize(mesh.vertices.size());
  atlas::parallel_for(context, mesh.vertices.size() - first, 256,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = first + begin; i < first + end; ++i)
                          mesh.direct[i] = direct_at(mesh.vertices[i]);
                      });
}

namespace {

// The cosine-weighted hemisphere rays of a vertex.
class Hemisphere {
 public:
  Hemisphere(const Vertex& v, std::uint32_t seed)
      : shift_(rotation_at(v.ray_start, seed + 77)),
        tangents_(frame_of(v.normal)),
        normal_(v.normal) {}
  glm::vec3 ray(int i) const {
    const glm::vec2 r = low_discrepancy(i, shift_);
    const float radius = std::sqrt(r.x), angle = 2 * kPiFloat * r.y;
    return radius * std::cos(angle) * std::get<0>(tangents_) +
           radius * std::sin(angle) * std::get<1>(tangents_) +
           std::sqrt(std::max(0.0f, 1 - r.x)) * normal_;
  }

 private:
  glm::vec2 shift_;
  std::tuple<glm::vec3, glm::vec3> tangents_;
  glm::vec3 normal_;
};

Link link_of(const Hit& hit, const Mesh& mesh) {
  const bool sends = hit.triangle != ~0u && hit.front &&
                     mesh.materials[mesh.triangles[hit.triangle].material].emission == glm::vec3(0);
  return {sends ? hit.triangle : ~0u, std::uint16_t(hit.u * 65535), std::uint16_t(hit.v * 65535)};
}

glm::vec3 gather(const Mesh& mesh, std::span<const Link> links,
                 const std::vector<glm::vec3>& total) {
  glm::vec3 sum(0);
  for (const Link& link : links) {
    if (link.triangle == ~0u) continue;
    const Triangle& t = mesh.triangles[link.triangle];
    const float u = link.u / 65535.0f, v = link.v / 65535.0f;
    sum += mesh.materials[t.material].reflectance *
           (total[t.vertex[0]] * (1 - u - v) + total[t.vertex[1]] * u + total[t.vertex[2]] * v);
  }
  return sum / float(links.size());
}

// Averages each vertex with its neighbours on the same sheet, `rounds` times. The gathered light is
// smooth, but its sampling noise is not.
void smooth(const Mesh& mesh, std::vector<glm::vec3>& values, int rounds) {
  std::vector<std::array<Id, 2>> edges;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Id a = t.vertex[k], b = t.vertex[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (int round = 0; round < rounds; ++round) {
    std::vector<glm::vec3> sum = values;
    std::vector<float> weight(values.size(), 1);
    for (const auto& [a, b] : edges) {
      const float w = std::max(0.0f, glm::dot(mesh.vertices[a].normal, mesh.vertices[b].normal));
      const float w8 = w * w * w * w * w * w * w * w * 0.5f;
      sum[a] += values[b] * w8;
      sum[b] += values[a] * w8;
      weight[a] += w8;
      weight[b] += w8;
    }
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = sum[i] / weight[i];
  }
}

}  // namespace

void Lighting::light_indirectly(Mesh& mesh, const atlas::Context& context) const {
  const std::size_t count = mesh.vertices.size(), rays = std::size_t(options_.indirect_samples);
  std::vector<Link> links(count * rays);
  atlas::parallel_for(context, count, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec3 origin = ray_origin(mesh.vertices[i]);
      const Hemisphere over(mesh.vertices[i], options_.seed);
      for (std::size_t k = 0; k < rays; ++k)
        links[i * rays + k] = link_of(tracer_.nearest(origin, over.ray(int(k))), mesh);
    }
  });
  mesh.indirect.assign(count, glm::vec3(0));
  if (context.cancelled()) return;  // links that were not found lead nowhere
  std::vector<glm::vec3> total = mesh.direct;
  // The brightest surfaces reflect 0.8, so eight bounces leave less than a fifth of the light
  // unsent.
  for (int bounce = 0; bounce < 8; ++bounce) {
    if (context.cancelled()) return;
    atlas::parallel_for(context, count, 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        mesh.indirect[i] = gather(mesh, {links.data() + i * rays, rays}, total);
    });
    for (std::size_t i = 0; i < count; ++i) total[i] = mesh.direct[i] + mesh.indirect[i];
  }
  smooth(mesh, mesh.indirect, 2);
}

void show_emitters(Mesh& mesh) {
  // Emitters are shown near the brightest surfaces. If visible lamps had their full exitance, the
  // cabin that they light would be dark in comparison.
  constexpr float kShown = 0.4f;
  for (const Triangle& t : mesh.triangles) {
    const glm::vec3 emission = mesh.materials[t.material].emission;
    if (emission == glm::vec3(0)) continue;
    for (Id v : t.vertex) {
      mesh.direct[v] = kShown * emission;
      mesh.indirect[v] = glm::vec3(0);
    }
  }
}

}  // namespace cabin

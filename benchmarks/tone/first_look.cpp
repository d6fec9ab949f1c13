#include "benchmarks/tone/first_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "examples/cabin/tracer.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/luma.h"
#include "libatlas/core/percentile.h"
#include "libatlas/core/srgb.h"
#include "libatlas/scene/reader.h"
#include "libatlas/texture/luminance.h"

namespace atlas::bench {
namespace {

constexpr double kFieldOfView = 1.0;  // radians, as the exporters'
constexpr int kSamples = 3;           // a side of a pixel
constexpr std::uint8_t kNothing = 235;

// The pages of a world, seen by rays.
class ShownWorld {
 public:
  explicit ShownWorld(const Scene& world)
      : sampler_(world, Quantity::illuminance), tracer_(positions(world), triangles(world)) {}

  // Returns the display values where a ray ends, or nothing.
  std::optional<glm::vec3> at(glm::vec3 eye, glm::vec3 direction) const {
    const cabin::Hit hit = tracer_.nearest(eye, direction);
    if (hit.triangle == ~0u) return std::nullopt;
    const Vec3f c = LuminanceSampler::sample(sampler_.prepare(hit.triangle, 0), 1 - hit.u - hit.v,
                                             hit.u, hit.v);
    return 255.0f * glm::vec3(srgb_encode(c.x), srgb_encode(c.y), srgb_encode(c.z));
  }

 private:
  static std::vector<glm::vec3> positions(const Scene& world) {
    std::vector<glm::vec3> out;
    for (const Vec3f& p : world.positions) out.emplace_back(p.x, p.y, p.z);
    return out;
  }
  static std::vector<std::array<std::uint32_t, 3>> triangles(const Scene& world) {
    std::vector<std::array<std::uint32_t, 3>> out(world.triangle_count());
    for (std::size_t i = 0; i < world.indices.size(); ++i) out[i / 3][i % 3] = world.indices[i];
    return out;
  }

  LuminanceSampler sampler_;
  cabin::Tracer tracer_;
};

// The light of the scene itself, along the same rays.
class Light {
 public:
  explicit Light(const LightScene& scene) : scene_(scene) {
    if (!scene.shell.triangles.empty())
      tracer_.emplace(scene.shell.positions, scene.shell.triangles);
  }

  void look(glm::vec3 eye, glm::vec3 direction) {
    glares = false;
    if (!tracer_) return;
    // glTF's y is the scene's z.
    const auto turned = [](glm::vec3 v) { return glm::vec3(v.x, -v.z, v.y); };
    const cabin::Hit hit = tracer_->nearest(turned(eye), turned(direction));
    if (hit.triangle == ~0u) return;
    const auto& v = scene_.shell.triangles[hit.triangle];
    glares = scene_.glares[v[0]] || scene_.glares[v[1]] || scene_.glares[v[2]];
    luminance.push_back((1 - hit.u - hit.v) * scene_.luminance[v[0]] +
                        hit.u * scene_.luminance[v[1]] + hit.v * scene_.luminance[v[2]]);
  }
  double lit_share() const {
    if (luminance.empty()) return 1;
    std::vector<float> all = luminance;
    const float least = percentile(all, 0.9) / 100;
    const auto lit = std::count_if(all.begin(), all.end(), [&](float y) { return y >= least; });
    return double(lit) / double(all.size());
  }

  bool glares = false;           // where the last ray ended
  std::vector<float> luminance;  // of all rays that met something

 private:
  const LightScene& scene_;
  std::optional<cabin::Tracer> tracer_;  // nothing: the scene was not made here
};

}  // namespace

Result<FirstLook> look_at(const std::filesystem::path& world, const LightScene& scene,
                          const Context& context) {
  const Result<LoadedScene> loaded = read_scene(world, {}, context);
  if (!loaded.ok()) return loaded.status();
  if (!loaded->view) return Status{ErrorCode::bad_input, world.string() + " has no viewpoint"};
  const ShownWorld shown(loaded->scene);
  Light light(scene);
  const glm::vec3 eye(to_glm(loaded->view->position) - to_glm(loaded->scene.origin));
  const glm::vec3 ahead(glm::normalize(to_glm(loaded->view->direction)));
  const glm::vec3 right = glm::normalize(glm::cross(ahead, glm::vec3(0, 1, 0)));
  const glm::vec3 up = glm::cross(right, ahead);
  const auto reach = float(std::tan(kFieldOfView / 2) / kLookHeight);
  FirstLook look;
  look.picture = Image8(kLookWidth, kLookHeight, 3, kNothing);
  std::vector<float> lumas;
  std::size_t burnt = 0;
  for (int y = 0; y < kLookHeight; ++y)
    for (int x = 0; x < kLookWidth; ++x) {
      glm::vec3 sum(0);
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const float px = 2 * (float(x) + (float(s % kSamples) + 0.5f) / kSamples) - kLookWidth;
        const float py = 2 * (float(y) + (float(s / kSamples) + 0.5f) / kSamples) - kLookHeight;
        const glm::vec3 ray = glm::normalize(ahead + reach * (px * right + py * up));
        const auto colour = shown.at(eye, ray);
        sum += colour.value_or(glm::vec3(kNothing));
        if (!colour) continue;
        lumas.push_back(luma(colour->x, colour->y, colour->z));
        light.look(eye, ray);
        burnt += std::max({colour->x, colour->y, colour->z}) >= 254.5f && !light.glares;
      }
      for (int k = 0; k < 3; ++k)
        look.picture.at(x, y)[k] = std::uint8_t(std::lround(sum[k] / (kSamples * kSamples)));
    }
  if (lumas.empty()) return Status{ErrorCode::bad_input, world.string() + " shows nothing"};
  look.burnt = double(burnt) / double(lumas.size());
  look.median = percentile(lumas, 0.5);
  look.lit = light.lit_share();
  return look;
}

}  // namespace atlas::bench

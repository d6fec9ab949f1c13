// Scenes of lit sheets that meet at creases.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "libatlas/scene/reader.h"
#include "libatlas/texture/light_seams.h"

namespace atlas::test {

using LightAt = std::function<double(Vec3f position)>;

// A scene of sheets, each with vertices of its own.
class Sheets {
 public:
  Sheets() { loaded_.scene.materials.push_back({"white", {1, 1, 1}, -1}); }

  explicit Sheets(LoadedScene loaded) : loaded_(std::move(loaded)) {}

  // Adds n x n quads over the parallelogram at `from` along u and v, facing u x v.
  Sheets& add(Vec3f from, Vec3f u, Vec3f v, int n, const LightAt& light) {
    Scene& scene = loaded_.scene;
    const auto base = static_cast<std::uint32_t>(scene.positions.size());
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const float a = float(i) / float(n), b = float(j) / float(n);
        const Vec3f p{from.x + a * u.x + b * v.x, from.y + a * u.y + b * v.y,
                      from.z + a * u.z + b * v.z};
        const auto e = static_cast<float>(light(p));
        scene.positions.push_back(p);
        scene.illumination.push_back({e, e, e});
      }
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const auto a = base + std::uint32_t(j * (n + 1) + i), c = a + std::uint32_t(n) + 1;
        scene.indices.insert(scene.indices.end(), {a, a + 1, c + 1, a, c + 1, c});
        scene.triangle_material.insert(scene.triangle_material.end(), 2, 0);
      }
    }
    return *this;
  }

  const LoadedScene& loaded() const { return loaded_; }

  LightSeams seams(double texel = 0.001) const {
    const LuminanceSampler sampler(loaded_.scene, Quantity::illuminance);
    LightSeamOptions options;
    options.texel = texel;
    return find_light_seams(sampler, ToneMapping{}, options, {});
  }

 private:
  LoadedScene loaded_;
};

inline LightAt constant(double e) {
  return [e](Vec3f) { return e; };
}

// A floor over [0, 1]² and a wall at its side x = 1, of height 1.
inline Sheets corner(int n, const LightAt& floor, const LightAt& wall) {
  return Sheets()
      .add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n, floor)
      .add({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, n, wall);
}

}  // namespace atlas::test

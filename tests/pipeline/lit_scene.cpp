#include "tests/pipeline/lit_scene.h"

#include <cmath>
#include <utility>

namespace atlas::test {
namespace {

Vec3f light_at(Vec3f p) {
  const double wave = std::sin(1.3 * p.x + 0.4) * std::cos(0.9 * p.y) + 0.3 * p.z;
  return {float(1.2 + 0.8 * wave), float(1.0 + 0.5 * std::cos(1.7 * p.z + p.x)),
          float(0.4 + 0.1 * p.x * p.x / (1 + p.y * p.y))};
}

}  // namespace

LoadedScene lit_scene(const Shape& shape) {
  LoadedScene loaded;
  Scene& scene = loaded.scene;
  scene.positions = shape.positions;
  scene.indices = shape.indices;
  for (const Vec3f& p : shape.positions) scene.illumination.push_back(light_at(p));
  scene.triangle_material.assign(shape.triangle_count(), 0);
  scene.triangle_object.assign(shape.triangle_count(), 0);
  scene.materials.push_back({"white", {0.8f, 0.7f, 0.9f}, -1});
  scene.object_names.push_back(shape.name);
  return loaded;
}

LoadedScene lit_room(int n) {
  Shape walls = box(n, {4, 3, 2.5});
  for (std::size_t t = 0; t < walls.triangle_count(); ++t) {
    std::swap(walls.indices[3 * t + 1], walls.indices[3 * t + 2]);
  }
  return lit_scene(together(walls, moved(icosphere(3, 0.4), 1, {2.6f, 1.1f, 0.4f})));
}

}  // namespace atlas::test

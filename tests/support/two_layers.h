// Lit sheets of two layers, of opposite orientation unless a test wants it otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "libatlas/scene/reader.h"

namespace atlas::test {

using Height = std::function<double(double, double)>;

// A height field over [0, width] x [0, 1].
struct Layer {
  int cells = 12;  // along each side of the square [0, 1] x [0, 1]
  double width = 1;
  bool from_above = true;  // its orientation
  bool other_diagonals = false;
  float light = 100;
};

inline void add_layer(const Layer& layer, const Height& height, Scene& scene) {
  const auto base = std::uint32_t(scene.positions.size());
  const int columns = int(std::lround(layer.cells * layer.width));
  for (int j = 0; j <= layer.cells; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double x = double(i) / layer.cells, y = double(j) / layer.cells;
      scene.positions.push_back({float(x), float(y), float(height(x, y))});
      scene.illumination.push_back({layer.light, layer.light, layer.light});
    }
  }
  const auto row = std::uint32_t(columns + 1);
  for (int j = 0; j < layer.cells; ++j) {
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t v = base + std::uint32_t(j) * row + std::uint32_t(i);
      std::array<std::uint32_t, 6> k{v, v + 1, v + row + 1, v, v + row + 1, v + row};
      if (layer.other_diagonals) k = {v, v + 1, v + row, v + 1, v + row + 1, v + row};
      if (!layer.from_above) std::reverse(k.begin(), k.end());
      scene.indices.insert(scene.indices.end(), k.begin(), k.end());
    }
  }
}

inline LoadedScene sheet(const Layer& above, const Layer& below, const Height& height) {
  LoadedScene loaded;
  Scene& scene = loaded.scene;
  add_layer(above, height, scene);
  add_layer(below, height, scene);
  scene.triangle_material.assign(scene.triangle_count(), 0);
  scene.triangle_object.assign(scene.triangle_count(), 0);
  scene.materials.push_back({"white", {0.8f, 0.8f, 0.8f}, -1});
  scene.object_names.push_back("sheet");
  return loaded;
}

inline const Layer kBelow{.from_above = false, .light = 1};

}  // namespace atlas::test

// Makes small VRML97 worlds and reads them.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {

using Ids = std::vector<std::uint32_t>;
using Places = std::vector<double>;

inline Result<LoadedScene> read(const TempFolder& folder, const std::string& nodes) {
  ReadOptions options;
  options.load_textures = false;
  return read_scene(folder.write("a.wrl", "#VRML V2.0 utf8\n" + nodes), options, {});
}

inline Scene scene_of(const TempFolder& folder, const std::string& nodes) {
  auto loaded = read(folder, nodes);
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  return loaded.ok() ? std::move(loaded->scene) : Scene{};
}

// One triangle whose first corner is at `x`, by which it is found again.
inline std::string triangle(int x) {
  return fmt::format(
      "geometry IndexedFaceSet {{ coord Coordinate {{ point [ {} 0 0, {} 1 0, {} 0 1 ] }}\n"
      "coordIndex [ 0 1 2 -1 ] }}\n",
      x, x, x);
}
inline std::string shape(int x, const std::string& appearance = "") {
  const std::string given = appearance.empty() ? "" : "appearance " + appearance + "\n";
  return "Shape { " + given + triangle(x) + "}\n";
}
inline std::string painted(int x, const std::string& material) {
  return shape(x, "Appearance { material " + material + " }");
}

// The first coordinates of all triangles, in order.
inline std::vector<double> places(const Scene& scene) {
  std::vector<double> result;
  for (std::size_t k = 0; k < scene.indices.size(); k += 3)
    result.push_back(scene.origin.x + scene.positions[scene.indices[k]].x);
  return result;
}
inline std::vector<double> places(const TempFolder& folder, const std::string& nodes) {
  return places(scene_of(folder, nodes));
}

}  // namespace atlas::test

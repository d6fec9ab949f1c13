// Sound inputs to damage: one of each dialect that the fuzz targets read.
#pragma once

#include <string>
#include <vector>

namespace atlas::test {

struct Seed {
  std::string extension;  // "glb"
  std::string name;       // of the dialect: "draco_sequential"
  std::string bytes;
};

// Scene files. scene_seed() returns one of them, which must exist.
std::vector<Seed> scene_seeds();
Seed scene_seed(const std::string& extension, const std::string& name);
// Images of 3 x 2 texels, uncompressed but for those that the library writes itself.
std::vector<Seed> image_seeds();
// Lists of rectangles, and of illumination.
std::vector<Seed> list_seeds();

}  // namespace atlas::test

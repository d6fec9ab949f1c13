// Writes the seeds of the fuzz targets: FOLDER/EXTENSION/NAME.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/seeds.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write-seeds FOLDER\n");
    return 2;
  }
  for (const auto& seeds :
       {atlas::test::scene_seeds(), atlas::test::image_seeds(), atlas::test::list_seeds()})
    for (const atlas::test::Seed& seed : seeds) {
      const std::filesystem::path folder = std::filesystem::path(argv[1]) / seed.extension;
      std::filesystem::create_directories(folder);
      std::ofstream file(folder / seed.name, std::ios::binary);
      file.write(seed.bytes.data(), std::streamsize(seed.bytes.size()));
      if (!file.flush()) {
        std::fprintf(stderr, "%s: cannot be written\n", (folder / seed.name).c_str());
        return 1;
      }
    }
}

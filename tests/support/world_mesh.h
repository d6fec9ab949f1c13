// Reads lit scenes and exported worlds as plain triangles. The code is independent, because a test
// of an exporter must not use the library's own readers.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas::test {

struct WorldMesh {
  struct Surface {
    glm::vec3 diffuse{1};
    int image = -1;  // index into images, or -1
  };
  static constexpr std::uint32_t kNoTexcoord = ~0u;

  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> light;  // one per position; all ones if the file has none
  std::vector<glm::vec2> texcoords;
  std::vector<std::array<std::uint32_t, 3>> triangles, triangle_texcoords;
  std::vector<std::uint32_t> triangle_surface;
  std::vector<Surface> surfaces;
  std::vector<Image8> images;  // origin bottom left
};

// Reads a file by its extension: .obj (with its MTL; v x y z r g b), .wrl (Shapes under Transforms,
// ImageTexture) or .html (whose pages are images).
Result<WorldMesh> read_world(const std::filesystem::path& path);

}  // namespace atlas::test

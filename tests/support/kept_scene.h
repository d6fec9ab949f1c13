// Reads glTF and OBJ meshes with two sets of uvs, normals, objects and materials as plain
// triangles. The code is independent, because a test of an exporter must not use the library's own
// readers.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas::test {

struct KeptCorner {
  Vec3f position, normal;  // normal: 0 if the file has none
  Vec2f texcoord;          // glTF: TEXCOORD_0, origin bottom left; OBJ: vt
  Vec2f uv;                // glTF: TEXCOORD_1, origin bottom left
};

struct KeptTriangle {
  std::string object, material;
  std::string image;  // glTF: name or number of the image of its base colour, or empty
  std::array<KeptCorner, 3> corners;
  bool has_normals = false, has_texcoords = false;
  std::size_t page = 0;  // glTF: of the lightmap (extras.lightmap of the primitive)
};

// Both throw std::runtime_error if the file is not as this library writes it: triangles, floats,
// one buffer, and node transforms only if there is one root.
std::vector<KeptTriangle> read_kept_gltf(const std::filesystem::path& path);
std::vector<KeptTriangle> read_kept_obj(const std::filesystem::path& path);

// Throws std::runtime_error if the file cannot be read.
std::string bytes_of_file(const std::filesystem::path& path);

// Returns the JSON of a .gltf or .glb as text.
std::string gltf_json(const std::filesystem::path& path);

}  // namespace atlas::test

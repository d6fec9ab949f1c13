// Meshes with two sets of uvs, normals, objects and materials as plain triangles, read from glTF
// and OBJ by code of our own: what judges an export must not share its readers.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas::test {

struct KeptCorner {
  Vec3f position, normal;  // normal: 0 where the file has none
  Vec2f texcoord;          // glTF: TEXCOORD_0, origin bottom left; OBJ: vt
  Vec2f uv;                // glTF: TEXCOORD_1, likewise
};

struct KeptTriangle {
  std::string object, material;
  std::string image;  // glTF: the name or number of its base colour's image; else empty
  std::array<KeptCorner, 3> corners;
  bool has_normals = false, has_texcoords = false;
};

// Both throw std::runtime_error where the file is not as this library writes it: triangles, floats,
// one buffer, node transforms only where there is one root.
std::vector<KeptTriangle> read_kept_gltf(const std::filesystem::path& path);
std::vector<KeptTriangle> read_kept_obj(const std::filesystem::path& path);

// Throws std::runtime_error where it cannot be read.
std::string bytes_of_file(const std::filesystem::path& path);

// The JSON of a .gltf or .glb, as text.
std::string gltf_json(const std::filesystem::path& path);

}  // namespace atlas::test

// Writes glTF files that keep a scene of glTF, and checks what each of them must share with the
// first.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "tests/exporters/kept_worlds.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {

// A glTF file that is written again does not need the scene's normals.
inline const ReadOptions kGltfRest{.unlit_textures = true, .encoded_textures = true, .rest = true};

inline WorldFile keep(const std::filesystem::path& input, const std::filesystem::path& output,
                      const ReadOptions& options = kGltfRest) {
  return read_and_keep(input, output, options);
}

// What is said of textures that are left out (WorldFile::not_kept).
inline constexpr const char* kNoImage = "1 x textures of materials (no image that can be read)";
inline constexpr const char* kNoUvs =
    "1 x textures of materials (no uvs for them in their primitives)";

inline bool near(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return std::abs(x - y) < 1e-9;
         });
}

// Returns a PNG file of one grey.
inline std::string png_bytes(const TempFolder& folder, int value) {
  const std::filesystem::path made = folder / "made.png";
  EXPECT_TRUE(write_png(made, Image8(4, 2, 3, std::uint8_t(value)), {}).ok());
  const std::string bytes = TempFolder::read(made);
  std::filesystem::remove(made);
  return bytes;
}

// Returns a triangle with uvs and a texture that exists.
inline Gltf textured(const TempFolder& folder) {
  Gltf gltf;
  const std::string bytes = png_bytes(folder, 77);
  const int view = gltf.view(std::vector<char>(bytes.begin(), bytes.end()));
  gltf.j["images"] = json::array({{{"bufferView", view}, {"mimeType", "image/png"}}});
  gltf.j["textures"] = json::array({{{"source", 0}}});
  gltf.j["materials"] =
      json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int uvs = gltf.floats({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  gltf.single({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}, {"material", 0}});
  return gltf;
}

// Expects that every triangle has what it had, in the same order, and new uvs.
inline void expect_kept(const std::vector<OracleTriangle>& before,
                        const std::vector<OracleTriangle>& after, const std::string& set) {
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t t = 0; t < before.size(); ++t) {
    EXPECT_EQ(before[t].node, after[t].node);
    EXPECT_EQ(before[t].material, after[t].material);
    EXPECT_TRUE(near(before[t].matrix, after[t].matrix)) << t;
    for (const auto& [name, values] : before[t].attributes)
      EXPECT_EQ(values, after[t].attributes.at(name)) << t << ' ' << name;
    EXPECT_FALSE(before[t].attributes.contains(set));
    EXPECT_EQ(after[t].attributes.at(set).size(), 6u);
  }
}

}  // namespace atlas::test

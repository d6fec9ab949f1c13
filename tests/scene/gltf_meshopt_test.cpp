// Tests reading buffer views that EXT_meshopt_compression has compressed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/scene/reader.h"
#include "tests/support/packed_gltf.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Bytes;
using test::Gltf;
using test::Grid;
using test::json;
using test::kMeshopt;
using test::kNewerMeshopt;
using test::load_glb;
using test::packed_grid;
using test::PackedGltf;
using test::TempFolder;

// The codec for triangles may begin each of them at another corner.
std::vector<std::array<std::uint32_t, 3>> triangles_of(std::vector<std::uint32_t> indices) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (auto t = indices.begin(); t != indices.end(); t += 3) {
    std::rotate(t, std::min_element(t, t + 3), t + 3);
    triangles.push_back({t[0], t[1], t[2]});
  }
  return triangles;
}

void expect_grid(const Result<LoadedScene>& loaded, double tolerance) {
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Grid grid;
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.positions.size(), grid.positions.size() / 3);
  EXPECT_EQ(triangles_of(s.indices), triangles_of(grid.indices));
  for (std::size_t v = 0; v < s.positions.size(); ++v) {
    EXPECT_NEAR(s.positions[v].x, grid.positions[3 * v], tolerance);
    EXPECT_NEAR(s.positions[v].y, grid.positions[3 * v + 1], tolerance);
    EXPECT_NEAR(s.positions[v].z, grid.positions[3 * v + 2], tolerance);
  }
}

TEST(GltfMeshopt, EachModeGivesTheDataBack) {
  const TempFolder folder;
  for (const bool as_triangles : {true, false}) {
    for (const int size : {2, 4}) expect_grid(load_glb(folder, packed_grid(as_triangles, size)), 0);
  }
}

TEST(GltfMeshopt, TheNewerExtensionHasTheSameData) {
  const TempFolder folder;
  expect_grid(load_glb(folder, packed_grid(true, 2, 0, kNewerMeshopt)), 0);
}

// That a buffer without data is a fallback need not be said.
TEST(GltfMeshopt, FallbackBuffersNeedNoTag) {
  const TempFolder folder;
  PackedGltf g = packed_grid();
  g.j["buffers"][0].erase("extensions");
  expect_grid(load_glb(folder, g), 0);
  folder.write("data.bin", g.bytes);
  g.j["buffers"].insert(g.j["buffers"].begin(),
                        json({{"uri", "data.bin"}, {"byteLength", g.bytes.size()}}));
  expect_grid(read_scene(folder.write("scene.gltf", g.j.dump()), {}, {}), 0);
  for (json& view : g.j["bufferViews"]) view.erase("extensions");
  EXPECT_EQ(read_scene(folder.write("scene.gltf", g.j.dump()), {}, {}).status().code(),
            ErrorCode::bad_input);
}

TEST(GltfMeshopt, ExponentialFilter) {
  const TempFolder folder;
  // The heights, below 1, are rounded by half a step of 15 bits. The others are whole numbers.
  expect_grid(load_glb(folder, packed_grid(true, 2, 16)), 1.0 / (1 << 16));
}

// The same file, not in one piece.
TEST(GltfMeshopt, BufferInAFileOfItsOwn) {
  const TempFolder folder;
  PackedGltf g = packed_grid();
  folder.write("data.bin", g.bytes);
  g.j["buffers"].insert(g.j["buffers"].begin(),
                        json({{"uri", "data.bin"}, {"byteLength", g.bytes.size()}}));
  expect_grid(read_scene(folder.write("scene.gltf", g.j.dump()), {}, {}), 0);
}

TEST(GltfMeshopt, OctahedralNormals) {
  const TempFolder folder;
  const Grid grid;
  const std::size_t count = grid.positions.size() / 3;
  std::vector<float> normals;
  for (std::size_t v = 0; v < count; ++v) {
    const double around = 0.37 * double(v), up = std::cos(0.11 * double(v));
    const double out = std::sqrt(1 - up * up);
    normals.insert(normals.end(),
                   {float(out * std::cos(around)), float(out * std::sin(around)), float(up), 0.0F});
  }
  for (const std::size_t stride : {4, 8}) {
    PackedGltf g = packed_grid();
    Bytes filtered(count * stride);
    meshopt_encodeFilterOct(filtered.data(), count, stride, int(2 * stride), normals.data());
    const int v = g.packed_vertices(filtered.data(), {count, stride, "ATTRIBUTES", "OCTAHEDRAL"});
    g.j["bufferViews"][std::size_t(v)]["byteStride"] = stride;
    g.j["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
        g.accessor({{"bufferView", v},
                    {"componentType", stride == 4 ? 5120 : 5122},
                    {"normalized", true},
                    {"type", "VEC3"},
                    {"count", count}});
    ReadOptions options;
    options.normals = true;
    const auto loaded = read_scene(folder.write("scene.glb", g.glb()), options, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const Scene& s = loaded->scene;
    ASSERT_EQ(s.normal_indices.size(), s.indices.size());
    const double tolerance = stride == 4 ? 0.03 : 2e-4;
    for (std::size_t c = 0; c < s.indices.size(); ++c) {
      const Vec3f n = s.normals[s.normal_indices[c]];
      const float* wanted = &normals[4 * s.indices[c]];
      EXPECT_NEAR(n.x, wanted[0], tolerance);
      EXPECT_NEAR(n.y, wanted[1], tolerance);
      EXPECT_NEAR(n.z, wanted[2], tolerance);
    }
  }
}

// Colours in the filter's form, of K bits: for whole numbers r, g and b with r + b even and
// (r + b) / 2 + g even, luma and differences are whole, and the way back is exact.
TEST(GltfMeshopt, ColorFilter) {
  const TempFolder folder;
  const Grid grid;
  const std::size_t count = grid.positions.size() / 3;
  for (const int bits : {5, 8, 12, 16}) {
    const std::size_t size = bits <= 8 ? 1 : 2;
    const int one = (1 << bits) - 1;
    Bytes filtered;
    std::vector<int> colors;
    const auto put = [&](int value) {
      filtered.push_back(static_cast<unsigned char>(value));
      if (size == 2) filtered.push_back(static_cast<unsigned char>(value >> 8));
    };
    for (std::size_t v = 0; v < count; ++v) {
      const int r = int(v * 7919) & one & ~3, b = int(v * 104729) & one & ~3,
                g = int(v * 1299709) & one & ~1;
      const int co = (r - b) / 2, between = b + co, cg = (g - between) / 2;
      colors.insert(colors.end(), {r, g, b});
      for (const int value : {between + cg, co, cg, (1 << (bits - 1)) | (one >> 1)}) put(value);
    }
    PackedGltf g = packed_grid(true, 2, 0, kNewerMeshopt);
    const int v = g.packed_vertices(filtered.data(), {count, 4 * size, "ATTRIBUTES", "COLOR"});
    g.j["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        g.accessor({{"bufferView", v},
                    {"componentType", size == 1 ? 5121 : 5123},
                    {"normalized", true},
                    {"type", "VEC4"},
                    {"count", count}});
    const auto loaded = load_glb(folder, g);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const double step = 0.51 / (size == 1 ? 255 : 65535);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3f c = loaded->scene.illumination[i];
      EXPECT_NEAR(c.x, double(colors[3 * i]) / one, step) << bits << ' ' << i;
      EXPECT_NEAR(c.y, double(colors[3 * i + 1]) / one, step) << bits << ' ' << i;
      EXPECT_NEAR(c.z, double(colors[3 * i + 2]) / one, step) << bits << ' ' << i;
    }
  }
}

// The library may be too old for vertices of the newer codec; those are not damaged.
TEST(GltfMeshopt, ANewerCodecIsNoDamage) {
  const TempFolder folder;
  PackedGltf g = packed_grid(true, 2, 0, kNewerMeshopt);
  const json& view = g.j["bufferViews"][0]["extensions"][kNewerMeshopt];
  char& version = g.bytes[view["byteOffset"].get<std::size_t>()];
  ASSERT_EQ(version, char(0xa0));
  version = char(0xaf);
  const Status status = load_glb(folder, g).status();
  EXPECT_EQ(status.code(), ErrorCode::unsupported);
  EXPECT_NE(status.message().find("buffer view 0 (KHR_meshopt_compression)"), std::string::npos)
      << status.message();
}

// Instances of one triangle, turned about z by 30 degrees more each.
TEST(GltfMeshopt, QuaternionFilter) {
  const TempFolder folder;
  constexpr std::size_t count = 12;
  std::vector<float> turns;
  for (std::size_t i = 0; i < count; ++i) {
    const double half = M_PI / 12 * double(i);
    turns.insert(turns.end(), {0, 0, float(std::sin(half)), float(std::cos(half))});
  }
  Bytes filtered(8 * count);
  meshopt_encodeFilterQuat(filtered.data(), count, 8, 16, turns.data());
  PackedGltf g;
  const int v = g.packed_vertices(filtered.data(), {count, 8, "ATTRIBUTES", "QUATERNION"});
  json node;
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["ROTATION"] =
      g.accessor({{"bufferView", v},
                  {"componentType", 5122},
                  {"normalized", true},
                  {"type", "VEC4"},
                  {"count", count}});
  const int positions = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  g.single({{"attributes", {{"POSITION", positions}}}}, node);
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ASSERT_EQ(loaded->scene.positions.size(), 3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p = loaded->scene.positions[3 * i + 1];
    EXPECT_NEAR(p.x, std::cos(M_PI / 6 * double(i)), 2e-4);
    EXPECT_NEAR(p.y, std::sin(M_PI / 6 * double(i)), 2e-4);
  }
}

// A file for all readers has both kinds of data. Its compressed copy is not needed.
TEST(GltfMeshopt, PlainDataAreReadAsTheyAre) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  g.single({{"attributes", {{"POSITION", positions}}}});
  g.j["extensionsUsed"] = {kMeshopt};
  g.j["bufferViews"][0]["extensions"][kMeshopt] = {{"buffer", 7}, {"mode", "ATTRIBUTES"}};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.positions[1], (Vec3f{1, 0, 0}));
}

// Views may name the same compressed data, but not without a limit of the sum.
TEST(GltfMeshopt, TheSumOfDecodedDataIsLimited) {
  const TempFolder folder;
  const PackedGltf whole = packed_grid();
  const json packed = whole.j["bufferViews"][0]["extensions"][kMeshopt];
  const std::size_t decoded = std::size_t(packed["count"]) * std::size_t(packed["byteStride"]);
  const std::size_t most = 64 * whole.bytes.size() / decoded;
  for (const std::size_t times : {most / 2, 2 * most}) {
    PackedGltf g = whole;
    for (std::size_t i = 0; i < times; ++i) g.j["bufferViews"].push_back(g.j["bufferViews"][0]);
    const auto loaded = load_glb(folder, g);
    EXPECT_EQ(loaded.ok(), times < most);
    if (loaded.ok()) continue;
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
    EXPECT_NE(loaded.status().message().find("decodes to more than"), std::string::npos);
  }
}

TEST(GltfMeshopt, DamageIsNamedWithItsView) {
  const TempFolder folder;
  const struct {
    std::size_t view;
    json change;
    const char* message;
  } cases[] = {
      {0, {{"buffer", 9}}, "buffer view 0 (EXT_meshopt_compression) names a buffer"},
      {0, {{"buffer", "x"}}, "names a buffer"},
      {0, {{"byteOffset", 1 << 20}}, "leaves its buffer"},
      {0, {{"byteOffset", -4}}, "leaves its buffer"},
      {0, {{"byteLength", 0}}, "leaves its buffer"},
      {0, {{"byteLength", 40}}, "is too short for what it should hold"},
      {0, {{"byteLength", 400}}, "cannot be decompressed"},
      {0, {{"count", 0}}, "has no count"},
      {0, {{"count", 1.5}}, "has no count"},
      {0, {{"count", 1e15}}, "is too short for what it should hold"},
      {0, {{"byteStride", 6}}, "has a count or byteStride that ATTRIBUTES cannot have"},
      {0, {{"byteStride", 512}, {"count", 20}}, "byteStride that ATTRIBUTES cannot have"},
      {0, {{"mode", "OTHER"}}, "is of an unknown mode"},
      {0, {{"mode", 4}}, "is of an unknown mode"},
      {0, {{"mode", "TRIANGLES"}}, "byteStride that TRIANGLES cannot have"},
      {0, {{"filter", "OTHER"}}, "has a filter, OTHER, that it cannot have"},
      {0, {{"filter", "QUATERNION"}}, "has a filter, QUATERNION, that it cannot have"},
      {0, {{"filter", "OCTAHEDRAL"}}, "has a filter, OCTAHEDRAL, that it cannot have"},
      {1, {{"count", 1000}}, "buffer view 1 (EXT_meshopt_compression) has a count"},
      {1, {{"byteStride", 3}}, "byteStride that TRIANGLES cannot have"},
      {1, {{"mode", "INDICES"}}, "buffer view 1 (EXT_meshopt_compression) cannot be decompressed"},
      {1, {{"filter", "EXPONENTIAL"}}, "has a filter, EXPONENTIAL, that it cannot have"},
  };
  const PackedGltf whole = packed_grid();
  for (const auto& c : cases) {
    PackedGltf g = whole;
    g.j["bufferViews"][c.view]["extensions"][kMeshopt].update(c.change);
    const Status status = load_glb(folder, g).status();
    EXPECT_EQ(status.code(), ErrorCode::bad_input) << c.change;
    EXPECT_NE(status.message().find(c.message), std::string::npos)
        << c.change << ": " << status.message();
    EXPECT_NE(status.message().find("scene.glb"), std::string::npos);
  }
  PackedGltf g = whole;
  g.j["bufferViews"][0].erase("extensions");
  EXPECT_EQ(load_glb(folder, g).status().code(), ErrorCode::bad_input);
}

}  // namespace
}  // namespace atlas

// Tests reading primitives that KHR_draco_mesh_compression has compressed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "libatlas/core/clock.h"
#include "libatlas/scene/reader.h"
#include "tests/support/draco_gltf.h"
#include "tests/support/packed_gltf.h"
#include "tests/support/slowness.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::compress;
using test::DracoGltf;
using test::DracoSource;
using test::Grid;
using test::json;
using test::kDraco;
using test::load_glb;
using test::TempFolder;

constexpr auto kPosition = draco::GeometryAttribute::POSITION;

DracoSource grid_source(const Grid& grid) {
  DracoSource source;
  source.indices = grid.indices;
  source.points = grid.positions.size() / 3;
  source.attributes = {{kPosition, 3, draco::DT_FLOAT32, grid.positions.data()}};
  return source;
}

// A file of the grid alone.
DracoGltf grid_gltf(const DracoSource& source) {
  DracoGltf g;
  g.single(g.primitive(source, {{"POSITION", g.promised(source.points, "VEC3")}}));
  return g;
}

// Triangles as sets of corners, since compression changes the order of points and triangles.
using Corners = std::set<std::array<float, 3>>;
std::multiset<Corners> corners_of(const std::vector<std::uint32_t>& indices,
                                  const std::function<std::array<float, 3>(std::uint32_t)>& at) {
  std::multiset<Corners> all;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3)
    all.insert({at(indices[t]), at(indices[t + 1]), at(indices[t + 2])});
  return all;
}

void expect_grid(const Result<LoadedScene>& loaded) {
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Grid grid;
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.positions.size(), grid.positions.size() / 3);
  EXPECT_TRUE(loaded->defects.empty());
  const auto found = corners_of(s.indices, [&](std::uint32_t i) {
    return std::array{s.positions[i].x, s.positions[i].y, s.positions[i].z};
  });
  EXPECT_EQ(found, corners_of(grid.indices, [&](std::uint32_t i) {
              return std::array{grid.positions[3 * i], grid.positions[3 * i + 1],
                                grid.positions[3 * i + 2]};
            }));
}

TEST(GltfDraco, BothMethodsGiveTheDataBack) {
  const TempFolder folder;
  const Grid grid;
  DracoSource source = grid_source(grid);
  for (const bool sequential : {true, false}) {
    for (const bool metadata : {true, false}) {
      source.sequential = sequential;
      source.metadata = metadata;
      expect_grid(load_glb(folder, grid_gltf(source)));
    }
  }
}

// Of n bits over the largest extent, a step is extent / (2^n - 1).
TEST(GltfDraco, QuantisedPositionsAreWithinHalfAStep) {
  const TempFolder folder;
  const Grid grid;
  DracoSource source = grid_source(grid);
  source.bits = 11;
  const auto loaded = load_glb(folder, grid_gltf(source));
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.positions.size(), source.points);
  const double half = 0.5 * (Grid::side - 1) / ((1 << 11) - 1);
  double worst = 0;
  for (std::size_t v = 0; v < source.points; ++v)
    worst = std::max(worst, std::abs(double(s.positions[v].z) - grid.positions[3 * v + 2]));
  EXPECT_LE(worst, half * 1.0001);
  EXPECT_GT(worst, 0.5 * half);
}

// Colours of bytes are fractions; their rows are padded to four bytes.
TEST(GltfDraco, AttributesComeInTheTypesOfTheirAccessors) {
  const TempFolder folder;
  const Grid grid;
  DracoSource source = grid_source(grid);
  std::vector<std::uint8_t> colours;
  std::vector<float> uvs, normals;
  for (std::size_t v = 0; v < source.points; ++v) {
    for (std::size_t c = 0; c < 3; ++c) colours.push_back(static_cast<std::uint8_t>(v * (c + 1)));
    uvs.insert(uvs.end(), {float(v) / 1024, 1 - float(v) / 2048});
    normals.insert(normals.end(), {v % 2 == 0 ? 1.0F : 0.0F, 0, v % 2 == 0 ? 0.0F : 1.0F});
  }
  source.attributes.push_back(
      {draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8, colours.data(), true});
  source.attributes.push_back(
      {draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32, uvs.data()});
  source.attributes.push_back(
      {draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32, normals.data()});
  DracoGltf g;
  const int colour = g.promised(source.points, "VEC3", 5121);
  g.j["accessors"][std::size_t(colour)]["normalized"] = true;
  json primitive = g.primitive(source, {{"POSITION", g.promised(source.points, "VEC3")},
                                        {"COLOR_0", colour},
                                        {"TEXCOORD_0", g.promised(source.points, "VEC2")},
                                        {"NORMAL", g.promised(source.points, "VEC3")}});
  g.single(std::move(primitive));
  const auto loaded = read_scene(folder.write("scene.glb", g.glb()), {.normals = true}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.positions.size(), source.points);
  ASSERT_EQ(s.illumination.size(), source.points);
  ASSERT_EQ(s.texcoords.size(), source.points);
  ASSERT_EQ(s.normals.size(), source.points);
  for (std::size_t v = 0; v < source.points; ++v) {
    EXPECT_FLOAT_EQ(s.illumination[v].x, float(colours[3 * v]) / 255) << v;
    EXPECT_FLOAT_EQ(s.illumination[v].z, float(colours[3 * v + 2]) / 255) << v;
    EXPECT_EQ(s.texcoords[v].x, uvs[2 * v]) << v;
    EXPECT_FLOAT_EQ(s.texcoords[v].y, 1 - uvs[2 * v + 1]) << v;
    EXPECT_EQ(s.normals[v].z, normals[3 * v + 2]) << v;
  }
}

// Some exporters write the counts that the mesh had before compression, which joins equal points.
TEST(GltfDraco, CountsAreThoseOfTheData) {
  const TempFolder folder;
  const Grid grid;
  DracoGltf g = grid_gltf(grid_source(grid));
  for (json& accessor : g.j["accessors"]) accessor["count"] = 5;
  expect_grid(load_glb(folder, g));
}

// Indices are decoded in full, whatever their accessor says of their type, and also without one.
TEST(GltfDraco, IndicesAreThoseOfTheData) {
  const TempFolder folder;
  const Grid grid;
  DracoGltf g = grid_gltf(grid_source(grid));
  json& primitive = g.j["meshes"][0]["primitives"][0];
  g.j["accessors"][primitive["indices"].get<std::size_t>()]["componentType"] = 5121;
  expect_grid(load_glb(folder, g));
  primitive.erase("indices");
  expect_grid(load_glb(folder, g));
  primitive["mode"] = 5;
  expect_grid(load_glb(folder, g));
}

TEST(GltfDraco, PrimitivesMayShareAccessors) {
  const TempFolder folder;
  const Grid grid;
  DracoGltf g = grid_gltf(grid_source(grid));
  json& primitives = g.j["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 2 * grid.indices.size() / 3);
  EXPECT_EQ(loaded->scene.positions.size(), grid.positions.size() / 3);
}

// The same data may be decoded several times, but not without a limit.
TEST(GltfDraco, TheSumOfDecodedDataIsLimited) {
  const TempFolder folder;
  constexpr std::uint32_t kGridSide = 100;
  std::vector<float> positions;
  DracoSource source;
  source.sequential = false;
  source.bits = 8;
  source.points = kGridSide * kGridSide;
  for (std::uint32_t p = 0; p < source.points; ++p) {
    const std::uint32_t x = p % kGridSide, y = p / kGridSide;
    positions.insert(positions.end(), {float(x), float(y), 0});
    if (x + 1 < kGridSide && y + 1 < kGridSide)
      for (const std::uint32_t corner : {0u, 1u, kGridSide, kGridSide, 1u, kGridSide + 1})
        source.indices.push_back(p + corner);
  }
  source.attributes = {{kPosition, 3, draco::DT_FLOAT32, positions.data()}};
  for (const int times : {100, 200}) {
    DracoGltf g = grid_gltf(source);
    json& primitives = g.j["meshes"][0]["primitives"];
    for (int i = 1; i < times; ++i) {
      json copy = primitives[0];
      copy["indices"] = g.promised(source.indices.size(), "SCALAR", 5125);
      copy["attributes"]["POSITION"] = g.promised(source.points, "VEC3");
      primitives.push_back(copy);
    }
    // Triangles take 12 bytes each, and a point its position, 12 bytes, twice.
    const std::size_t decoded = (4 * source.indices.size() + 24 * source.points) * times;
    constexpr std::size_t kLeast = std::size_t{64} << 20;
    ASSERT_LT(64 * 64 * g.bytes.size(), kLeast);
    const auto loaded = load_glb(folder, g);
    EXPECT_EQ(loaded.ok(), decoded <= kLeast);
    if (loaded.ok()) {
      EXPECT_EQ(loaded->scene.triangle_count(), source.indices.size() / 3 * times);
    } else {
      EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
      EXPECT_NE(loaded.status().message().find("decodes to more than"), std::string::npos);
    }
  }
}

// Draco takes the number of bits that tell how uvs are predicted from the data, and decodes up to
// 2^31 of them: for eight seconds, in a file of a few hundred bytes.
TEST(GltfDraco, CountsWithinTheDataAreNotBelieved) {
  const TempFolder folder;
  const Grid grid;
  DracoSource source = grid_source(grid);
  std::vector<float> uvs;
  for (std::size_t p = 0; p < source.points; ++p)
    uvs.insert(uvs.end(), {grid.positions[3 * p], grid.positions[3 * p + 1]});
  source.attributes.push_back(
      {draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32, uvs.data()});
  source.sequential = false;
  source.bits = 12;
  source.speed = 0;
  DracoGltf g;
  g.single(g.primitive(source, {{"POSITION", g.promised(source.points, "VEC3")},
                                {"TEXCOORD_0", g.promised(source.points, "VEC2")}}));
  ASSERT_TRUE(load_glb(folder, g).ok()) << load_glb(folder, g).status().message();
  const std::string whole = g.bytes;
  double longest = 0;
  for (std::size_t at = 0; at + 4 <= whole.size(); ++at) {
    g.bytes = whole;
    g.bytes.replace(at, 4, "\xff\xff\xff\x7f");
    const double begun = cpu_seconds();
    static_cast<void>(load_glb(folder, g));
    longest = std::max(longest, cpu_seconds() - begun);
  }
  EXPECT_LT(longest, 0.2 * test::kSlowness);
}

// Data that announce far more than their accessors are refused before they are decoded.
TEST(GltfDraco, CountsAreHeldAgainstTheAccessors) {
  const TempFolder folder;
  constexpr std::uint32_t kSide = 150;
  std::vector<float> positions;
  DracoSource source;
  source.sequential = false;
  source.points = kSide * kSide;
  for (std::uint32_t p = 0; p < source.points; ++p) {
    const std::uint32_t x = p % kSide, y = p / kSide;
    positions.insert(positions.end(), {float(x), float(y), 0});
    if (x + 1 < kSide && y + 1 < kSide)
      for (const std::uint32_t corner : {0u, 1u, kSide, kSide, 1u, kSide + 1})
        source.indices.push_back(p + corner);
  }
  source.attributes = {{kPosition, 3, draco::DT_FLOAT32, positions.data()}};
  DracoGltf g = grid_gltf(source);
  ASSERT_TRUE(load_glb(folder, g).ok());
  for (json& accessor : g.j["accessors"]) accessor["count"] = 300;
  const auto refused = load_glb(folder, g);
  EXPECT_NE(refused.status().message().find("but its accessors 300"), std::string::npos)
      << refused.status().message();
}

// The compressed copy, which is damaged here, is not needed.
TEST(GltfDraco, PlainDataAreReadInstead) {
  const TempFolder folder;
  const Grid grid;
  test::Gltf g;
  const int positions = g.floats(grid.positions, "VEC3", 3);
  const int indices = g.indices(grid.indices);
  const json draco = {{"bufferView", g.view(std::vector<int>{1, 2, 3})},
                      {"attributes", {{"POSITION", 0}}}};
  g.single({{"attributes", {{"POSITION", positions}}},
            {"indices", indices},
            {"extensions", {{kDraco, draco}}}});
  expect_grid(load_glb(folder, g));
}

TEST(GltfDraco, MalformedDescriptionsAreRefused) {
  struct Case {
    const char* message;
    std::function<void(json& primitive, json& draco, json& file)> spoil;
  };
  const Case cases[] = {
      {"is not an object", [](json&, json& draco, json&) { draco = 7; }},
      {"has no list of attributes", [](json&, json& draco, json&) { draco["attributes"] = 7; }},
      {"has no id of POSITION", [](json&, json& draco, json&) { draco.erase("attributes"); }},
      {"has no attributes to fill", [](json& p, json&, json&) { p["attributes"] = 7; }},
      {"has no triangles", [](json& p, json&, json&) { p["mode"] = 0; }},
      {"has no bufferView", [](json&, json& draco, json&) { draco["bufferView"] = 1; }},
      {"has no bufferView", [](json&, json& draco, json&) { draco.erase("bufferView"); }},
      {"an id of POSITION that is no whole number",
       [](json&, json& draco, json&) { draco["attributes"]["POSITION"] = -1; }},
      {"an id of POSITION that is no whole number",
       [](json&, json& draco, json&) { draco["attributes"]["POSITION"] = 0x100000000; }},
      {"no attribute of id 9",
       [](json&, json& draco, json&) { draco["attributes"]["POSITION"] = 9; }},
      {"no accessor for NORMAL",
       [](json&, json& draco, json&) { draco["attributes"]["NORMAL"] = 0; }},
      {"no accessor for POSITION", [](json& p, json&, json&) { p["attributes"]["POSITION"] = 99; }},
      {"has 3 components, not 2",
       [](json&, json&, json& file) { file["accessors"][0]["type"] = "VEC2"; }},
      {"values of no known kind",
       [](json&, json&, json& file) { file["accessors"][0]["type"] = "MAT3"; }},
      {"values do not fit its accessor",
       [](json&, json&, json& file) { file["accessors"][0]["componentType"] = 5121; }},
      {"leaves its buffer",
       [](json&, json&, json& file) { file["bufferViews"][0]["byteLength"] = 1 << 20; }},
      {"shares accessor 0 with other compressed data",
       [](json& p, json& draco, json&) {
         p["attributes"]["NORMAL"] = 0;
         draco["attributes"]["NORMAL"] = 1;
       }},
      {"shares accessor 0 with other compressed data",
       [](json& p, json&, json&) { p["indices"] = 0; }},
  };
  const TempFolder folder;
  const Grid grid;
  for (const Case& c : cases) {
    DracoGltf g = grid_gltf(grid_source(grid));
    json& primitive = g.j["meshes"][0]["primitives"][0];
    c.spoil(primitive, primitive["extensions"][kDraco], g.j);
    const auto loaded = load_glb(folder, g);
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input) << c.message;
    const std::string message = loaded.status().message();
    EXPECT_NE(message.find(c.message), std::string::npos) << message;
    EXPECT_NE(message.find("mesh 0 primitive 0"), std::string::npos) << message;
  }
}

// Replaces the compressed bytes of the grid's file.
DracoGltf with_bytes(const std::vector<unsigned char>& bytes) {
  const Grid grid;
  DracoGltf g = grid_gltf(grid_source(grid));
  const int view = g.view(bytes);
  g.j["meshes"][0]["primitives"][0]["extensions"][kDraco]["bufferView"] = view;
  return g;
}

TEST(GltfDraco, DamagedDataAreRefused) {
  const TempFolder folder;
  const Grid grid;
  const std::vector<unsigned char> sound = compress(grid_source(grid));
  const auto message = [&](const std::function<void(std::vector<unsigned char>&)>& spoil) {
    std::vector<unsigned char> bytes = sound;
    spoil(bytes);
    const auto loaded = load_glb(folder, with_bytes(bytes));
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
    return loaded.status().message();
  };
  using Bytes = std::vector<unsigned char>;
  EXPECT_NE(message([](Bytes& b) { b[0] = 'd'; }).find("holds no data of Draco"),
            std::string::npos);
  EXPECT_NE(message([](Bytes& b) { b.resize(10); }).find("no data of Draco"), std::string::npos);
  EXPECT_NE(message([](Bytes& b) { b.resize(11); }).find("ends too early"), std::string::npos);
  EXPECT_NE(message([](Bytes& b) { b[5] = 1; }).find("bitstream 1.2"), std::string::npos);
  EXPECT_NE(message([](Bytes& b) { b[7] = 0; }).find("a point cloud"), std::string::npos);
  EXPECT_NE(message([](Bytes& b) { b[10] = 0x80; }).find("damaged metadata"), std::string::npos);
  EXPECT_NE(message([](Bytes& b) { b.resize(b.size() / 2); }).find("cannot be decompressed"),
            std::string::npos);
  // Four thousand million triangles, of which the memory could not be had.
  EXPECT_NE(message([](Bytes& b) {
              const Bytes many = {0xff, 0xff, 0xff, 0xff, 0x0f};
              b.insert(b.begin() + 11, many.begin(), many.end());
            }).find("too short for what it should hold"),
            std::string::npos);
}

TEST(GltfDraco, RandomDamageNeverCrashes) {
  const TempFolder folder;
  const Grid grid;
  std::uint64_t state = 3;
  const auto random = [&](std::size_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return std::size_t(state >> 33) % below;
  };
  DracoSource source = grid_source(grid);
  int refused = 0;
  for (const bool sequential : {true, false}) {
    source.sequential = sequential;
    source.bits = sequential ? 0 : 12;
    const std::vector<unsigned char> sound = compress(source);
    for (int round = 0; round < 200; ++round) {
      std::vector<unsigned char> bytes = sound;
      for (std::size_t n = 1 + random(4); n > 0; --n)
        bytes[11 + random(bytes.size() - 11)] = static_cast<unsigned char>(random(256));
      const auto loaded = load_glb(folder, with_bytes(bytes));
      refused += !loaded.ok();
      if (!loaded.ok()) {
        EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
      }
    }
  }
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace atlas

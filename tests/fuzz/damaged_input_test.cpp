// Runs the fuzz targets on inputs that random changes have damaged.
#include <gtest/gtest.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "tests/fuzz/targets.h"
#include "tests/support/file_bytes.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/leaks.h"

namespace atlas {
namespace {

using test::json;

const std::string kObj = R"(mtllib second.mtl
o a
v 0 0 0 1 0.5 .25
v 1 0 0 2 0 0
v 1 1 .5 3 0 0
v 0 1 0 4 0 0
vt 0 0
vt 1 0
vt 1 1 0
vn 0 0 1
usemtl red
f 1/1/1 2/2/1 3/3/1
g b c
usemtl blue
f -1//-1 -2//-1 1//1 2//1
f 1/1 2/2 \
 3/3
l 1 2
%%
newmtl red
Kd 1 .5 0.25
Ke 0 1 0
d .5
map_Kd -s 1 2 1 -o 0 0 0 -clamp on -mm 0 1 a.png
newmtl blue
Kd 0.2
Tr 0.3
)";

const std::string kPly = R"(ply
format ascii 1.0
comment TextureFile a.png
element vertex 4
property float x
property float y
property double z
property uchar red
property uchar green
property uchar blue
property float nx
property float ny
property float nz
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
property int texnumber
end_header
0 0 0 255 3 4 0 0 1
1 0 0 255 3 4 0 0 1
1 1 .5 0 3 4 0 0 1
0 1 0 255 3 4 0 0 1
3 0 1 2 6 0 0 1 0 1 1 0
4 0 1 2 3 8 0 0 1 0 1 1 0 1 -1
)";

const std::string kOff = R"(STCNOFF
4 2 0
0 0 0 0 0 1 255 51 0 255 .25 .5
1 0 0 0 0 1 0 0 0 255 1 0
0 1 0 0 0 1 0 102 0 255 -2 3
1 1 0 0 0 1 1 2 3 255 0 0
3 2 1 0
4 0 1 3 2 255 0 0
)";

const std::string kStl = R"(solid x
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid x
)";

const std::string kWrl = R"(#VRML V2.0 utf8
WorldInfo { title "x" info [ "a" ] }
DEF a Transform { translation 1 2 3 rotation 0 0 1 .5 scale 2 2 2 children [
  Shape {
    appearance Appearance {
      material Material { diffuseColor 1 1 1 }
      texture ImageTexture { url [ "a.png" ] repeatS FALSE }
    }
    geometry IndexedFaceSet {
      coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }
      texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] }
      coordIndex [ 0 1 2 -1 0 2 3 -1 ]
      texCoordIndex [ 0 1 2 -1 0 2 3 -1 ]
    }
  }
] }
)";

// Two meshes under three nodes, with a skin, a morph target, instances and an animation.
std::string glb() {
  test::Gltf g;
  const int positions = g.floats(test::kSquare, "VEC3", 3);
  const int light = g.floats({1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 1, 1}, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int weights = g.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  const int joints = g.accessor({{"bufferView", g.view(std::vector<std::uint8_t>(16))},
                                 {"componentType", 5121},
                                 {"type", "VEC4"},
                                 {"count", 4}});
  const int places = g.floats({0, 0, 0, 5, 0, 0}, "VEC3", 3);
  const int times = g.floats({0, 1}, "SCALAR", 1);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.single({{"attributes",
             {{"POSITION", positions},
              {"_ILLUMINANCE", light},
              {"TEXCOORD_0", uvs},
              {"JOINTS_0", joints},
              {"WEIGHTS_0", weights}}},
            {"indices", indices},
            {"material", 0}},
           {{"skin", 0}, {"children", {1}}});
  g.j["meshes"].push_back(
      {{"weights", {0.5}},
       {"primitives", json::array({{{"attributes", {{"POSITION", positions}}},
                                    {"targets", json::array({{{"POSITION", light}}})},
                                    {"mode", 5}}})}});
  g.j["nodes"].push_back({{"name", "joint"}, {"translation", {1, 2, 3}}});
  g.j["nodes"].push_back(
      {{"mesh", 1},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  g.j["scenes"][0]["nodes"] = {0, 2};
  g.j["skins"] = json::array({{{"joints", {1}}}});
  g.j["materials"] =
      json::array({{{"name", "a"},
                    {"alphaMode", "MASK"},
                    {"pbrMetallicRoughness", {{"baseColorFactor", {1, .5, .2, 1}}}}}});
  g.j["animations"] = json::array(
      {{{"channels",
         json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})},
        {"samplers", json::array({{{"input", times}, {"output", places}}})}}});
  return g.glb();
}

// Two squares with materials, on two pages of a lightmap that are one image.
std::string lightmapped_glb() {
  test::Gltf g;
  const int positions = g.floats(test::kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  const auto square = [&](int page) {
    return json{{"attributes", {{"POSITION", positions}, {"TEXCOORD_1", uvs}}},
                {"indices", indices},
                {"material", page},
                {"extras", {{"lightmap", page}}}};
  };
  g.single(square(0));
  g.j["meshes"][0]["primitives"].push_back(square(1));
  g.j["materials"] = {{{"name", "a"}}, {{"name", "b"}, {"doubleSided", true}}};
  g.j["asset"]["extras"]["lightmap"] = {{"images", {"page.hdr", "page.hdr"}},
                                        {"linear", {"page.hdr", "page.hdr"}},
                                        {"texCoord", 1},
                                        {"white", 2.5}};
  return g.glb();
}

using Input = std::vector<std::uint8_t>;

// Returns the text after up to `most` changes, copies, removals or insertions of some bytes. What
// is inserted is often a number that readers may stumble over.
Input damaged(const std::string& text, std::size_t most, std::mt19937& random) {
  Input bytes(text.begin(), text.end());
  static const std::string hostile[] = {"-1", "4294967295", "1e39", "nan", "-",
                                        "\n", "\"",         "[",    "0"};
  for (auto hits = 1 + random() % most; hits > 0 && bytes.size() > 8; --hits) {
    const auto at = bytes.begin() + std::ptrdiff_t(random() % (bytes.size() - 8));
    switch (random() % 5) {
      case 0:
        *at = std::uint8_t(random());
        break;
      case 1:
        *at ^= std::uint8_t(1u << random() % 8);
        break;
      case 2:
        bytes.erase(at, at + std::ptrdiff_t(random() % 8));
        break;
      case 3: {
        const Input copy(at, at + 8);
        bytes.insert(bytes.begin() + std::ptrdiff_t(random() % bytes.size()), copy.begin(),
                     copy.end());
        break;
      }
      default: {
        const std::string& word = hostile[random() % std::size(hostile)];
        bytes.insert(at, word.begin(), word.end());
      }
    }
  }
  if (random() % 16 == 0) bytes.resize(random() % bytes.size());
  return bytes;
}

struct Seed {
  const char* extension;
  std::string bytes;
};

// How an input is damaged: so often, by that many changes at most, drawn from this seed.
struct Damage {
  int rounds;
  std::size_t most;
  unsigned seed;
};

// Runs a target on damaged inputs until one is at fault. Returns how many it accepted.
int accepted_of(const Seed& input, const Damage& damage, const auto& target) {
  std::mt19937 random(damage.seed);
  int accepted = 0;
  for (int round = 0; round < damage.rounds; ++round) {
    const test::FuzzResult result =
        target(damaged(input.bytes, damage.most, random), input.extension);
    EXPECT_EQ(result.fault, "") << "round " << round;
    if (!result.fault.empty()) break;
    accepted += result.accepted;
  }
  return accepted;
}

class DamagedFiles : public ::testing::TestWithParam<Seed> {};

TEST_P(DamagedFiles, AreSoundUndamaged) {
  const test::TempFolder folder;
  const auto loaded =
      read_scene(folder.write(std::string("a.") + GetParam().extension, GetParam().bytes), {}, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
}

TEST_P(DamagedFiles, AreReadOrRefused) {
  EXPECT_GT(accepted_of(GetParam(), {1000, 4, 1}, test::fuzz_reader), 20);
}

TEST_P(DamagedFiles, AreShownByThePlayer) {
  EXPECT_GT(accepted_of(GetParam(), {100, 4, 4}, test::fuzz_view), 2);
}

TEST_P(DamagedFiles, AreRepackedOrRefused) {
  const int accepted = accepted_of(GetParam(), {100, 2, 5}, test::fuzz_repack);
  if (GetParam().extension == std::string("stl")) {
    EXPECT_EQ(accepted, 0) << "there are no uvs";
  } else {
    EXPECT_GT(accepted, 5);
  }
}

TEST_P(DamagedFiles, AreExportedAndReadAgain) {
  EXPECT_GT(accepted_of(GetParam(), {20, 1, 2}, test::fuzz_export), 2);
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedFiles,
                         ::testing::Values(Seed{"obj", kObj}, Seed{"ply", kPly}, Seed{"off", kOff},
                                           Seed{"stl", kStl}, Seed{"wrl", kWrl},
                                           Seed{"glb", glb()}),
                         [](const auto& test) { return test.param.extension; });

TEST(DamagedLightmaps, AreReadOrLeftOut) {
  const Seed seed{"glb", lightmapped_glb()};
  EXPECT_GT(accepted_of(seed, {500, 4, 8}, test::fuzz_reader), 20);
  EXPECT_GT(accepted_of(seed, {200, 4, 9}, test::fuzz_view), 2);
  const Seed obj{
      "obj", "# lightmap: page.hdr (sRGB-encoded, white is 2.5 of it), page.hdr (linear)\n" + kObj};
  EXPECT_GT(accepted_of(obj, {500, 4, 10}, test::fuzz_reader), 20);
  EXPECT_GT(accepted_of(obj, {200, 4, 11}, test::fuzz_view), 2);
}

const std::string kCsv = R"(name,width,height
# sizes
a,3,4
"b ""x""",10,2 # the second
c #2,0,5
d,2147483647,1
)";

const std::string kJson = R"({"rects": [[1, 2], {"name": "a\u00e4", "w": 3, "h": 4},
{"width": 50, "height": 60}, [2147483647, 0]]})";

const std::string kLight = R"(1 2 3
# grey
.5

1e3 0 0
2
)";

constexpr Damage kOfLists{250, 3, 6};

TEST(DamagedLists, OfRectanglesArePackedOrRefused) {
  EXPECT_GT(accepted_of({"csv", kCsv}, kOfLists, test::fuzz_rects), 10);
  EXPECT_GT(accepted_of({"json", kJson}, kOfLists, test::fuzz_rects), 3);
}

TEST(DamagedLists, OfIlluminationAreReadOrRefused) {
  EXPECT_GT(accepted_of({"txt", kLight}, kOfLists, test::fuzz_illumination), 10);
  EXPECT_GT(accepted_of({"ply", kPly}, kOfLists, test::fuzz_illumination), 10);
}

// What fuzzers found in atlas-pack's lists: a number that no double holds.
TEST(DamagedLists, NumbersBeyondAllBoundsAreRefusedClearly) {
  const std::string text = "[[3, 2], [2147483648, 41e400]]";
  const test::FuzzResult result = test::fuzz_rects(Input(text.begin(), text.end()), "json");
  EXPECT_EQ(result.fault, "");
  EXPECT_FALSE(result.accepted);
}

// Images of 3 x 2 texels, uncompressed but for those that the library writes itself.
std::vector<Seed> images() {
  const test::TempFolder folder;
  Image8 bytes(3, 2, 4);
  std::iota(bytes.texels.begin(), bytes.texels.end(), std::uint8_t{70});
  ImageF floats(3, 2, 3);
  std::iota(floats.texels.begin(), floats.texels.end(), 0.5f);
  EXPECT_TRUE(write_png(folder.path() / "a.png", bytes, {}).ok());
  EXPECT_TRUE(write_exr(folder.path() / "a.exr", floats).ok());
  const std::string texels(3 * 2 * 3, '\x55'), row(3 * 3, '\x55'), none(4, '\0');
  using test::little;
  const std::string bmp = "BM" + little(78, 4) + none + little(54, 4) + little(40, 4) +
                          little(3, 4) + little(2, 4) + little(1, 2) + little(24, 2) + none +
                          little(24, 4) + std::string(16, '\0') + row + std::string(3, '\0') + row +
                          std::string(3, '\0');
  const std::string tga = std::string("\0\0\2\0\0\0\0\0\0\0\0\0", 12) + little(3, 2) +
                          little(2, 2) + std::string("\x18\0", 2) + texels;
  const std::string gif = "GIF89a" + little(1, 2) + little(1, 2) +
                          std::string("\x80\0\0\1\2\3\4\5\6,\0\0\0\0\1\0\1\0\0\2\2\x44\1\0;", 25);
  return {{"png", test::TempFolder::read(folder.path() / "a.png")},
          {"exr", test::TempFolder::read(folder.path() / "a.exr")},
          {"hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n" + std::string(24, '\x80')},
          {"bmp", bmp},
          {"tga", tga},
          {"gif", gif}};
}

TEST(DamagedImages, AreReadOrRefused) {
  const test::IgnoreLeaks readers;  // OpenImageIO never frees the texts of its errors
  for (const Seed& seed : images()) {
    const test::FuzzResult whole =
        test::fuzz_image(Input(seed.bytes.begin(), seed.bytes.end()), seed.extension);
    EXPECT_EQ(whole.fault, "") << seed.extension;
    EXPECT_TRUE(whole.accepted) << seed.extension;
    EXPECT_GT(accepted_of(seed, {200, 3, 6}, test::fuzz_image), 5) << seed.extension;
  }
}

TEST(DamagedImages, ArePackedOrRefused) {
  const test::IgnoreLeaks readers;  // OpenImageIO never frees the texts of its errors
  for (const Seed& seed : images()) {
    if (seed.extension == std::string("exr") || seed.extension == std::string("hdr")) continue;
    EXPECT_GT(accepted_of(seed, {100, 3, 6}, test::fuzz_sprites), 5) << seed.extension;
  }
}

TEST(MadeUpMeshes, AreUnwrapped) {
  std::mt19937 random(3);
  int accepted = 0;
  for (int round = 0; round < 100; ++round) {
    Input bytes(20 + random() % 500);
    for (std::uint8_t& b : bytes) b = std::uint8_t(random());
    const test::FuzzResult result = test::fuzz_unwrap(bytes);
    ASSERT_EQ(result.fault, "") << "round " << round;
    accepted += result.accepted;
  }
  EXPECT_GT(accepted, 50);
}

}  // namespace
}  // namespace atlas

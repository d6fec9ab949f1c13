// VRML97: the colours of vertices, which are taken as light.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "libatlas/core/srgb.h"
#include "tests/scene/vrml_maker.h"

namespace atlas {
namespace {

using test::Ids;
using test::read;
using test::scene_of;
using test::TempFolder;

// Two triangles that share an edge.
std::string square(const std::string& fields, const std::string& appearance = "") {
  return "Shape { " + appearance +
         "geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }\n"
         "coordIndex [ 0 1 2 -1 0 2 3 -1 ] " +
         fields + " } }\n";
}

// The red part of each corner's light, in units of a tenth.
std::vector<int> reds(const Scene& scene) {
  std::vector<int> result;
  for (const std::uint32_t v : scene.indices)
    result.push_back(scene.lit() ? int(scene.illumination[v].x * 10 + 0.5f) : -1);
  return result;
}
using Reds = std::vector<int>;

TEST(VrmlColours, ArePerVertexOrCorner) {
  const TempFolder folder;
  const auto of = [&](const std::string& fields) { return reds(scene_of(folder, square(fields))); };
  const std::string colours = "color Color { color [ 0.1 0 0, 0.2 0 0, 0.3 0 0, 0.4 0 0 ] }";
  EXPECT_EQ(of(""), Reds(6, -1));
  EXPECT_EQ(of(colours), (Reds{1, 2, 3, 1, 3, 4}));
  EXPECT_EQ(of(colours + " colorPerVertex TRUE"), (Reds{1, 2, 3, 1, 3, 4}));
  EXPECT_EQ(of(colours + " colorIndex [ 3 2 1 -1 3 1 0 -1 ]"), (Reds{4, 3, 2, 4, 2, 1}));
  EXPECT_EQ(of(colours + " colorIndex [ 0x3 0X2 1 -1 3 1 0 -1 ]"), (Reds{4, 3, 2, 4, 2, 1}));
  EXPECT_EQ(of("colorIndex [ 0 0 0 -1 1 1 1 -1 ] " + colours), (Reds{1, 1, 1, 2, 2, 2}));
}

// A point is divided only where its corners differ, and keeps its texture coordinates then.
TEST(VrmlColours, DividePointsOnlyWhereTheyDiffer) {
  const TempFolder folder;
  const std::string colours = "color Color { color [ 0.1 0 0, 0.1 0 0, 0.3 0 0 ] } ";
  const std::string uvs = "texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } ";
  const Scene same = scene_of(folder, square(colours + "colorIndex [ 0 1 0 -1 1 1 0 -1 ]"));
  EXPECT_EQ(same.positions.size(), 4u);
  const Scene scene = scene_of(folder, square(colours + uvs + "colorIndex [ 0 1 0 -1 2 0 2 -1 ]"));
  EXPECT_EQ(scene.positions.size(), 5u);
  EXPECT_EQ(scene.indices, (Ids{0, 1, 2, 4, 2, 3}));
  EXPECT_EQ(scene.texcoord_indices, (Ids{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(scene.positions[4].x, 0);
  EXPECT_EQ(reds(scene), (Reds{1, 1, 1, 3, 1, 3}));
}

// As the standard says, they take the place of the material's own colour.
TEST(VrmlColours, ReplaceTheMaterials) {
  const TempFolder folder;
  const std::string red = "appearance Appearance { material Material { diffuseColor 1 0 0 } } ";
  const std::string colours = "color Color { color [ 1 1 1, 1 1 1, 1 1 1, 1 1 1 ] }";
  const Scene scene = scene_of(folder, square(colours, red) + square("", red));
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].diffuse.y, 1);
  EXPECT_EQ(scene.materials[1].diffuse.y, 0);
}

TEST(VrmlColours, ThatAreMissingAreReported) {
  const TempFolder folder;
  const auto missing = [&](const std::string& nodes) {
    const auto loaded = read(folder, nodes);
    EXPECT_TRUE(loaded.ok());
    return loaded.ok() ? loaded->defects.count(DefectKind::illumination_missing) : 0;
  };
  const std::string two = "color Color { color [ 0.1 0 0, 0.2 0 0 ] }";
  EXPECT_EQ(missing(square("")), 0u);
  EXPECT_EQ(missing(square(two)), 2u);
  EXPECT_EQ(missing(square(two) + square("")), 6u);
  EXPECT_EQ(missing(square("") + square(two)), 6u);
  EXPECT_EQ(missing(square(two + "colorIndex [ 0 1 9 -1 0 -7 ]")), 2u);
}

TEST(VrmlColours, OfFacesBecomeThoseOfTheirCorners) {
  const TempFolder folder;
  const auto of = [&](const std::string& fields) {
    return reds(scene_of(folder, square("colorPerVertex FALSE " + fields)));
  };
  const std::string two = "color Color { color [ 0.1 0 0, 0.2 0 0 ] }";
  EXPECT_EQ(of(two), (Reds{1, 1, 1, 2, 2, 2}));
  EXPECT_EQ(of(two + " colorIndex [ 1 0 ]"), (Reds{2, 2, 2, 1, 1, 1}));
  EXPECT_EQ(of("colorIndex [ 1 1 ] " + two), (Reds{2, 2, 2, 2, 2, 2}));
  EXPECT_EQ(of("color Color { color 0.3 0 0 } colorIndex [ 0 0 ]"), (Reds{3, 3, 3, 3, 3, 3}));
  // Points keep their texture coordinates, and are divided only where faces differ.
  const Scene scene = scene_of(
      folder,
      square("colorPerVertex FALSE texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] "
             "} " +
             two));
  EXPECT_EQ(scene.indices, (Ids{0, 1, 2, 4, 5, 3}));
  EXPECT_EQ(scene.texcoord_indices, (Ids{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(
      scene_of(folder, square("colorPerVertex FALSE colorIndex [ 1 1 ] " + two)).positions.size(),
      4u);
}

// A face without a colour of its own has none of the others'.
TEST(VrmlColours, OfFacesThatAreMissingAreReported) {
  const TempFolder folder;
  const auto missing = [&](const std::string& fields) {
    const auto loaded = read(folder, square("colorPerVertex FALSE " + fields));
    EXPECT_TRUE(loaded.ok());
    return loaded.ok() ? loaded->defects.count(DefectKind::illumination_missing) : 0;
  };
  EXPECT_EQ(missing("color Color { color [ 0.1 0 0 ] }"), 3u);
  EXPECT_EQ(missing("color Color { color [ 0.1 0 0, 0.2 0 0 ] } colorIndex [ 0 -1 ]"), 3u);
  EXPECT_EQ(missing("color Color { color [ 0.1 0 0, 0.2 0 0 ] } colorIndex [ 7 7 ]"), 4u);
}

TEST(VrmlColours, MayBeEncoded) {
  const TempFolder folder;
  const auto path =
      folder.write("a.wrl", "#VRML V2.0 utf8\n" +
                                square("color Color { color [ 0.5 1 2, 0 0 0, 0 0 0, 0 0 0 ] }"));
  const auto loaded = read_scene(path, {.srgb_colours = true}, {});
  ASSERT_TRUE(loaded.ok());
  EXPECT_FLOAT_EQ(loaded->scene.illumination[0].x, srgb_decode(0.5f));
  EXPECT_EQ(loaded->scene.illumination[0].z, 2);
}

TEST(VrmlIntegers, MayBeHexadecimal) {
  const TempFolder folder;
  const auto corners = [&](const std::string& list) {
    const auto loaded =
        read(folder,
             "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 "
             "0, 0 1 0 ] } coordIndex [ " +
                 list + " ] } }");
    return loaded.ok() ? loaded->scene.indices : Ids{};
  };
  EXPECT_EQ(corners("0x0,0X1 +0x02 0xffffffff 0x0 2 3 -0x1"), (Ids{0, 1, 2, 0, 2, 3}));
  for (const char* wrong :
       {"0 1 0x -1", "0 1 0xg -1", "0 1 0x2g -1", "0 1 x2 -1", "0 1 0x1ffffffff"})
    EXPECT_EQ(corners(wrong), Ids{}) << wrong;
  EXPECT_EQ(test::places(folder, "Switch { whichChoice 0x1 choice [ " + test::shape(1) +
                                     test::shape(2) + "] }"),
            test::Places{2});
  EXPECT_EQ(test::places(folder,
                         "Shape { appearance Appearance { texture PixelTexture { image 1 "
                         "2 3 0xFF00FF 0x00FF00 } } " +
                             test::triangle(3) + "}"),
            test::Places{3});
}

}  // namespace
}  // namespace atlas

// VRML97: which nodes are read, and which shapes share a material.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "libatlas/core/clock.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/load_scene.h"
#include "tests/scene/sound.h"
#include "tests/scene/vrml_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Ids;
using test::load;
using test::painted;
using test::Places;
using test::places;
using test::read;
using test::scene_of;
using test::shape;
using test::TempFolder;

TEST(Vrml, ShapesOfEqualMaterialsShareOne) {
  const TempFolder folder;
  const Scene scene = scene_of(
      folder, painted(0, "Material { diffuseColor 1 0 0 shininess 0.5 }") +
                  painted(1, "Material { diffuseColor 0 1 0 transparency 0.25 }") +
                  painted(2, "Material { shininess 0.1 diffuseColor 1.0, 0, 0 transparency 0 }") +
                  painted(3, "Material { diffuseColor 0 1 0 }") +
                  painted(4, "Material { diffuseColor 0 1 0 emissiveColor 0 0 2 }") +
                  painted(5, "Material { transparency .25 diffuseColor 0 1 0 }") + shape(6) +
                  shape(7, "Appearance { }") + painted(8, "Material { }") + painted(9, "NULL") +
                  shape(10, "NULL"));
  EXPECT_EQ(scene.triangle_material, (Ids{0, 1, 0, 2, 3, 1, 4, 4, 5, 4, 4}));
  ASSERT_EQ(scene.materials.size(), 6u);
  EXPECT_EQ(scene.object_names.size(), 11u);
  EXPECT_EQ(scene.materials[0].diffuse, (Vec3f{1, 0, 0}));
  EXPECT_EQ(scene.materials[1].opacity, 0.75f);
  EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::blend);
  EXPECT_EQ(scene.materials[3].emission, (Vec3f{0, 0, 2}));
  EXPECT_EQ(scene.materials[4].diffuse, (Vec3f{1, 1, 1}));
  EXPECT_EQ(scene.materials[5].diffuse, (Vec3f{0.8f, 0.8f, 0.8f}));
}

// The first Viewpoint is the one that viewers bind.
TEST(Vrml, TellsWhereAViewerBegins) {
  const TempFolder folder;
  const auto view = [&](const std::string& nodes) { return read(folder, nodes + shape(0))->view; };
  EXPECT_FALSE(view(""));
  EXPECT_FALSE(view("Switch { choice Viewpoint { } }"));
  const auto usual = view("DEF v Viewpoint { description \"x\" }");
  ASSERT_TRUE(usual);
  EXPECT_EQ(usual->position, (Vec3d{0, 0, 10}));
  EXPECT_EQ(usual->direction, (Vec3d{0, 0, -1}));
  const auto placed = view(
      "WorldInfo { info [ \"origin 100 0 0: to be added\" ] }\n"
      "Transform { rotation 1 0 0 1.57079632679 scale 2 2 2 children Viewpoint {\n"
      "position 1 2 3 orientation 0 2 0 1.57079632679 fieldOfView 1 } }\n"
      "Viewpoint { position 7 7 7 }");
  ASSERT_TRUE(placed);
  EXPECT_NEAR(placed->position.x, 102, 1e-9);
  EXPECT_NEAR(placed->position.y, -6, 1e-9);
  EXPECT_NEAR(placed->position.z, 4, 1e-9);
  EXPECT_NEAR(placed->direction.x, -1, 1e-9);
}

TEST(Vrml, ListsFurtherViews) {
  const TempFolder folder;
  const auto loaded = read(folder,
                           "WorldInfo { info [ \"origin 100 0 0: to be added\" ] }\n"
                           "Viewpoint { description \"first\" }\n"
                           "Viewpoint { position 7 7 7 description \"by the door\" }\n"
                           "Viewpoint { orientation 0 1 0 1.57079632679 }\n" +
                               shape(0));
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->view->name, "first");
  ASSERT_EQ(loaded->further_views.size(), 2u);
  EXPECT_EQ(loaded->further_views[0].name, "by the door");
  EXPECT_EQ(loaded->further_views[0].position, (Vec3d{107, 7, 7}));
  EXPECT_EQ(loaded->further_views[1].name, "");
  EXPECT_NEAR(loaded->further_views[1].direction.x, -1, 1e-9);
}

// As in other formats, materials of different names are different ones.
TEST(Vrml, NamesTellMaterialsApart) {
  const TempFolder folder;
  const std::string red = "Material { diffuseColor 1 0 0 }",
                    blue = "Material { diffuseColor 0 0 1 }";
  const Scene scene = scene_of(
      folder, painted(0, "DEF a " + red) + painted(1, "DEF b " + red) + painted(2, "USE a") +
                  painted(3, "DEF a " + blue) + painted(4, "USE a") + painted(5, "DEF a " + red) +
                  shape(6, "DEF c Appearance { material " + red + " }") + shape(7, "USE c") +
                  shape(8, "DEF d Appearance { material USE b }") + painted(9, red));
  EXPECT_EQ(scene.triangle_material, (Ids{0, 1, 0, 2, 2, 0, 3, 3, 1, 4}));
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "b", "a", "c", "material4"}));
}

TEST(Vrml, TexturesAreSharedAsWell) {
  const TempFolder folder;
  folder.write("a.png", "no image");
  const auto textured = [](int x, const std::string& fields) {
    return shape(x, "Appearance { material Material { diffuseColor 1 0 0 } " + fields + " }");
  };
  const std::string a = "texture ImageTexture { url \"a.png\" }";
  auto loaded = load(folder.write(
      "t.wrl", "#VRML V2.0 utf8\n" + textured(0, a) +
                   textured(1, "texture ImageTexture { url [ \"a.png\" \"http://b/a.png\" ] }") +
                   textured(2, "texture ImageTexture { url \"a.png\" repeatS FALSE }") +
                   textured(3, a + " textureTransform TextureTransform { scale 2 2 }") +
                   textured(4, "texture DEF t ImageTexture { url \"b.png\" }") +
                   textured(5, "texture USE t") + textured(6, "texture ImageTexture { url [ ] }")));
  EXPECT_EQ(loaded.scene.triangle_material, (Ids{0, 0, 1, 2, 3, 3, 4}));
  EXPECT_EQ(loaded.defects.count(DefectKind::texture_unreadable), 1u) << "a.png is one texture";
  EXPECT_EQ(loaded.defects.count(DefectKind::texture_missing), 1u) << "b.png is one texture";
  EXPECT_EQ(loaded.scene.materials[0].diffuse, (Vec3f{1, 1, 1})) << "the texture replaces it";
  EXPECT_EQ(loaded.scene.materials[4].diffuse, (Vec3f{1, 0, 0}));
  EXPECT_EQ(loaded.scene.materials[0].name, "a.png");
}

TEST(Vrml, TexturesThatAreNoFilesLeaveThePlainColour) {
  const TempFolder folder;
  const auto loaded =
      read(folder, shape(0,
                         "Appearance { texture PixelTexture { image 1 1 3 0xff0000 } material "
                         "Material { diffuseColor 1 0 0 } }") +
                       shape(1, "Appearance { texture MovieTexture { url [ \"a.mpg\" ] } }"));
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(places(loaded->scene), (Places{0, 1}));
  EXPECT_EQ(loaded->scene.materials[0].diffuse, (Vec3f{1, 0, 0}));
  EXPECT_FALSE(loaded->scene.materials[1].unlit);
  ASSERT_EQ(loaded->defects.count(DefectKind::texture_unreadable), 2u);
  EXPECT_TRUE(loaded->defects.defects[0].first_places[0].ends_with("a.wrl:2: PixelTexture"));
}

// The box is 1 wide, 4 deep and 2 high: u runs along z, and v along y. Points that no face uses are
// not part of it.
TEST(Vrml, TexturesWithoutCoordinatesAreMappedByTheBox) {
  const TempFolder folder;
  const auto shape = [](const std::string& fields) {
    return "Shape { appearance Appearance { " + fields +
           " } geometry IndexedFaceSet { coord Coordinate { point [ 1 1 1, 2 3 1, 1 1 5, 9 9 9 ] } "
           "coordIndex [ 0 1 2 ] } }";
  };
  const Scene scene = scene_of(folder, shape("texture ImageTexture { url \"a.png\" }"));
  ASSERT_EQ(scene.texcoord_indices.size(), 3u);
  std::vector<Vec2f> uvs;
  for (const std::uint32_t i : scene.texcoord_indices) uvs.push_back(scene.texcoords[i]);
  EXPECT_EQ(uvs, (std::vector<Vec2f>{{0, 0}, {0, 0.5f}, {1, 0}}));
  EXPECT_TRUE(scene_of(folder, shape("")).texcoord_indices.empty());
}

// Urls are percent-encoded. Names that are not, although they have percent signs, are found, too.
// Of several urls, one is taken that is a file here.
TEST(Vrml, UrlsAreDecodedAndTried) {
  const TempFolder folder;
  folder.write("my a.png", "no image");
  folder.write("my%20b.png", "no image");
  for (const char* url :
       {R"("my%20a.png")", R"("my a.png")", R"("my%20b.png")", R"(["gone.png" "my a.png"])",
        R"(["http://a.org/my%20a.png", "gone.png", "my%20a.png"])"}) {
    const auto loaded = load(folder.write(
        "t.wrl", "#VRML V2.0 utf8\n" + shape(0, "Appearance { texture ImageTexture { url " +
                                                    std::string(url) + " } }")));
    EXPECT_EQ(loaded.defects.count(DefectKind::texture_missing), 0u) << url;
    EXPECT_EQ(loaded.defects.count(DefectKind::texture_unreadable), 1u) << url;
  }
}

// The values are those of the formula in the standard, worked out by hand.
TEST(Vrml, TextureTransformsMoveCoordinates) {
  const TempFolder folder;
  const auto moved = [&](const std::string& fields) {
    const Scene scene = scene_of(
        folder, "Shape { appearance Appearance { textureTransform TextureTransform { " + fields +
                    " } } geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 "
                    "0 0 1 0 ] } coordIndex [ 0 1 2 -1 ] texCoord TextureCoordinate { "
                    "point [ 3 4 0 0 1 0 ] } } }");
    const Vec2f uv = scene.texcoords[scene.texcoord_indices[0]];
    return std::pair(std::round(uv.x * 1e4f) / 1e4f, std::round(uv.y * 1e4f) / 1e4f);
  };
  EXPECT_EQ(moved(""), std::pair(3.f, 4.f));
  EXPECT_EQ(moved("translation 10 20"), std::pair(13.f, 24.f));
  EXPECT_EQ(moved("scale 2 3 translation 10 20"), std::pair(26.f, 72.f));
  EXPECT_EQ(moved("rotation 1.5707963"), std::pair(-4.f, 3.f));
  EXPECT_EQ(moved("rotation 1.5707963 scale 2 3"), std::pair(-8.f, 9.f));
  EXPECT_EQ(moved("center -1 -1 scale 2 2"), std::pair(5.f, 7.f));
}

TEST(Vrml, SwitchShowsTheChildThatIsChosen) {
  const TempFolder folder;
  const std::string children = "choice [ NULL DEF a " + shape(1) +
                               "USE a Group { children [ DEF b " + shape(2) + "] } " + shape(3) +
                               "]";
  const auto chosen = [&](const std::string& which) {
    return places(folder, "Switch { " + which + children + " } " + shape(9));
  };
  EXPECT_EQ(chosen("whichChoice 0 "), (Places{9}));
  EXPECT_EQ(chosen("whichChoice 1 "), (Places{1, 9}));
  EXPECT_EQ(chosen("whichChoice 2 "), (Places{1, 9}));
  EXPECT_EQ(chosen("whichChoice 3 "), (Places{2, 9}));
  EXPECT_EQ(chosen("whichChoice 4 "), (Places{3, 9}));
  EXPECT_EQ(chosen("whichChoice 5 "), (Places{9}));
  EXPECT_EQ(chosen("whichChoice -1 "), (Places{9}));
  EXPECT_EQ(chosen(""), (Places{9})) << "-1 is the default";
  EXPECT_EQ(places(folder, "Switch { choice " + shape(1) + "whichChoice 0 }"), (Places{1}));
  EXPECT_EQ(places(folder, "Switch { whichChoice -1 " + children + " } USE a USE b"),
            (Places{1, 2}))
      << "names inside are defined, whatever is shown";
}

TEST(Vrml, SwitchThatShowsNothingIsReported) {
  const TempFolder folder;
  const std::string hidden = "Group {\nchildren Switch { choice [ " + shape(1) + "] } }\n";
  const auto loaded = read(folder, hidden + shape(9) + "Switch { choice [ ] }");
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->defects.count(DefectKind::node_hidden), 1u);
  EXPECT_NE(loaded->defects.lines()[0].find("a.wrl:3: Switch with whichChoice -1"),
            std::string::npos)
      << loaded->defects.lines()[0];
  const auto none = read(folder, hidden);
  ASSERT_FALSE(none.ok());
  EXPECT_NE(none.status().message().find("1 Switch nodes (set their whichChoice)"),
            std::string::npos)
      << none.status().message();
}

TEST(Vrml, GroupsOfEveryKind) {
  const TempFolder folder;
  const std::string one = shape(1), two = shape(2);
  for (const std::string type : {"Group", "Anchor", "Billboard", "Collision", "Transform"})
    EXPECT_EQ(places(folder, type + " { children [ " + one + two + "] }"), (Places{1, 2})) << type;
  EXPECT_EQ(places(folder, "Collision { proxy " + one + "children " + two + "}"), (Places{2}));
  EXPECT_EQ(places(folder, "LOD { range [ 5 10 ] level [ " + one + two + "] }"), (Places{1}))
      << "the first level is the finest";
  EXPECT_EQ(places(folder, "LOD { level [ DEF a " + one + "DEF b " + two + "] } USE b"),
            (Places{1, 2}));
}

// Damaged nodes are refused or read, but never crash the reader.
TEST(Vrml, RandomDamageNeverCrashes) {
  const TempFolder folder;
  const std::string good =
      "DEF a " + shape(1, "DEF l Appearance { material DEF m Material { diffuseColor 1 0 0 } }") +
      "Switch { whichChoice 1 choice [ DEF b Group { children [ USE a NULL ] }\n" +
      shape(2, "USE l") + "] }\nLOD { level [ USE b " + painted(3, "USE m") +
      "] range [ 1 ] }\nTransform { children USE b translation 1 2 3 }\n" +
      shape(4,
            "Appearance { texture DEF t ImageTexture { url \"a.png\" } textureTransform "
            "TextureTransform { rotation 1 } }");
  std::mt19937 random(5);
  int read_well = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string bytes = good;
    const std::size_t at = random() % bytes.size(), from = random() % bytes.size();
    const std::size_t count = 1 + random() % 20;
    if (round % 3 == 0) bytes[at] = char(random());
    if (round % 3 == 1) bytes.erase(at, count);
    if (round % 3 == 2) bytes.replace(at, count, good.substr(from, count));
    const auto loaded = read(folder, bytes);
    if (!loaded.ok()) continue;
    ++read_well;
    ASSERT_TRUE(test::sound(loaded->scene)) << bytes;
  }
  EXPECT_GT(read_well, 300);
}

// What moves is read as it is at rest. Routes may stand wherever nodes and fields may.
TEST(Vrml, RoutesAreSkipped) {
  const TempFolder folder;
  const auto loaded =
      read(folder,
           "DEF clock TimeSensor { loop TRUE }\nDEF way PositionInterpolator { key [ 0 1 ] }\n"
           "DEF it Transform { translation 5 0 0\nROUTE way.value TO it.translation\nchildren [ " +
               shape(0) +
               "] }\nGroup { bboxSize 1 1 1 ROUTE clock.a TO way.b }\n"
               "ROUTE clock.fraction_changed TO way.set_fraction\n" +
               shape(2));
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(places(loaded->scene), (Places{5, 2}));
  EXPECT_EQ(loaded->defects.count(DefectKind::element_ignored), 1u);
}

TEST(Vrml, WhatIsNotReadIsNamedWithItsLine) {
  const TempFolder folder;
  const auto loaded = read(folder, shape(0) +
                                       "Inline { url \"b.wrl\" }\nShape { geometry\nBox { } }\n"
                                       "Shape { geometry NULL }\nPointLight { }");
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ASSERT_EQ(loaded->defects.lines().size(), 1u);
  const std::string line = loaded->defects.lines()[0];
  EXPECT_EQ(line.find("2 x elements ignored"), 0u) << line;
  EXPECT_NE(line.find("a.wrl:5: Inline"), std::string::npos) << line;
  EXPECT_NE(line.find("a.wrl:7: Box"), std::string::npos) << line;
}

TEST(Vrml, WorldWithoutFacesSaysWhy) {
  const TempFolder folder;
  const auto why = [&](const std::string& nodes) {
    const auto loaded = read(folder, nodes);
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input) << nodes;
    return loaded.status().message();
  };
  const std::string path = (folder / "a.wrl").string();
  EXPECT_EQ(why("Shape { geometry Sphere { } } Transform { children [ Inline { url \"b.wrl\" }\n"
                "Shape { geometry Box { } } Shape { geometry Box { } } ] }"),
            path +
                ": no triangle to work on: of what shows faces only IndexedFaceSet is read, not "
                "Box, Inline, Sphere (export the scene as a triangle mesh)");
  EXPECT_EQ(why("PROTO Chair [ field SFColor c 1 0 0 ] { Shape { geometry Box { } } } Chair { }"),
            path +
                ": no triangle to work on: PROTO is not supported, and it declares Chair (export "
                "the scene as a triangle mesh)");
  EXPECT_NE(why("EXTERNPROTO Lamp [ ] [ \"lamp.wrl\" ] DEF a Lamp { }").find("declares Lamp"),
            std::string::npos);
  const std::string both =
      why("Shape { geometry Text { string \"a\" } } Switch { choice [ " + shape(0) + " ] }");
  EXPECT_NE(both.find("not Text; it shows none of the children of 1 Switch"), std::string::npos)
      << both;
  EXPECT_NE(why("PointLight { }").find("it holds no face"), std::string::npos);
}

// The rest of a world is read, whatever is made by a PROTO.
TEST(Vrml, PrototypesAreLeftOut) {
  const TempFolder folder;
  const auto loaded = read(
      folder,
      "DEF a " + shape(1) + "PROTO P [ field SFNode n DEF a Group { } ] { DEF a " + shape(2) +
          " }\nGroup { EXTERNPROTO Q [ field MFNode m ] \"q.wrl#Q\" children [ PROTO R [ ] { Group "
          "{ } }\n" +
          "P { n USE a } R { } USE a ] PROTO S [ ] { Material { } } }\n" +
          shape(3, "Appearance { material S { } texture S { } }") + shape(4, "S { a 1 b [ 2 ] }"));
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(places(loaded->scene), (Places{1, 1, 3, 4}));
  EXPECT_EQ(loaded->defects.count(DefectKind::element_ignored), 5u);
}

// A list of one value may do without its brackets.
TEST(Vrml, SingleValuesNeedNoBrackets) {
  const TempFolder folder;
  const std::string rest = " coordIndex [ 0 0 0 -1 ] } }\n";
  const std::string point = "Shape { geometry IndexedFaceSet { coord Coordinate { point 7 0 0 } ";
  EXPECT_EQ(places(folder, shape(1) + point + rest), (Places{1, 7}));
  EXPECT_EQ(places(folder, shape(1) + point +
                               "texCoord TextureCoordinate { point 0.5 0.25 } "
                               "texCoordIndex 0 colorIndex 0 color Color { color\n"
                               "1 0 0.5 }" +
                               rest),
            (Places{1, 7}));
  EXPECT_EQ(places(folder, point + "coordIndex 0 } }" + shape(2)), (Places{2}));
  const auto far = read(folder, "WorldInfo { info \"origin 5 0 0: x\" } " + shape(1));
  ASSERT_TRUE(far.ok());
  EXPECT_EQ(places(far->scene), Places{6});
  const auto wrong =
      read(folder, "Shape { geometry IndexedFaceSet { coord Coordinate { point 1 2 }");
  EXPECT_NE(wrong.status().message().find("'}' is not a number"), std::string::npos)
      << wrong.status().message();
}

// A list that is cut short ends the reading, wherever it is.
TEST(Vrml, ListsWithoutAnEndAreRefused) {
  const TempFolder folder;
  for (const char* nodes :
       {"Inline { url [ \"a.wrl\"", "EXTERNPROTO A [ ] [ \"a.wrl\"", "WorldInfo { info [ \"a\"",
        "Shape { appearance Appearance { texture MovieTexture { url [ \"a.mpg\""}) {
    const auto loaded = read(folder, nodes);
    EXPECT_NE(loaded.status().message().find("ends inside a list"), std::string::npos) << nodes;
  }
}

}  // namespace
}  // namespace atlas

// VRML97: where shapes are, which of their values are used, and what is malformed.
#include <gtest/gtest.h>

#include <cmath>

#include "libatlas/scene/reader.h"
#include "tests/scene/vrml_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Ids;
using test::painted;
using test::Places;
using test::places;
using test::read;
using test::scene_of;
using test::shape;
using test::TempFolder;

// A face of `ccw FALSE` is seen from the side from which its corners run clockwise.
TEST(Vrml, FacesMayRunClockwise) {
  const TempFolder folder;
  const auto order = [&](const std::string& field, const std::string& scale) {
    return scene_of(folder, "Transform { scale " + scale +
                                " children Shape { geometry IndexedFaceSet { " + field +
                                "coord Coordinate { point [ 0 0 0 0 1 0 0 0 1 ] } "
                                "coordIndex [ 0 1 2 -1 ] } } }")
        .indices;
  };
  EXPECT_EQ(order("", "1 1 1"), (Ids{0, 1, 2}));
  EXPECT_EQ(order("ccw TRUE ", "1 1 1"), (Ids{0, 1, 2}));
  EXPECT_EQ(order("ccw FALSE ", "1 1 1"), (Ids{2, 1, 0}));
  EXPECT_EQ(order("ccw FALSE ", "1 -1 1"), (Ids{0, 1, 2})) << "mirrored, too";
}

// A face set that says that it is solid is seen from its front only. Many files leave the default
// where they mean the other, so what they do not say is read as double-sided.
TEST(Vrml, SolidFacesAreNotDoubleSided) {
  const TempFolder folder;
  const auto faces = [](const std::string& field) {
    return "Shape { geometry IndexedFaceSet { " + field +
           "coord Coordinate { point [ 0 0 0 0 1 0 0 0 1 ] } coordIndex [ 0 1 2 -1 ] } }\n";
  };
  const Scene scene = scene_of(
      folder, faces("solid TRUE ") + faces("solid FALSE ") + faces("") + faces("solid TRUE "));
  ASSERT_EQ(scene.triangle_count(), 4u);
  std::vector<bool> double_sided;
  for (const std::uint32_t m : scene.triangle_material)
    double_sided.push_back(scene.materials[m].double_sided);
  EXPECT_EQ(double_sided, (std::vector<bool>{false, true, true, false}));
  EXPECT_EQ(scene.materials.size(), 2u);
}

// As the standard says, a shape without a Material is unlit. What shows no texture either, as files
// that leave out all appearance, is taken for an ordinary surface.
TEST(Vrml, TexturesWithoutAMaterialAreUnlit) {
  const TempFolder folder;
  const auto shape = [](const std::string& fields) {
    return "Shape { appearance Appearance { " + fields +
           " } geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 0 1 0 0 0 1 ] } "
           "coordIndex [ 0 1 2 -1 ] } }\n";
  };
  const std::string texture = "texture ImageTexture { url \"a.png\" } ";
  const Scene scene = scene_of(folder, shape(texture) + shape(texture + "material Material { }") +
                                           shape("") + shape("material Material { } " + texture));
  std::vector<bool> unlit;
  for (const std::uint32_t m : scene.triangle_material) unlit.push_back(scene.materials[m].unlit);
  EXPECT_EQ(unlit, (std::vector<bool>{true, false, false, false}));
}

// The corner (3, 0, 0) seen from the centre is (2, 0, 0); scaled it is (4, 0, 0), turned (0, 4, 0),
// seen from 0 again (1, 4, 0), and moved (11, 4, 0).
TEST(Vrml, TransformsScaleTurnAndMoveInThisOrder) {
  const TempFolder folder;
  const auto first = [&](const std::string& transform) {
    const Scene scene = scene_of(folder, transform);
    const Vec3f p = scene.positions[scene.indices[0]];
    const auto rounded = [](double v) { return std::round(v * 1e5) / 1e5; };
    return Vec3d{rounded(scene.origin.x + p.x), rounded(scene.origin.y + p.y),
                 rounded(scene.origin.z + p.z)};
  };
  EXPECT_EQ(first("Transform { translation 10 0 0 center 1 0 0 rotation 0 0 2 1.57079632679 "
                  "scale 2 1 1 children " +
                  shape(3) + "}"),
            (Vec3d{11, 4, 0}));
  EXPECT_EQ(first("Transform { translation 5 0 0 children Transform { scale 2 3 4 children " +
                  shape(1) + "} }"),
            (Vec3d{7, 0, 0}))
      << "the inner one comes first";
  EXPECT_EQ(first("Transform { scale 1 2 1 scaleOrientation 0 0 1 1.57079632679 children " +
                  shape(3) + "}"),
            (Vec3d{6, 0, 0}))
      << "the axes of the scale are turned, the shape is not";
  EXPECT_EQ(first("Transform { rotation 1 0 0 1.57079632679 scale 1 2 1 "
                  "scaleOrientation 0 0 1 1.57079632679 children " +
                  shape(3) + "}"),
            (Vec3d{6, 0, 0}))
      << "the rotation comes after the scale and its axes";
}

// A mirrored face has its corners, and what belongs to them, in the opposite order.
TEST(Vrml, MirroredFacesAreTurnedWithTheirTexcoords) {
  const TempFolder folder;
  const Scene scene = scene_of(
      folder,
      "Transform { scale 1 1 -1 children Shape { geometry IndexedFaceSet { coord Coordinate { "
      "point [ 0 0 1 1 0 2 0 1 3 ] } texCoord TextureCoordinate { point [ 0 .25 0 .5 0 .75 ] } "
      "coordIndex [ 0 1 2 -1 ] texCoordIndex [ 2 1 0 -1 ] } } }");
  EXPECT_EQ(scene.indices, (Ids{2, 1, 0}));
  EXPECT_EQ(scene.positions[2], (Vec3f{0, 1, -3}));
  EXPECT_EQ(scene.texcoords[scene.texcoord_indices[0]], (Vec2f{0, .25f}));
  EXPECT_EQ(scene.texcoords[scene.texcoord_indices[2]], (Vec2f{0, .75f}));
}

TEST(Vrml, IndicesStayInTheirOwnShape) {
  const TempFolder folder;
  const std::string faces =
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 0 1 0, 0 0 1 ] } "
      "coordIndex [ 0 1 2 -1 -1 0 1 3 -1 ] } }\n";
  const auto loaded = read(folder, faces + shape(7));
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(places(loaded->scene), (Places{0, 7}));
  ASSERT_EQ(loaded->defects.lines().size(), 1u);
  EXPECT_EQ(loaded->defects.count(DefectKind::index_out_of_range), 1u);
  EXPECT_TRUE(loaded->defects.defects[0].first_places[0].ends_with("a.wrl: shape 0 face 1"))
      << loaded->defects.defects[0].first_places[0];
  // Two texture coordinates for three corners, and no index of the third.
  const auto textured =
      read(folder,
           "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 0 1 0 0 0 1 ] } "
           "texCoord TextureCoordinate { point [ 0 0 1 1 ] } coordIndex [ 0 1 2 -1 0 2 1 ] "
           "texCoordIndex [ 0 1 0 -1 1 0 ] } }");
  ASSERT_TRUE(textured.ok()) << textured.status().message();
  EXPECT_EQ(textured->scene.texcoord_indices,
            (Ids{0, 1, 0, Scene::kNoTexcoord, Scene::kNoTexcoord, Scene::kNoTexcoord}));
  EXPECT_EQ(textured->defects.count(DefectKind::texcoord_out_of_range), 1u);
}

// Only the exporter's own note, which a colon ends, moves the scene.
TEST(Vrml, NotedOriginsMoveTheScene) {
  const TempFolder folder;
  const auto x = [&](const std::string& info) {
    const Scene scene = scene_of(folder, shape(1) + "WorldInfo { info " + info + " }");
    return scene.origin.x + double(scene.positions[0].x);
  };
  EXPECT_EQ(x("[ \"by hand\" \"origin 2000000.25 0 0: to be added to every coordinate\" ]"),
            2000001.25);
  EXPECT_EQ(x("[ \"origin 2000000.25 0 0 of the survey\" ]"), 1);
  EXPECT_EQ(x("[ \"origin unknown:\" ]"), 1);
  EXPECT_EQ(x("\"origin 5 0 0: the only value needs no brackets\""), 6);
}

TEST(Vrml, TransformsOfTexturesTellMaterialsApart) {
  const TempFolder folder;
  const auto scaled = [](int x, const char* scale) {
    return shape(
        x, std::string("Appearance { textureTransform TextureTransform { scale ") + scale + " } }");
  };
  const Scene scene =
      scene_of(folder, scaled(0, "1 1") + scaled(1, "2 1") + scaled(2, "1 2") + scaled(3, "2 1"));
  EXPECT_EQ(scene.triangle_material, (Ids{0, 1, 2, 1}));
}

TEST(Vrml, MaterialsOutOfTheirRange) {
  const TempFolder folder;
  const auto loaded =
      read(folder, painted(0, "Material { diffuseColor 2 0 0 emissiveColor -1 0.5 1e39 }") +
                       painted(1, "Material { transparency 3 }") +
                       painted(2, "Material { transparency -3 }") +
                       painted(3, "Material { emissiveColor 1 0 0 }") +
                       painted(4, "Material { emissiveColor 0 1 0 }"));
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const std::vector<Material>& m = loaded->scene.materials;
  ASSERT_EQ(m.size(), 5u);
  EXPECT_EQ(m[0].diffuse, (Vec3f{2, 0, 0}));
  EXPECT_EQ(m[0].emission, (Vec3f{0, 0.5f, 1e36f}));
  EXPECT_EQ(m[1].opacity, 0);
  EXPECT_EQ(m[2].opacity, 1);
  EXPECT_EQ(m[2].alpha_mode, AlphaMode::opaque);
  ASSERT_EQ(loaded->defects.count(DefectKind::reflectance_beyond_one), 1u);
  EXPECT_TRUE(loaded->defects.defects[0].first_places[0].ends_with("a.wrl: material 'material0'"))
      << loaded->defects.defects[0].first_places[0];
}

TEST(Vrml, TexturesOutsideTheirSquare) {
  const TempFolder folder;
  const Scene scene = scene_of(
      folder, shape(0, "DEF outer Appearance { material DEF inner Material { } }") +
                  shape(1, "Appearance { texture ImageTexture { url \"\" repeatT FALSE } }") +
                  shape(2, "Appearance { texture ImageTexture { url \"a\\\"b.png\" } }"));
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.materials[0].name, "inner");
  EXPECT_EQ(scene.materials[1].wrap_u, TextureWrap::repeat);
  EXPECT_EQ(scene.materials[1].wrap_v, TextureWrap::clamp);
  EXPECT_EQ(scene.materials[1].name, "material1");
}

// Names of what is skipped may look like fields.
TEST(Vrml, FieldsThatAreNotReadAreSkippedWhole) {
  const TempFolder folder;
  EXPECT_EQ(places(folder,
                   "Group { addition DEF a Extra { sub [ 1 2 { } ] } other USE a "
                   "children " +
                       shape(1) + "}" + shape(2)),
            (Places{1, 2}));
  EXPECT_EQ(places(folder, "Group { children " + shape(1) + "other USE children }"), (Places{1}));
}

TEST(Vrml, WhatIsMalformedIsNamed) {
  const TempFolder folder;
  const auto says = [&](const std::string& nodes, const std::string& wanted) {
    const auto loaded = read(folder, nodes);
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input) << nodes;
    EXPECT_NE(loaded.status().message().find(wanted), std::string::npos)
        << loaded.status().message();
  };
  says(shape(0, "Appearance { texture Material { } }"), "a.wrl:2: an ImageTexture expected");
  says(shape(0, "Material { }"), "an Appearance expected");
  says(shape(0, "Appearance { texture ImageTexture { url [ a.png ] } }"), "a url in quotes");
  says(painted(0, "Material { diffuseColor inf 0 0 }"), "a finite number expected");
  says("Transform { translation 1 2\n3x }", "a number expected");
  says("Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 ] } } }",
       "a list of rows of 3 with an odd end");
  says("Shape { geometry IndexedFaceSet { coordIndex [ 0 1\nx ] } }",
       "a.wrl:3: 'x' is not a number");
  says("Shape { geometry IndexedFaceSet { coordIndex [ 0 1 2x ] } }", "'2x' is not a number");
  says("Group { children \"open\n", "a string without an end");
  says("Group {\nchildren", "the file ends inside a node");
  says("Group { children Box {", "the file ends inside a node");
  says("PROTO a [ ] { }", "PROTO is not supported");
  says("group { }", "'group' where a node should be");
}

}  // namespace
}  // namespace atlas

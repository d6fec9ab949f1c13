// Materials of glTF files: textures with their transforms and wrap modes, and colours of
// extensions.
#include <gtest/gtest.h>

#include <cmath>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Gltf;
using test::json;
using test::kSquare;
using test::load_glb;
using test::TempFolder;

void add_triangle_of_each_material(Gltf& g, const json& attributes) {
  json primitives;
  for (std::size_t m = 0; m < g.j["materials"].size(); ++m)
    primitives.push_back({{"attributes", attributes},
                          {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
                          {"material", m}});
  g.single(primitives[0]);
  g.j["meshes"][0]["primitives"] = primitives;
}

TEST(Gltf, TexturesMayNameASetAndATurn) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int zero = g.floats(std::vector<float>(8, 0), "VEC2", 2);
  const int one = g.floats({1, 1, 2, 1, 2, 2, 1, 2}, "VEC2", 2);
  const int two = g.floats({3, 1, 4, 1, 4, 2, 3, 2}, "VEC2", 2);
  const json attributes = {
      {"POSITION", positions}, {"TEXCOORD_0", zero}, {"TEXCOORD_1", one}, {"TEXCOORD_2", two}};
  g.j["images"] = {{{"uri", "a.png"}}};
  g.j["textures"] = {{{"source", 0}}};
  for (int m = 0; m < 2; ++m) {
    json info = {{"index", 0}, {"texCoord", 1}};
    if (m == 1) info["extensions"]["KHR_texture_transform"] = {{"texCoord", 2}, {"rotation", 0.5}};
    g.j["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
  }
  add_triangle_of_each_material(g, attributes);
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.texcoords[s.texcoord_indices[1]], (Vec2f{2, 0}));
  // The rotation is counterclockwise where v points down: (4, 1) becomes (4 c + s, -4 s + c).
  const double c = std::cos(0.5), sine = std::sin(0.5);
  const Vec2f turned = s.texcoords[s.texcoord_indices[4]];
  EXPECT_NEAR(turned.x, 4 * c + sine, 1e-6);
  EXPECT_NEAR(turned.y, 1 - (-4 * sine + c), 1e-6);
  EXPECT_TRUE(loaded->defects.empty());
}

// The coordinates are first scaled, then rotated, then moved, as in Blender's importer.
TEST(Gltf, TexturesAreScaledTurnedAndMoved) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  Gltf g;
  const json attributes = {{"POSITION", g.floats(kSquare, "VEC3", 3)},
                           {"TEXCOORD_0", g.floats({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2", 2)}};
  g.j["images"] = {{{"uri", "a.png"}}};
  g.j["textures"] = {{{"source", 0}, {"sampler", 0}}};
  g.j["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  json info = {{"index", 0}};
  info["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.25, 0.5}}, {"rotation", std::acos(0.0)}, {"scale", {2, 3}}};
  g.j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", info}}}}};
  g.single({{"attributes", attributes},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
            {"material", 0}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.materials[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(s.materials[0].wrap_v, TextureWrap::mirror);
  // A quarter turn takes (u, v) to (v, -u), with v pointing down.
  const Vec2f expected[] = {{0.25f, 0.5f}, {0.25f, 2.5f}, {3.25f, 0.5f}};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(s.texcoords[s.texcoord_indices[k]].x, expected[k].x, 1e-6) << k;
    EXPECT_NEAR(s.texcoords[s.texcoord_indices[k]].y, expected[k].y, 1e-6) << k;
  }
}

TEST(Gltf, EmissionAndReflectancesBeyondOne) {
  const TempFolder folder;
  Gltf g;
  g.j["materials"] = {{{"name", "lamp"}, {"emissiveFactor", {1, 0.5, 0}}},
                      {{"name", "bright"}, {"pbrMetallicRoughness", json::object()}}};
  g.j["materials"][0]["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", 4}};
  g.j["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = {2, 1, 1, 1};
  const json attributes = {{"POSITION", g.floats(kSquare, "VEC3", 3)}};
  add_triangle_of_each_material(g, attributes);
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.materials[0].emission, (Vec3f{4, 2, 0}));
  EXPECT_EQ(loaded->scene.materials[1].emission, Vec3f{});
  EXPECT_EQ(loaded->scene.materials[1].diffuse, (Vec3f{2, 1, 1}));
  ASSERT_EQ(loaded->defects.count(DefectKind::reflectance_beyond_one), 1u);
  EXPECT_TRUE(loaded->defects.defects[0].first_places[0].ends_with(": material 'bright'"));
}

// JSON's numbers can exceed the range of float, and so can coordinates that a texture's scale
// moves.
TEST(Gltf, NumbersBeyondFloatLeaveFiniteMaterialsAndCoordinates) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  Gltf g;
  const json attributes = {{"POSITION", g.floats(kSquare, "VEC3", 3)},
                           {"TEXCOORD_0", g.floats({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2", 2)}};
  g.j["images"] = {{{"uri", "a.png"}}};
  g.j["textures"] = {{{"source", 0}}};
  json info = {{"index", 0}};
  info["extensions"]["KHR_texture_transform"] = {{"scale", {1e39, 1}}};
  g.j["materials"] = {{{"pbrMetallicRoughness",
                        {{"baseColorTexture", info}, {"baseColorFactor", {1e39, 1, 1, 1}}}}},
                      {{"name", "glossy"}}};
  g.j["materials"][1]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseFactor", {-1e39, 1, 1, 1}}};
  add_triangle_of_each_material(g, attributes);
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(check_scene(loaded->scene).message(), "");
  EXPECT_EQ(loaded->defects.count(DefectKind::texcoord_not_finite), 1u);
  EXPECT_EQ(loaded->defects.count(DefectKind::reflectance_beyond_one), 2u);
}

TEST(Gltf, TexturesWithoutAnImageThatIsReadAreTold) {
  const TempFolder folder;
  Gltf g;
  g.j["images"] = {{{"uri", "a.ktx2"}, {"mimeType", "image/ktx2"}}};
  g.j["textures"] = json::array({json::object()});
  g.j["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 0;
  g.j["extensionsUsed"] = {"KHR_texture_basisu"};
  g.j["materials"] = {
      {{"name", "bark"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
            {"material", 0}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->defects.count(DefectKind::texture_unreadable), 1u);
  EXPECT_NE(loaded->defects.lines().front().find("bark"), std::string::npos);
}

// What shapes are made of is read all the same.
TEST(Gltf, MaterialsAreUnlitIfTheySaySo) {
  const TempFolder folder;
  Gltf g;
  g.j["extensionsUsed"] = {"KHR_materials_unlit"};
  g.j["materials"] = {{{"name", "lit"}}, {{"name", "unlit"}}};
  g.j["materials"][1]["extensions"]["KHR_materials_unlit"] = json::object();
  add_triangle_of_each_material(g, {{"POSITION", g.floats(kSquare, "VEC3", 3)}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ASSERT_EQ(loaded->scene.materials.size(), 2u);
  EXPECT_FALSE(loaded->scene.materials[0].unlit);
  EXPECT_TRUE(loaded->scene.materials[1].unlit);
}

TEST(Gltf, ShadersOfMaterialsAreNamed) {
  const TempFolder folder;
  for (const char* extension : {"KHR_techniques_webgl", "KHR_technique_webgl"}) {
    Gltf g;
    g.j["extensionsUsed"] = g.j["extensionsRequired"] = {extension};
    g.j["materials"] = {{{"name", "bark"}, {"extensions", {{extension, {{"technique", 0}}}}}}};
    g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
              {"material", 0}});
    const auto loaded = load_glb(folder, g);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.triangle_count(), 1u);
    EXPECT_EQ(loaded->scene.materials[0].diffuse, (Vec3f{1, 1, 1}));
    ASSERT_EQ(loaded->defects.lines().size(), 1u);
    const std::string line = loaded->defects.lines()[0];
    EXPECT_NE(line.find(std::string("'bark' (") + extension + ")"), std::string::npos) << line;
  }
}

TEST(Gltf, FormatsOfTexturesAreOnlyRequiredWhereTexturesAreRead) {
  const TempFolder folder;
  const auto read = [&](const char* extension, bool textures, bool rest) {
    Gltf g;
    g.j["images"] = {{{"uri", "a.ktx2"}, {"mimeType", "image/ktx2"}}};
    g.j["textures"] = json::array({json::object()});
    g.j["textures"][0]["extensions"][extension]["source"] = 0;
    g.j["extensionsUsed"] = g.j["extensionsRequired"] = {extension, "KHR_texture_transform"};
    g.j["materials"] = {
        {{"name", "bark"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
              {"material", 0}});
    ReadOptions options;
    options.load_textures = textures;
    options.rest = rest;
    return read_scene(folder.write("a.glb", g.glb()), options, {});
  };
  for (const char* extension : {"KHR_texture_basisu", "KHR_texture_ktx", "MSFT_texture_dds"}) {
    const auto plain = read(extension, false, false);
    ASSERT_TRUE(plain.ok()) << plain.status().message();
    EXPECT_EQ(plain->scene.materials[0].texture, -1);
    ASSERT_EQ(plain->defects.lines().size(), 1u);
    const std::string line = plain->defects.lines()[0];
    EXPECT_NE(line.find(std::string("'bark'")), std::string::npos) << line;
    EXPECT_NE(line.find(extension), std::string::npos) << line;
    const auto full = read(extension, true, false);
    ASSERT_FALSE(full.ok());
    EXPECT_EQ(full.status().code(), ErrorCode::unsupported);
    EXPECT_NE(full.status().message().find(extension), std::string::npos);
    // A scene that is kept passes them on.
    EXPECT_TRUE(read(extension, true, true).ok());
    EXPECT_TRUE(read(extension, false, true).ok());
  }
  EXPECT_FALSE(read("MAGNUMX_mesh_views", false, false).ok()) << "this one changes shapes";
}

TEST(Gltf, MaterialsThatDoNotExistAreTold) {
  const TempFolder folder;
  Gltf g;
  g.j["materials"] = {{{"name", "bark"}}};
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
            {"material", 3}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->defects.count(DefectKind::material_unknown), 1u);
  EXPECT_NE(loaded->defects.lines().front().find("mesh 0 primitive 0: material 3 of 1"),
            std::string::npos);
}

// An older model of shading, and an image in a format that glTF itself does not have.
TEST(Gltf, DiffuseColoursOfExtensions) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  g.j["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness", "EXT_texture_webp"};
  g.j["images"] = {{{"uri", "a.png"}}};
  g.j["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  const json info = {{"index", 0},
                     {"extensions", {{"KHR_texture_transform", {{"scale", {2, 1}}}}}}};
  g.j["materials"] = {{{"extensions",
                        {{"KHR_materials_pbrSpecularGlossiness",
                          {{"diffuseFactor", {0.5, 0.25, 1, 1}}, {"diffuseTexture", info}}}}}}};
  g.single({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
            {"material", 0}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.materials[0].diffuse, (Vec3f{0.5f, 0.25f, 1}));
  EXPECT_EQ(s.materials[0].texture, 0);
  EXPECT_EQ(s.textures.size(), 1u);
  EXPECT_EQ(s.texcoords[s.texcoord_indices[1]], (Vec2f{2, 1}));
}

TEST(Gltf, ValuesOfMaterialsStayInTheirRanges) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  Gltf g;
  g.j["images"] = {{{"uri", "a.png"}}};
  g.j["textures"] = {{{"source", 0}}};
  g.j["materials"] = {{{"alphaMode", "MASK"}, {"alphaCutoff", -1}},
                      {{"alphaMode", "MASK"}, {"alphaCutoff", 1e30}},
                      {{"emissiveFactor", {-1, 0.5, 1e39}}, {"emissiveTexture", {{"index", 0}}}},
                      {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 7}}}}},
                      json::object()};
  g.j["materials"][4]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseFactor", {0.5, 0.5, 0.25, 0.75}}};
  add_triangle_of_each_material(g, {{"POSITION", g.floats(kSquare, "VEC3", 3)}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(check_scene(loaded->scene).message(), "");
  const std::vector<Material>& m = loaded->scene.materials;
  EXPECT_EQ(m[0].name, "material0");
  EXPECT_EQ(m[0].alpha_cutoff, 0);
  EXPECT_EQ(m[1].alpha_cutoff, 1e6f);
  EXPECT_EQ(m[2].emission, (Vec3f{0, 0.5f, 1e36f}));
  EXPECT_TRUE(m[2].emission_textured);
  EXPECT_EQ(m[3].opacity, 1);
  EXPECT_EQ(m[4].opacity, 0.75f);
  EXPECT_FALSE(m[4].emission_textured);
}

// Numbers of textures, images and samplers that do not exist leave the colour.
TEST(Gltf, TexturesThatDoNotExistAreTold) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  Gltf g;
  g.j["images"] = {{{"uri", "a.png"}}};
  g.j["textures"] = {{{"source", 1}}, {{"source", 0}, {"sampler", 1}}};
  g.j["textures"][1]["extensions"]["EXT_texture_webp"]["source"] = 7;
  g.j["samplers"] = {{{"wrapS", 33071}}};
  for (const int texture : {0, 2, 1})
    g.j["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
  add_triangle_of_each_material(g, {{"POSITION", g.floats(kSquare, "VEC3", 3)}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->defects.count(DefectKind::texture_unreadable), 2u);
  const std::vector<Material>& m = loaded->scene.materials;
  EXPECT_EQ(m[0].texture, -1);
  EXPECT_EQ(m[1].texture, -1);
  EXPECT_EQ(m[2].texture, 0);
  EXPECT_EQ(m[2].wrap_u, TextureWrap::repeat);
}

// A percent sign that two hexadecimal digits do not follow is one of the name.
TEST(Gltf, NamesOfImagesArePercentEncoded) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  const auto found = [&](const std::string& uri, const std::string& name) {
    folder.write(name, TempFolder::read(folder / "a.png"));
    Gltf g;
    g.j["images"] = {{{"uri", uri}}};
    g.j["textures"] = {{{"source", 0}}};
    g.j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    add_triangle_of_each_material(g, {{"POSITION", g.floats(kSquare, "VEC3", 3)}});
    const auto loaded = load_glb(folder, g);
    return loaded.ok() && loaded->defects.empty() && loaded->scene.textures.size() == 1 &&
           loaded->scene.textures[0].path.filename() == name;
  };
  EXPECT_TRUE(found("a%2Bb%c3%a9.png", "a+b\xc3\xa9.png"));
  EXPECT_TRUE(found("end%31", "end1"));
  EXPECT_TRUE(found("100%.png", "100%.png"));
  EXPECT_TRUE(found("100%4", "100%4"));
  EXPECT_TRUE(found("100%-1.png", "100%-1.png"));
}

TEST(Gltf, WhatIsNotReadIsCounted) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  g.j["images"] = {{{"uri", "gone.png"}}};
  g.j["textures"] = {{{"source", 0}}};
  g.j["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  g.j["materials"] = {{{"pbrMetallicRoughness", {{"roughnessFactor", 0.5}}}},
                      {{"pbrMetallicRoughness", {{"metallicFactor", 0}}}},
                      {{"extensions", {{"KHR_materials_unlit", json::object()}}}},
                      {{"normalTexture", {{"index", 0}}}},
                      {{"emissiveTexture", {{"index", 0}}}}};
  add_triangle_of_each_material(
      g, {{"POSITION", positions}, {"TEXCOORD_0", uvs}, {"TEXCOORD_1", uvs}});
  g.j["nodes"][0]["scale"] = {1, 1, 2};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.not_read,
            (LossCounts{{"cameras", 1},
                        {"materials of more than a base colour", 3},
                        {"nodes with transforms or children, applied to what they show", 1},
                        {"primitives with uvs in several sets", 5},
                        {"textures of materials", 2}}));
}

TEST(Gltf, TexturesMayBeLeftOutWhereThereIsNoLight) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  for (const bool lit : {false, true}) {
    Gltf g;
    const int positions = g.floats(kSquare, "VEC3", 3);
    json attributes = {{"POSITION", positions},
                       {"TEXCOORD_0", g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2)}};
    if (lit) attributes["COLOR_0"] = positions;
    const std::string png = TempFolder::read(folder / "a.png");
    const int view = g.view(std::vector<char>(png.begin(), png.end()));
    g.j["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    g.j["textures"] = {{{"source", 0}}};
    g.j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    g.single({{"attributes", attributes},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
              {"material", 0}});
    const auto path = folder.write("a.glb", g.glb());
    ReadOptions options;
    options.unlit_textures = false;
    const auto loaded = read_scene(path, options, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.textures.size(), lit ? 1u : 0u);
    EXPECT_EQ(loaded->scene.materials[0].texture, lit ? 0 : -1);
    options.load_textures = false;
    EXPECT_TRUE(read_scene(path, options, {})->scene.textures.empty());
  }
}

}  // namespace
}  // namespace atlas

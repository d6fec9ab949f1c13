#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "libatlas/core/clock.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/load_scene.h"
#include "tests/support/slowness.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::load;
using test::TempFolder;

constexpr char kTexturedTriangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 2\nusemtl a\nf 1/1 2/1 3/1\n";

TEST(Mtl, TexturesThatAreMissingOrBrokenFallBackToTheColour) {
  const TempFolder folder;
  folder.write("broken.png", "this is no image");
  folder.write("m.mtl", "newmtl a\nKd 0.1 0.2 0.3\nmap_Kd gone.png\nnewmtl b\nmap_Kd broken.png\n");
  const auto path = folder.write(
      "s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
  const LoadedScene loaded = load(path);
  EXPECT_EQ(loaded.defects.count(DefectKind::texture_missing), 1u);
  EXPECT_EQ(loaded.defects.count(DefectKind::texture_unreadable), 1u);
  for (const Defect& defect : loaded.defects.defects) {
    const bool tells_why =
        defect.first_places.front().find(": cannot be read") != std::string::npos;
    EXPECT_EQ(tells_why, defect.kind == DefectKind::texture_unreadable);
    const bool ends = defect.first_places.front().ends_with("m.mtl:3)");
    EXPECT_EQ(ends, defect.kind == DefectKind::texture_missing) << defect.first_places.front();
  }
  EXPECT_EQ(loaded.scene.materials[0].texture, -1);
  EXPECT_EQ(loaded.scene.materials[0].diffuse, (Vec3f{0.1f, 0.2f, 0.3f}));
  ReadOptions options;
  options.load_textures = false;
  EXPECT_TRUE(load(path, options).defects.empty());
}

// The model of illumination that uses no light. In files of many programs, 0 stands for a model
// that they do not know; only textures are taken at its word.
TEST(Mtl, TexturesThatNothingLightsAreUnlit) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 77), {}).ok());
  const auto unlit = [&](const std::string& lines) {
    folder.write("m.mtl", "newmtl before\nillum 0\nmap_Kd a.png\nnewmtl a\n" + lines + "\n");
    const Scene scene =
        load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle)).scene;
    EXPECT_EQ(scene.materials.at(0).name, "a");
    return scene.materials.at(0).unlit;
  };
  for (const char* lines : {"illum 0\nmap_Kd a.png", "map_Kd a.png\nillum 0",
                            "ILLUM 0\nmap_kd a.png", "illum 2\nmap_Kd a.png\nKs 0 0 0\nillum 0"})
    EXPECT_TRUE(unlit(lines)) << lines;
  for (const char* lines : {"map_Kd a.png", "illum 1\nmap_Kd a.png", "illum\nmap_Kd a.png",
                            "illum 0", "illum none\nmap_Kd a.png", "illum 0\nillum 2\nmap_Kd a.png",
                            "Kd 1 1 1\nillum 0\nmap_Kd a.png\nillum 1"})
    EXPECT_FALSE(unlit(lines)) << lines;
}

TEST(Mtl, TexturesOfLinearValuesAreEncodedAndClipped) {
  const TempFolder folder;
  ImageF linear(1, 1, 3);
  linear.texels = {0.0319f, 0.5776f, 1.5f};
  ASSERT_TRUE(write_exr(folder / "a.exr", linear).ok());
  folder.write("m.mtl", "newmtl a\nmap_Kd a.exr\n");
  const LoadedScene loaded =
      load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle));
  ASSERT_EQ(loaded.scene.textures.size(), 1u);
  EXPECT_EQ(loaded.scene.textures[0].image.texels, (std::vector<std::uint8_t>{50, 200, 255}));
  EXPECT_EQ(loaded.defects.count(DefectKind::texture_clipped), 1u);
  EXPECT_TRUE(loaded.defects.defects[0].first_places[0].ends_with("a.exr"));
}

TEST(Mtl, ATextureOfAnotherMachineIsFoundBesideTheMaterials) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "wood.png", Image8(2, 2, 3, 77), {}).ok());
  folder.write("m.mtl", "newmtl a\nmap_Kd C:\\Users\\me\\My Maps\\wood.png\n");
  const LoadedScene loaded =
      load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle));
  EXPECT_TRUE(loaded.defects.empty());
  ASSERT_EQ(loaded.scene.textures.size(), 1u);
  EXPECT_EQ(loaded.scene.textures[0].path.filename(), "wood.png");
}

// When each missing name listed the folder again, 2000 of them among 2000 files took 11 seconds.
TEST(Mtl, MissingTexturesOfLargeFoldersTakeNoTime) {
  const TempFolder folder;
  constexpr int kMany = 3000;
  std::string mtl, obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
  for (int i = 0; i < kMany; ++i) {
    const std::string n = std::to_string(i);
    folder.write("other" + n + ".txt", "");
    mtl += "newmtl m" + n + "\nmap_Kd gone" + n + ".png\n";
    obj += "usemtl m" + n + "\nf 1/1 2/1 3/1\n";
  }
  folder.write("m.mtl", mtl);
  const auto path = folder.write("s.obj", obj);
  const double begin = cpu_seconds();
  EXPECT_EQ(load(path).defects.count(DefectKind::texture_missing), std::size_t(kMany));
  EXPECT_LT(cpu_seconds() - begin, 0.5 * test::kSlowness);
}

// Such scenes were written on systems that ignore case.
TEST(Mtl, FilesAreFoundInAnyCase) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "Maps");
  ASSERT_TRUE(write_png(folder / "Maps" / "Wood.PNG", Image8(2, 2, 3, 77), {}).ok());
  ASSERT_TRUE(write_png(folder / "beside.png", Image8(2, 2, 3, 77), {}).ok());
  ASSERT_TRUE(write_png(folder / "BESIDE.png", Image8(2, 2, 3, 77), {}).ok());
  const auto texture = [&](const std::string& name) {
    folder.write("Scene.MTL", "newmtl a\nmap_Kd " + name + "\n");
    const LoadedScene loaded =
        load(folder.write("s.obj", std::string("mtllib scene.mtl\n") + kTexturedTriangle));
    EXPECT_EQ(loaded.defects.count(DefectKind::material_file_missing), 0u);
    return loaded.scene.textures.empty() ? "" : loaded.scene.textures[0].path.filename().string();
  };
  EXPECT_EQ(texture("maps\\wood.png"), "Wood.PNG");
  EXPECT_EQ(texture("MAPS/../Maps/WOOD.png"), "Wood.PNG");
  EXPECT_EQ(texture("beside.png"), "beside.png");  // exactly this one, not BESIDE.png
  EXPECT_EQ(texture("C:\\x\\Beside.Png"), "BESIDE.png");
  EXPECT_EQ(texture("wood.png"), "");  // the file is in another folder
}

TEST(Mtl, KeywordsMayBeInAnyCase) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "wood.png", Image8(2, 2, 3, 77), {}).ok());
  folder.write("m.mtl", "NewMtl a\nkd 0.1 0.2 0.3\nmap_kd wood.png\nKE 1 2 3\nD 0.5\n");
  const LoadedScene loaded =
      load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle));
  EXPECT_TRUE(loaded.defects.empty());
  const Material& material = loaded.scene.materials[0];
  EXPECT_EQ(material.diffuse, (Vec3f{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(material.texture, 0);
  EXPECT_EQ(material.emission, (Vec3f{1, 2, 3}));
  EXPECT_EQ(material.opacity, 0.5f);
}

// The format has such colours, so they are no reason to refuse the scene.
TEST(Mtl, ColoursThatAreNoRgbAreADefect) {
  const TempFolder folder;
  folder.write("m.mtl",
               "newmtl a\nKd spectral gold.rfl 1\nnewmtl b\nKd 0.5 0.5 0.5\nKd xyz 0.2 0.3 0.4\n");
  const LoadedScene loaded = load(folder.write(
      "s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"));
  ASSERT_EQ(loaded.defects.defects.size(), 1u);
  const Defect& defect = loaded.defects.defects[0];
  EXPECT_EQ(defect.kind, DefectKind::reflectance_unknown);
  EXPECT_EQ(defect.count, 2u);
  EXPECT_TRUE(defect.first_places[0].ends_with("m.mtl:2: material 'a'")) << defect.first_places[0];
  EXPECT_EQ(loaded.scene.materials[0].diffuse, (Vec3f{1, 1, 1}));
  EXPECT_EQ(loaded.scene.materials[1].diffuse, (Vec3f{0.5f, 0.5f, 0.5f}));
}

TEST(Mtl, NamesMayHoldWhatElseBeginsAComment) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "wood #2 b.png", Image8(2, 2, 3, 77), {}).ok());
  ASSERT_TRUE(write_png(folder / "#1.png", Image8(2, 2, 3, 77), {}).ok());
  ASSERT_TRUE(write_png(folder / "plain.png", Image8(2, 2, 3, 77), {}).ok());
  const auto texture = [&](const std::string& library, const std::string& map) {
    folder.write("m #1 x.mtl", "newmtl a # of wood\nmap_Kd " + map + "\n");
    folder.write("m.mtl", "newmtl a # of wood\nmap_Kd " + map + "\n");
    const LoadedScene loaded =
        load(folder.write("s.obj", "mtllib " + library + "\n" + kTexturedTriangle));
    EXPECT_TRUE(loaded.defects.empty()) << library << ", " << map;
    return loaded.scene.textures.empty() ? "" : loaded.scene.textures[0].path.filename().string();
  };
  for (const char* library :
       {"m #1 x.mtl", "m.mtl", "m.mtl # by a modeller", "m #1 x.mtl m.mtl #"}) {
    EXPECT_EQ(texture(library, "wood #2 b.png"), "wood #2 b.png");
    EXPECT_EQ(texture(library, "-o 0 0 wood #2 b.png"), "wood #2 b.png");
    EXPECT_EQ(texture(library, "plain.png # of 2012"), "plain.png");
    EXPECT_EQ(texture(library, "plain.png"), "plain.png");
  }
}

// Programs write names that contain blanks, and names of files on the machine on which they run.
TEST(Mtl, NamesOfLibrariesMayHoldBlanksAndStandInQuotes) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "my wood.png", Image8(2, 2, 3, 77), {}).ok());
  for (const char* map : {"my wood.png", "\"my wood.png\"", "\"C:\\maps\\my wood.png\" # oak"}) {
    folder.write("my file.mtl", std::string("newmtl a\nmap_Kd -o 0 0 ") + map + "\n");
    for (const char* library :
         {"my file.mtl", "\"my file.mtl\"", "\"my file.mtl\" # of wood", "C:\\me\\my file.mtl",
          "\"/home/my self/my file.mtl\"", "/home/my self/my file.mtl"}) {
      const LoadedScene loaded = load(folder.write(
          "s.obj", std::string("mtllib ") + library +
                       "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 2\nusemtl a\nf 1/1 2/1 3/1\n"));
      EXPECT_TRUE(loaded.defects.empty()) << library << ", " << map;
      EXPECT_EQ(loaded.scene.textures.size(), 1u) << library << ", " << map;
    }
  }
}

// When each was read again, a file of a megabyte could ask for a million times as much.
TEST(Mtl, ALibraryThatIsNamedAgainIsReadOnce) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "wood.png", Image8(2, 2, 3, 77), {}).ok());
  folder.write("m.mtl", "newmtl a\nKd 2 2 2\nmap_Kd wood.png\nnewmtl b\nmap_Kd wood.png\n");
  const LoadedScene loaded = load(folder.write(
      "s.obj",
      "mtllib m.mtl none.mtl\nmtllib m.mtl\nmtllib none.mtl m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
      "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 2/1 3/1\n"));
  EXPECT_EQ(loaded.files,
            (std::vector<std::filesystem::path>{folder / "m.mtl", folder / "wood.png"}));
  EXPECT_EQ(loaded.defects.count(DefectKind::reflectance_beyond_one), 1u);
  EXPECT_EQ(loaded.defects.count(DefectKind::material_file_missing), 1u);
  EXPECT_EQ(loaded.scene.textures.size(), 1u);
  EXPECT_EQ(loaded.scene.materials[1].texture, 0);
}

TEST(Mtl, LibrariesThatAreMissingAreNamedWhole) {
  const TempFolder folder;
  folder.write("there.mtl", "newmtl a\n");
  const auto missing = [&](const std::string& libraries) {
    const LoadedScene loaded = load(folder.write(
        "s.obj", "mtllib " + libraries + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"));
    std::string names;
    for (const Defect& defect : loaded.defects.defects)
      for (const std::string& place : defect.first_places)
        if (defect.kind == DefectKind::material_file_missing)
          names +=
              std::filesystem::path(place.substr(0, place.find(" ("))).filename().string() + ";";
    return names;
  };
  EXPECT_EQ(missing("my file.mtl"), "my file.mtl;");
  EXPECT_EQ(missing("\"my file.mtl\" there.mtl"), "my file.mtl;");
  EXPECT_EQ(missing("one.mtl my other.MTL # of wood"), "one.mtl;my other.MTL;");
  EXPECT_EQ(missing("my file there.mtl"), "my file;");
  EXPECT_EQ(missing("my file \"other.mtl\""), "my file;other.mtl;");
  EXPECT_EQ(missing("there.mtl \"open.mtl"), "\"open.mtl;");
  EXPECT_EQ(missing("there.mtl \"\""), "\"\";");
  EXPECT_EQ(missing("there.mtl"), "");
}

TEST(Mtl, WhatNoSurfaceReflectsIsKeptAndTold) {
  const TempFolder folder;
  folder.write("m.mtl", "newmtl a\nKd 1 0 1\nnewmtl b\nKd 204 180 150\nnewmtl c\nKd -0.1 0 0\n");
  const LoadedScene loaded = load(folder.write("s.obj",
                                               "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\n"
                                               "f 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n"));
  ASSERT_EQ(loaded.defects.defects.size(), 1u);
  const Defect& defect = loaded.defects.defects[0];
  EXPECT_EQ(defect.kind, DefectKind::reflectance_beyond_one);
  EXPECT_EQ(defect.count, 2u);
  EXPECT_TRUE(defect.first_places[0].ends_with("m.mtl:4: Kd of material 'b'"))
      << defect.first_places[0];
  EXPECT_TRUE(defect.first_places[1].ends_with("m.mtl:6: Kd of material 'c'"));
  EXPECT_EQ(loaded.scene.materials[1].diffuse, (Vec3f{204, 180, 150}));
}

TEST(Mtl, NumbersBeyondFloatLeaveFiniteMaterialsAndCoordinates) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 77), {}).ok());
  folder.write("m.mtl", "newmtl a\nKd 1e39 1 -1e39\nmap_Kd -s 1e39 1 a.png\n");
  const LoadedScene loaded =
      load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle));
  EXPECT_EQ(check_scene(loaded.scene).message(), "");
  EXPECT_EQ(loaded.defects.count(DefectKind::texcoord_not_finite), 1u);
  EXPECT_EQ(loaded.defects.count(DefectKind::reflectance_beyond_one), 1u);
}

// Many programs write zero for every material.
TEST(Mtl, Emission) {
  const TempFolder folder;
  const auto material = [&](const std::string& lines) {
    folder.write("m.mtl", "newmtl before\nKe 9 9 9\nnewmtl a\n" + lines + "\n");
    const LoadedScene loaded =
        load(folder.write("s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"));
    EXPECT_TRUE(loaded.defects.empty()) << lines;
    return loaded.scene.materials.front();
  };
  EXPECT_EQ(material("Kd 1 1 1").emission, Vec3f{});
  EXPECT_EQ(material("Ke 0 0 0").emission, Vec3f{});
  EXPECT_EQ(material("Ke 2 0.5 0 # glows").emission, (Vec3f{2, 0.5f, 0}));
  EXPECT_EQ(material("Ke 3").emission, (Vec3f{3, 3, 3}));
  for (const char* none :
       {"Ke spectral lamp.rfl", "Ke -1 0 0", "Ke 1 2", "Ke 1e40 0 0", "Ke nan 0 0", "Ke"})
    EXPECT_EQ(material(none).emission, Vec3f{}) << none;
  EXPECT_FALSE(material("Ke 1 1 1").emission_textured);
  EXPECT_EQ(material("map_Ke a.png").emission, (Vec3f{1, 1, 1}));
  EXPECT_TRUE(material("map_Ke a.png").emission_textured);
  for (const char* off : {"Ke 0 0 0\nmap_Ke a.png", "map_Ke a.png\nKe 0 0 0"})
    EXPECT_EQ(material(off).emission, Vec3f{}) << off;
}

// Options before a texture's name: those that change nothing are ignored, those that are not
// supported are reported.
TEST(Mtl, TextureOptions) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "maps");
  ASSERT_TRUE(write_png(folder / "maps" / "a b.png", Image8(2, 2, 3, 77), {}).ok());
  const auto ignored = [&](const std::string& options) {
    folder.write("m.mtl", "newmtl a\nmap_Kd " + options + " maps\\a b.png\n");
    const LoadedScene loaded =
        load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle));
    EXPECT_EQ(loaded.scene.textures.size(), 1u) << options;
    EXPECT_EQ(loaded.scene.materials[0].texture, 0) << options;
    const bool clamped = options.find("-clamp on") != std::string::npos;
    EXPECT_EQ(loaded.scene.materials[0].wrap_v == TextureWrap::clamp, clamped) << options;
    const std::uint64_t count = loaded.defects.count(DefectKind::texture_option_ignored);
    EXPECT_EQ(loaded.defects.empty(), count == 0) << options;
    return count;
  };
  for (const char* options : {"", "-mm 0 1", "-clamp off", "-clamp on", "-blendu on",
                              "-blendv off -cc off", "-o 0", "-s 1 1 1 -mm 0 1.0 -o 0 0"}) {
    EXPECT_EQ(ignored(options), 0u) << options;
  }
  for (const char* options :
       {"-mm 0.5 1", "-mm 0 2", "-t 0.1", "-t 0 0 1", "-bm 0.5", "-imfchan r", "-texres 512"}) {
    EXPECT_EQ(ignored(options), 1u) << options;
  }
  EXPECT_EQ(ignored("-clamp on -mm 1 1 -blendu off"), 1u);
}

// The coordinates of the triangle's corners are (1, 2).
TEST(Mtl, OffsetsAndScalesMoveTexcoords) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 77), {}).ok());
  ASSERT_TRUE(write_png(folder / "b.png", Image8(2, 2, 3, 77), {}).ok());
  const auto moved = [&](const std::string& maps) {
    folder.write("m.mtl", "newmtl a\n" + maps + "\n");
    const Scene scene =
        load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle)).scene;
    EXPECT_EQ(scene.textures.size(), 1u);
    return scene.texcoords.at(scene.texcoord_indices.at(0));
  };
  EXPECT_EQ(moved("map_Kd -o 0.25 0.5 a.png"), (Vec2f{1.25f, 2.5f}));
  EXPECT_EQ(moved("map_Kd -o 0.25 a.png"), (Vec2f{1.25f, 2}));
  EXPECT_EQ(moved("map_Kd -s 3 a.png"), (Vec2f{3, 2}));
  EXPECT_EQ(moved("map_Kd -s 3 4 -o 0.25 0.5 a.png"), (Vec2f{3.25f, 8.5f}));
  EXPECT_EQ(moved("map_Kd -s 3 4 -o 1 1 a.png\nmap_Kd b.png"), (Vec2f{1, 2}))
      << "the options are those of the last texture";
}

// Corners without texture coordinates stay so, and each material moves its own.
TEST(Mtl, EachMaterialMovesItsOwnTexcoords) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 77), {}).ok());
  folder.write("m.mtl",
               "newmtl a\nmap_Kd -s 2 2 a.png\nnewmtl b\nmap_Kd -s 3 3 a.png\nnewmtl c\n"
               "map_Kd a.png\n");
  const Scene scene = load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle +
                                                     "f 1 2 3\nusemtl b\nf 1/1 2/1 3/1\n"
                                                     "usemtl c\nf 1/1 2/1 3/1\n"))
                          .scene;
  const auto at = [&](std::size_t corner) {
    return scene.texcoords.at(scene.texcoord_indices.at(corner));
  };
  EXPECT_EQ(at(0), (Vec2f{2, 4}));
  EXPECT_EQ(scene.texcoord_indices[3], Scene::kNoTexcoord);
  EXPECT_EQ(at(6), (Vec2f{3, 6}));
  EXPECT_EQ(at(9), (Vec2f{1, 2}));
}

TEST(Mtl, OnlyTheLastTextureIsClamped) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 77), {}).ok());
  folder.write("m.mtl", "newmtl a\nmap_Kd -clamp on a.png\nmap_Kd a.png\n");
  const Scene scene =
      load(folder.write("s.obj", std::string("mtllib m.mtl\n") + kTexturedTriangle)).scene;
  EXPECT_EQ(scene.materials[0].wrap_u, TextureWrap::repeat);
  EXPECT_EQ(scene.materials[0].wrap_v, TextureWrap::repeat);
}

TEST(Mtl, LinesBeforeTheFirstMaterialChangeNone) {
  const TempFolder folder;
  folder.write("m.mtl", "d 0.5\nKe 1 1 1\nmap_d a.png\nnewmtl a\n");
  const Scene scene =
      load(folder.write("s.obj",
                        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl a\n"
                        "f 1 2 3\n"))
          .scene;
  ASSERT_EQ(scene.materials.size(), 2u);
  for (const Material& material : scene.materials) {
    EXPECT_EQ(material.opacity, 1);
    EXPECT_EQ(material.emission, Vec3f{});
    EXPECT_FALSE(material.opacity_textured);
  }
}

// Lines are kept if the rest is asked for. Otherwise those are counted that no member holds.
TEST(Mtl, LinesThatAreNotReadAreCounted) {
  const TempFolder folder;
  folder.write("m.mtl",
               "newmtl a\nKd 1 0 0\n# a comment\nd 0.5\n  Ns 10 # shiny\nNs 20\nKe 1 1 1\nd 2\n"
               "newmtl b\nKe 1 1 1\nmap_Ke a.png\nd 0.5 0.5\nNi 1\nnewmtl unused\nNs 3\n");
  const auto path = folder.write(
      "s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
  const Scene scene = load(path).scene;
  EXPECT_EQ(scene.not_read, (LossCounts{{"lines of the MTL: Ke", 1},
                                        {"lines of the MTL: Ni", 1},
                                        {"lines of the MTL: Ns", 2},
                                        {"lines of the MTL: d", 2},
                                        {"lines of the MTL: map_Ke", 1}}));
  EXPECT_TRUE(scene.materials[0].mtl_lines.empty());
  for (const bool rest : {false, true}) {
    ReadOptions options;
    (rest ? options.rest : options.keep_scene) = true;
    const Scene kept = load(path, options).scene;
    EXPECT_EQ(kept.not_read, LossCounts{});
    EXPECT_EQ(kept.materials[0].mtl_lines,
              (std::vector<std::string>{"d 0.5", "Ns 10 # shiny", "Ns 20", "Ke 1 1 1", "d 2"}));
  }
}

// Only `d` with a fraction is unambiguous. Other values of it, and Tr, which some programs write
// for 1 - d, leave a material opaque.
TEST(Mtl, Opacity) {
  const TempFolder folder;
  const auto read = [&](const std::string& line) {
    folder.write("m.mtl", "newmtl a\n" + line + "\n");
    return load(folder.write("s.obj",
                             "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"))
        .scene.materials[0];
  };
  EXPECT_EQ(read("d 0.25").opacity, 0.25f);
  EXPECT_EQ(read("d 0.25").alpha_mode, AlphaMode::blend);
  for (const char* line : {"d 1", "d 2", "d -0.5", "d nan", "d -halo 0.5", "d", "Tr 1", "Tr 0.3"}) {
    EXPECT_EQ(read(line).opacity, 1) << line;
    EXPECT_EQ(read(line).alpha_mode, AlphaMode::opaque) << line;
    EXPECT_FALSE(read(line).opacity_textured) << line;
  }
  EXPECT_TRUE(read("map_d holes.png").opacity_textured);
  EXPECT_TRUE(read("d -halo 0.5").opacity_by_view);
  for (const char* line : {"d -halo 1", "d -halo", "d -halo 7", "d -halo 0.5\nd 1"})
    EXPECT_FALSE(read(line).opacity_by_view) << line;
}

}  // namespace
}  // namespace atlas

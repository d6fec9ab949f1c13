#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/scene/load_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::load;
using test::TempFolder;

TEST(Illumination, FromASecondFile) {
  const TempFolder folder;
  const auto mesh = folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("light.txt", "# lux\n1 2 3\n4.5 5 6\n\n7\n");
  folder.write("light.obj", "v 9 9 9 1 2 3\nv 9 9 9 4.5 5 6\nv 9 9 9 7 7 7\n");
  folder.write(
      "light.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float r\nproperty float g\nproperty float b\nend_header\n"
      "0 0 0 1 2 3\n0 0 0 4.5 5 6\n0 0 0 7 7 7\n");
  for (const char* name : {"light.txt", "light.obj", "light.ply"}) {
    ReadOptions options;
    options.illumination_file = folder / name;
    const LoadedScene loaded = load(mesh, options);
    EXPECT_EQ(loaded.scene.illumination, (std::vector<Vec3f>{{1, 2, 3}, {4.5f, 5, 6}, {7, 7, 7}}))
        << name;
  }
  const auto status_with = [&](const std::string& name, const std::string& bytes) {
    ReadOptions options;
    options.illumination_file = folder.write(name, bytes);
    return read_scene(mesh, options, {}).status();
  };
  EXPECT_EQ(status_with("short.txt", "1 2 3\n").code(), ErrorCode::bad_input);
  EXPECT_EQ(status_with("long.txt", "1\n2\n3\n4\n").code(), ErrorCode::bad_input);
  EXPECT_NE(status_with("two.txt", "1 2\n").message().find("two.txt:1:"), std::string::npos);
  EXPECT_NE(status_with("four.txt", "1\n1 2 3 4\n2\n").message().find("four.txt:2:"),
            std::string::npos);
  // A lightmap, for example: the message must not ask to correct its first line.
  EXPECT_NE(status_with("map.png", std::string("\x89PNG\r\n\0\0\0", 9))
                .message()
                .find("map.png: is no text"),
            std::string::npos);
  EXPECT_EQ(status_with("none.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\n").code(), ErrorCode::bad_input);
  ReadOptions missing;
  missing.illumination_file = folder / "nowhere.txt";
  EXPECT_EQ(read_scene(mesh, missing, {}).status().code(), ErrorCode::not_found);
  // What is a scene, though of a kind that is not read, is no text.
  EXPECT_EQ(status_with("light.gltf",
                        R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_unknown"]})")
                .code(),
            ErrorCode::unsupported);
}

// Light of another file is given vertex by vertex, so it takes the place of colours of faces, and
// those of its own faces are none.
TEST(Illumination, IsThatOfVerticesNotOfFaces) {
  const TempFolder folder;
  const auto faces = folder.write(
      "a.off", "OFF\n4 2 0\n0 0 0\n2 0 0\n2 3 0\n0 3 0\n3 0 1 2 1 0 0\n3 0 2 3 0 1 0\n");
  ReadOptions options;
  options.illumination_file = folder.write("light.txt", "1\n2\n3\n4\n");
  const LoadedScene loaded = load(faces, options);
  EXPECT_EQ(loaded.scene.positions.size(), 4u);
  EXPECT_EQ(loaded.scene.illumination.at(3), (Vec3f{4, 4, 4}));
  options.illumination_file = faces;
  const std::string message = read_scene(faces, options, {}).status().message();
  EXPECT_NE(message.find("its colours are those of faces"), std::string::npos) << message;
}

TEST(Illumination, FilesThatTheSecondFileNamesAreListed) {
  const TempFolder folder;
  const auto mesh = folder.write("mesh.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("a.mtl", "newmtl a\n");
  folder.write("b.mtl", "newmtl b\n");
  ReadOptions options;
  options.illumination_file =
      folder.write("light.obj", "mtllib b.mtl\nv 0 0 0 1 2 3\nv 1 0 0 1 2 3\nv 0 1 0 1 2 3\n");
  EXPECT_EQ(load(mesh, options).files,
            (std::vector<std::filesystem::path>{folder / "a.mtl", folder / "b.mtl"}));
}

// Only the order of vertices links the two files. If both have the same bounding box, it is
// checked.
TEST(Illumination, AnotherOrderOfTheSameVerticesIsTold) {
  const TempFolder folder;
  const auto mesh = folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto elsewhere = [&](const std::string& light) {
    ReadOptions options;
    options.illumination_file = folder.write("light.obj", light);
    const LoadedScene loaded = load(mesh, options);
    EXPECT_EQ(loaded.scene.illumination.size(), 3u);
    return loaded.defects.count(DefectKind::illumination_elsewhere);
  };
  EXPECT_EQ(elsewhere("v 0 0 0 1 1 1\nv 1 0 0 2 2 2\nv 0 1 0 3 3 3\n"), 0u);
  EXPECT_EQ(elsewhere("v 0 0 0 1 1 1\nv 0 1 0 2 2 2\nv 1 0 0 3 3 3\n"), 2u);
  EXPECT_EQ(elsewhere("v 0.0004 0 0 1 1 1\nv 1 0.001 0 2 2 2\nv 0 1 0 3 3 3\n"), 0u);
  EXPECT_EQ(elsewhere("v 0 0 0 1 1 1\nv 0 1000 0 2 2 2\nv 1000 0 0 3 3 3\n"), 0u);  // in mm
  EXPECT_EQ(elsewhere("v nan 0 0 1 1 1\nv 1 0 0 2 2 2\nv 0 1 0 3 3 3\n"), 0u);
  ReadOptions options;
  const auto far =
      folder.write("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.5 0.5 0\nv 1e300 0 0\nf 1 2 3\n");
  options.illumination_file =
      folder.write("light.obj",
                   "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nv 0.5 0.55 0 1 1 1\n"
                   "v 1e300 0 0 1 1 1\n");
  const LoadedScene loaded = load(far, options);
  ASSERT_EQ(loaded.defects.count(DefectKind::illumination_elsewhere), 1u)
      << "a position that is no float hides nothing";
  for (const Defect& defect : loaded.defects.defects) {
    if (defect.kind == DefectKind::illumination_elsewhere) {
      EXPECT_TRUE(defect.first_places[0].ends_with("light.obj: vertex 4"));
    }
  }
}

TEST(Illumination, AnotherOrderIsToldWhereverTheMeshLies) {
  const TempFolder folder;
  for (int axis = 0; axis < 3; ++axis) {
    // A triangle in a plane across the axis, ten times as far from the origin as it is large.
    const auto vertex = [&](int corner, const char* light) {
      std::string text[3] = {"10", "10", "10"};
      if (corner > 0) text[(axis + corner) % 3] = "11";
      return "v " + text[0] + " " + text[1] + " " + text[2] + light + "\n";
    };
    const auto mesh =
        folder.write("mesh.obj", vertex(0, "") + vertex(1, "") + vertex(2, "") + "f 1 2 3\n");
    for (const bool swapped : {false, true}) {
      ReadOptions options;
      options.illumination_file =
          folder.write("light.obj", vertex(0, " 1 1 1") + vertex(swapped ? 2 : 1, " 2 2 2") +
                                        vertex(swapped ? 1 : 2, " 3 3 3"));
      EXPECT_EQ(load(mesh, options).defects.count(DefectKind::illumination_elsewhere),
                swapped ? 2u : 0u)
          << axis;
    }
  }
}

// Defects of the second file's light are reported with that file's name. The first file's light is
// not used.
TEST(Illumination, DefectsAreTheSecondFiles) {
  const TempFolder folder;
  const auto mesh = folder.write(
      "mesh.obj", "v 0 0 0 nan 1 1\nv 1 0 0 1 1 1\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
  folder.write("light.obj", "v 0 0 0 1 2 3\nv 0 0 0 1 2 inf\nv 0 0 0 1 2 3\nv 0 0 0\n");
  folder.write("light.txt", "1\nnan\n-1\n4\n");
  folder.write("huge.obj", "v 0 0 0 1 2 3\nv 0 0 0 1 2 2e36\nv 0 0 0 1e36 2 3\nv 0 0 0\n");
  const auto defects = [&](const std::string& name) {
    ReadOptions options;
    options.illumination_file = folder / name;
    return load(mesh, options).defects;
  };
  for (const char* name : {"light.obj", "light.txt", "huge.obj"}) {
    const DefectReport report = defects(name);
    EXPECT_EQ(report.count(DefectKind::illumination_not_finite), 1u) << name;
    EXPECT_EQ(report.defects.size(), 2u) << name;
    for (const Defect& defect : report.defects)
      EXPECT_NE(defect.first_places.front().find(name), std::string::npos)
          << defect.first_places.front();
  }
  EXPECT_EQ(defects("light.obj").count(DefectKind::illumination_missing), 1u);
  EXPECT_EQ(defects("light.txt").count(DefectKind::illumination_negative), 1u);
  EXPECT_TRUE(defects("light.txt").defects[0].first_places[0].ends_with("light.txt: vertex 2"));
  // Those of both files are in one order, so that each kind is listed once.
  folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\nl 1 2\n");
  folder.write("wrong.obj", "v 0 0 0 nan 2 3\nv 0 0 0 1 -2 1e38\nv 0 0 0 1 2 3\nv 0 0 0\n");
  std::vector<DefectKind> kinds;
  for (const Defect& defect : defects("wrong.obj").defects) kinds.push_back(defect.kind);
  EXPECT_EQ(kinds, (std::vector<DefectKind>{
                       DefectKind::illumination_not_finite, DefectKind::illumination_negative,
                       DefectKind::illumination_missing, DefectKind::element_ignored}));
}

}  // namespace
}  // namespace atlas

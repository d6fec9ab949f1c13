#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/load_scene.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::load;
using test::TempFolder;

TEST(Obj, EverythingAtOnce) {
  const TempFolder folder;
  Image8 image(2, 2, 3, 128);
  ASSERT_TRUE(write_png(folder / "my wood.png", image, {}).ok());
  folder.write(
      "a library.mtl",
      "# two materials\r\nnewmtl wood\r\nKd 0.5 0.25 1\r\n"
      "map_Kd -s 2 4 1 -o 0.5 0 0 my wood.png\r\n\r\nnewmtl unused\r\nmap_Kd none.png\r\n");
  folder.write("second.mtl", "newmtl plain\nKd 0.75\n");
  const auto path = folder.write("scene.obj",
                                 "# comment\r\n"
                                 "mtllib a library.mtl second.mtl\r\n"
                                 "o first\r\n"
                                 "v 0 0 0 1000.5 -2 3e5\r\n"
                                 "v 1 0 \\\r\n 0 1 2 3\r\n"
                                 "v 1 1 0 4 5 6 # end\r\n"
                                 "v 0 1 0 7 8 9\r\n"
                                 "vt -1.5 2\r\nvt 1 0\r\nvt 1 1\r\nvt 0 1\r\n"
                                 "vn 0 0 1\r\n"
                                 "s off\r\n"
                                 "usemtl wood\r\n"
                                 "f 1/1/1 2/2/1 3/3/1 4/4/1\r\n"
                                 "o second\r\n"
                                 "usemtl plain\r\n"
                                 "f -4//-1 -3//-1 -2//-1\r\n"
                                 "f +1 3 4");
  const LoadedScene loaded = load(path);
  const Scene& s = loaded.scene;
  EXPECT_EQ(s.triangle_count(), 4u);
  EXPECT_EQ(s.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3}));
  ASSERT_EQ(s.illumination.size(), 4u);
  EXPECT_EQ(s.illumination[0], (Vec3f{1000.5f, -2, 3e5f}));
  EXPECT_EQ(s.illumination[1], (Vec3f{1, 2, 3}));
  EXPECT_EQ(s.object_names, (std::vector<std::string>{"first", "second"}));
  EXPECT_EQ(s.triangle_object, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  ASSERT_EQ(s.materials.size(), 2u);
  EXPECT_EQ(s.materials[0].name, "wood");
  EXPECT_EQ(s.materials[0].diffuse, (Vec3f{0.5f, 0.25f, 1}));
  EXPECT_EQ(s.materials[0].texture, 0);
  EXPECT_EQ(s.materials[1].diffuse, (Vec3f{0.75f, 0.75f, 0.75f}));
  EXPECT_EQ(s.materials[1].texture, -1);
  ASSERT_EQ(s.textures.size(), 1u);
  EXPECT_EQ(s.textures[0].image.width, 2);
  // The texture's own scale and offset are applied to the coordinates of its triangles.
  ASSERT_EQ(s.texcoord_indices.size(), 12u);
  EXPECT_EQ(s.texcoords[s.texcoord_indices[0]], (Vec2f{-2.5f, 8}));
  EXPECT_EQ(s.texcoord_indices[6], Scene::kNoTexcoord);
  EXPECT_EQ(loaded.defects.count(DefectKind::illumination_negative), 1u);
  EXPECT_EQ(loaded.defects.defects.size(), 1u);  // nothing else, not even the unused texture
}

// Text as editors of other systems write it: the byte order mark must not hide the first vertex.
TEST(Obj, ByteOrderMarksAndOtherSystemsLineEnds) {
  const TempFolder folder;
  const std::string mark = "\xef\xbb\xbf";
  std::filesystem::create_directory(folder / "sub");
  folder.write("sub/m.mtl", mark + "newmtl a\rKd 0.1 0.2 0.3\r");
  const std::string obj =
      "v 0 0 0 1 2 3\rv 1 0 0 4 5 6\rv 0 1 0 7 8 9\rmtllib sub\\m.mtl\rusemtl a\rf 1 2 3\r";
  const LoadedScene loaded = load(folder.write("s.obj", mark + obj));
  EXPECT_TRUE(loaded.defects.empty());
  ASSERT_EQ(loaded.scene.positions.size(), 3u);
  EXPECT_EQ(loaded.scene.illumination[0], (Vec3f{1, 2, 3}));
  EXPECT_EQ(loaded.scene.materials[0].diffuse, (Vec3f{0.1f, 0.2f, 0.3f}));
  ReadOptions options;
  options.illumination_file = folder.write("light.txt", mark + "5\n6\n7\n");
  EXPECT_EQ(load(folder / "s.obj", options).scene.illumination[0], (Vec3f{5, 5, 5}));
  const LoadedScene off =
      load(folder.write("s.off", mark + "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  EXPECT_EQ(off.scene.positions.size(), 3u);

  for (const char* begin : {"\xff\xfev", "\xfe\xffv"}) {
    const auto wide = read_scene(folder.write("w.obj", begin), {}, {});
    ASSERT_EQ(wide.status().code(), ErrorCode::unsupported);
    EXPECT_NE(wide.status().message().find("save it as UTF-8"), std::string::npos);
  }
}

TEST(Obj, GroupsAreObjectsOnlyWithoutObjects) {
  const TempFolder folder;
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto groups = load(folder.write("g.obj", v + "g a\nf 1 2 3\ng b\nf 1 2 3\ng a\nf 3 2 1\n"));
  EXPECT_EQ(groups.scene.triangle_object, (std::vector<std::uint32_t>{0, 1, 0}));
  const auto both = load(folder.write("og.obj", v + "o x\ng a\nf 1 2 3\ng b\nf 1 2 3\n"));
  EXPECT_EQ(both.scene.object_names, std::vector<std::string>{"x"});
}

// Whatever separates names from comments, a name that comes again is the same object.
TEST(Obj, NamesEndBeforeComments) {
  const TempFolder folder;
  const Scene scene =
      load(folder.write("g.obj",
                        "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a # first\nf 1 2 3\ng a\nf 1 2 3\n"
                        "g b #2\nfo 1 2 3\nusemtl m # steel\nf 1 2 3\nusemtl m\nf 1 2 3\n"))
          .scene;
  EXPECT_EQ(scene.object_names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(scene.triangle_object, (std::vector<std::uint32_t>{0, 0, 1, 1, 1}));
  EXPECT_EQ(scene.triangle_material, (std::vector<std::uint32_t>{0, 0, 0, 1, 1}));
  EXPECT_EQ(scene.materials[1].name, "m");
}

// A backslash at the end of a comment joins no lines: the face after it was left out.
TEST(Obj, CommentsBehindNamesMayEndInBackslashes) {
  const TempFolder folder;
  for (const char* line : {"g a", "o a", "usemtl m", "mtllib none.mtl", "s 1", "unknown"}) {
    const LoadedScene loaded =
        load(folder.write("c.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n") + line +
                                       " # in C:\\tmp\\\nf 1 2 3\nf 3 2 1\n"));
    EXPECT_EQ(loaded.scene.triangle_count(), 2u) << line;
  }
}

// Weights after the position, fourth components of colours, texture coordinates of one number, and
// lines that change nothing that is read.
TEST(Obj, WhatTheFormatAllowsIsNoDefect) {
  const TempFolder folder;
  const LoadedScene loaded = load(folder.write(
      "a.obj",
      "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nvt 0.25\nvn 0 0 1\nvp 1 2 3\ns 1\nmg 1 0.5\nbevel on\n"
      "c_interp on\nlod 3\nusemap a\nmaplib b.map\nd_interp on\nshadow_obj c\ntrace_obj d\n"
      "f 1/1 2/1 3/1/\nf 1/ 2// 3/1\nf 1 2\nv 1 1 1"));
  EXPECT_EQ(loaded.defects.lines().size(), 2u);
  EXPECT_EQ(loaded.defects.count(DefectKind::texcoord_partial), 1u);
  EXPECT_EQ(loaded.defects.count(DefectKind::too_few_corners), 1u) << "it is not at the end";
  EXPECT_FALSE(loaded.scene.lit());
  EXPECT_EQ(loaded.scene.texcoords[0], (Vec2f{0.25f, 0}));
  const LoadedScene lit =
      load(folder.write("b.obj", "v 0 0 0\nv 1 0 0 1 2 3 1\nv 0 1 0 4 5 6 1\nv 1 1 0\nf 1 2 3\n"));
  EXPECT_EQ(lit.scene.illumination, (std::vector<Vec3f>{{}, {1, 2, 3}, {4, 5, 6}, {}}));
  ASSERT_EQ(lit.defects.count(DefectKind::illumination_missing), 2u);
  EXPECT_TRUE(lit.defects.defects[0].first_places[0].ends_with("b.obj: vertex 1"));
  EXPECT_TRUE(lit.defects.defects[0].first_places[1].ends_with("b.obj: vertex 4"));
}

// A float holds no number below 1.2e-38 with all its digits.
TEST(Obj, ScenesTooSmallForFloatsAreRefused) {
  const TempFolder folder;
  const auto code = [&](const char* size) {
    const std::string s = size;
    return read_scene(folder.write("a.obj", "v 0 0 0\nv " + s + " 0 0\nv 0 " + s + " 0\nf 1 2 3\n"),
                      {}, {})
        .status()
        .code();
  };
  EXPECT_EQ(code("1e-39"), ErrorCode::unsupported);
  EXPECT_EQ(code("1e-37"), ErrorCode::ok);
}

// Each coordinate is a float, but differences and distances are none.
TEST(Obj, ScenesTooLargeForFloatsAreRefused) {
  const TempFolder folder;
  const auto status = [&](const std::string& s) {
    return read_scene(folder.write("a.obj",
                                   "v -" + s + " 0 0\nv " + s + " 0 0\nv 0 " + s + " 0\nf 1 2 3\n"),
                      {}, {})
        .status();
  };
  EXPECT_EQ(status("3e38").code(), ErrorCode::unsupported);
  EXPECT_NE(status("3e38").message().find("too large for single-precision floats"),
            std::string::npos);
  EXPECT_EQ(status("1e38").code(), ErrorCode::ok);
}

TEST(Obj, BadElementsAreCountedAndNamed) {
  const TempFolder folder;
  const auto path = folder.write("bad.obj",
                                 "mtllib none.mtl\n"
                                 "usemtl ghost\n"
                                 "v 0 0 0 1 1 1\n"
                                 "v 1 0 0 nan 1 inf\n"
                                 "v 0 1 0\n"
                                 "v nan 0 0 1 1 1\n"
                                 "v 1e39 0 0 1 1 1\n"
                                 "vt nan 0\nvt 1 0\n"
                                 "f 1/1 2/2 3/1\n"
                                 "f 1 2 9\n"
                                 "f 1 2 0\n"
                                 "f 1 2 -9\n"
                                 "f 1 2 99999999999999999999\n"
                                 "f 1 2\n"
                                 "f 1 2 4\n"
                                 "f 1 2 5\n"
                                 "f 1/1 2/7 3/1\n"
                                 "f 1/1 2 3/1\n"
                                 "l 1 2\n"
                                 "nonsense 1\n");
  const LoadedScene loaded = load(path);
  const DefectReport& d = loaded.defects;
  EXPECT_EQ(loaded.scene.triangle_count(), 3u);
  EXPECT_EQ(d.triangles_left_out, 7u);
  EXPECT_EQ(d.count(DefectKind::index_out_of_range), 4u);
  EXPECT_EQ(d.count(DefectKind::too_few_corners), 1u);
  EXPECT_EQ(d.count(DefectKind::bad_position_used), 2u);
  EXPECT_EQ(d.count(DefectKind::position_not_finite), 2u);
  EXPECT_EQ(d.count(DefectKind::texcoord_out_of_range), 1u);
  EXPECT_EQ(d.count(DefectKind::texcoord_partial), 1u);
  EXPECT_EQ(d.count(DefectKind::texcoord_not_finite), 1u);
  EXPECT_EQ(d.count(DefectKind::illumination_not_finite), 1u);
  EXPECT_EQ(d.count(DefectKind::illumination_missing), 1u);
  EXPECT_EQ(d.count(DefectKind::material_file_missing), 1u);
  EXPECT_EQ(d.count(DefectKind::material_unknown), 1u);
  EXPECT_EQ(d.count(DefectKind::element_ignored), 2u);
  const auto place_of = [&](DefectKind kind) {
    for (const Defect& defect : d.defects) {
      if (defect.kind == kind) return defect.first_places.front();
    }
    return std::string();
  };
  EXPECT_EQ(place_of(DefectKind::index_out_of_range), path.string() + ":11");
  EXPECT_EQ(place_of(DefectKind::position_not_finite), path.string() + ":6");
  EXPECT_EQ(place_of(DefectKind::bad_position_used), path.string() + ":16");
  EXPECT_EQ(place_of(DefectKind::element_ignored), path.string() + ":20");
  EXPECT_EQ(place_of(DefectKind::illumination_not_finite), path.string() + ":4");
  for (const Vec3f& p : loaded.scene.positions) EXPECT_TRUE(std::isfinite(p.x));
  for (const Vec3f& p : loaded.scene.illumination) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
  EXPECT_EQ(d.lines().size(), d.defects.size());
}

// Makes a file of several chunks, with every difficulty at chunk boundaries, and the result that a
// simple reader would give.
std::string large_obj(std::vector<std::array<double, 3>>& vertices,
                      std::vector<std::array<long, 3>>& faces) {
  std::mt19937 random(3);
  std::string text;
  long n = 0;
  while (text.size() < (std::size_t{10} << 20)) {
    for (int k = 0; k < 4; ++k, ++n) {
      const double x = double(random() % 100000) / 1000, y = double(random() % 1000), z = n;
      vertices.push_back({x, y, z});
      text += fmt::format("v {} {} \\\n{}{}", x, y, z, n % 3 == 0 ? "\r\n" : "\n");
      text += fmt::format("vt {} {}\n", n % 1000, y);
    }
    const long a = n - long(random() % 4), b = -1 - long(random() % 4);
    const long c = 1 + long(random() % n);
    faces.push_back({a - 1, n + b, c - 1});
    text += fmt::format("f {0}/{0} \\\r\n{1}/{1} {2}/{2}\n", a, b, c);
  }
  return text;
}

TEST(Obj, PiecesGiveWhatOneReaderGives) {
  const TempFolder folder;
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<long, 3>> faces;
  const auto path = folder.write("large.obj", large_obj(vertices, faces));
  Context one;
  one.threads = 1;
  Context four;
  four.threads = 4;
  const auto a = read_scene(path, {}, one), b = read_scene(path, {}, four);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_TRUE(a->defects.empty());
  ASSERT_EQ(a->scene.positions.size(), vertices.size());
  ASSERT_EQ(a->scene.triangle_count(), faces.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3f& p = a->scene.positions[i];
    ASSERT_TRUE(p.x == float(vertices[i][0]) && p.y == float(vertices[i][1]) &&
                p.z == float(vertices[i][2]))
        << i;
  }
  for (std::size_t i = 0; i < faces.size() * 3; ++i) {
    const long v = faces[i / 3][i % 3];
    ASSERT_EQ(long(a->scene.indices[i]), v) << i;
    const Vec2f uv = a->scene.texcoords[a->scene.texcoord_indices[i]];
    ASSERT_EQ(uv, (Vec2f{float(v % 1000), float(vertices[std::size_t(v)][1])})) << i;
  }
  EXPECT_EQ(a->scene.texcoord_indices, b->scene.texcoord_indices);
  EXPECT_EQ(a->scene.positions, b->scene.positions);
  EXPECT_EQ(a->scene.indices, b->scene.indices);
}

TEST(Obj, LineNumbersSurvivePieces) {
  const TempFolder folder;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::size_t lines = 4;
  while (text.size() < (std::size_t{9} << 20)) {
    text += "v 1 2 3 \\\n# joined\nv 0.123456 0.123456 0.123456\n";
    lines += 3;
  }
  const auto with_defect = folder.write("defect.obj", text + "f 1 2 99999999\n");
  const LoadedScene loaded = load(with_defect);
  ASSERT_EQ(loaded.defects.defects.size(), 1u);
  EXPECT_EQ(loaded.defects.defects[0].first_places[0],
            fmt::format("{}:{}", with_defect.string(), lines + 1));
  const auto malformed = folder.write("malformed.obj", text + "v 1 x 2\n");
  const auto result = read_scene(malformed, {}, {});
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.status().message().find(fmt::format(":{}: 'x'", lines + 1)), std::string::npos)
      << result.status().message();
}

// Names, places and colours go on where a new piece of the file begins.
TEST(Obj, NamesAndPlacesSurvivePieces) {
  const TempFolder folder;
  std::string text =
      "v 0 0 0 1 2 3\nv 1 0 0 1 2 3\nv 0 1 0 1 2 3\ng first\nf 1 2 3\ng second\nvt 0 0\n";
  std::size_t lines = 7;
  while (text.size() < (std::size_t{5} << 20)) {
    text += "# " + std::string(1000, 'x') + '\n';
    ++lines;
  }
  text +=
      "f 1 2 3\nv 0 0 1\nv nan 0 0\nnonsense\nmtllib gone.mtl\nusemtl a\n"
      "vt 0.5 0.5\nf 1/-1 2/-1 4/-1\n";
  const LoadedScene loaded = load(folder.write("a.obj", text));
  EXPECT_EQ(loaded.scene.object_names, (std::vector<std::string>{"first", "second"}));
  EXPECT_EQ(loaded.scene.triangle_object, (std::vector<std::uint32_t>{0, 1, 1}));
  EXPECT_EQ(loaded.scene.texcoord_indices.at(6), 1u) << "counted from the file's beginning";
  std::string places;
  for (const Defect& defect : loaded.defects.defects) {
    const std::string& place = defect.first_places[0];
    places += fmt::format("{} {};", name_of(defect.kind), place.substr(place.rfind("a.obj") + 5));
  }
  EXPECT_EQ(places, fmt::format("position_not_finite :{};illumination_missing : vertex 4;"
                                "material_file_missing :{});material_unknown :{}: 'a';"
                                "element_ignored :{};",
                                lines + 3, lines + 5, lines + 6, lines + 4));
}

// A rotation by a right angle in double precision leaves such numbers in place of 0.
TEST(Obj, CoordinatesThatAreNothingButRoundingAreZero) {
  const TempFolder folder;
  const auto path = folder.write("a.obj",
                                 "v 2.4e-16 0 -1e-15\nv 4 0 0\nv 4 3 1e-9\nv 0 3 -0.0\n"
                                 "f 1 2 3\nf 1 3 4\n");
  const Scene scene = load(path).scene;
  EXPECT_EQ(scene.positions[0], (Vec3f{0, 0, 0}));
  EXPECT_EQ(scene.positions[2], (Vec3f{4, 3, 1e-9f}));
  EXPECT_FALSE(std::signbit(scene.positions[3].z));
}

TEST(Obj, FarScenesGetAnOriginAndKeepTheirShape) {
  const TempFolder folder;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 20);
  std::vector<std::array<double, 3>> points;
  for (int i = 0; i < 300; ++i) points.push_back({unit(random), unit(random), unit(random)});
  const auto written = [&](const std::array<double, 3>& offset) {
    std::string text;
    for (const auto& p : points) {
      text += fmt::format("v {:.9f} {:.9f} {:.9f}\n", p[0] + offset[0], p[1] + offset[1],
                          p[2] + offset[2]);
    }
    for (int i = 1; i + 2 <= 300; ++i) text += fmt::format("f {} {} {}\n", i, i + 1, i + 2);
    return text + "v 0 0 0\n";  // a stray vertex that no triangle uses changes nothing
  };
  EXPECT_EQ(load(folder.write("near.obj", written({0, 0, 0}))).scene.origin, Vec3d{});
  EXPECT_EQ(load(folder.write("near.obj", written({-10, 8, -10}))).scene.origin, Vec3d{});
  for (const std::array<double, 3>& offset :
       {std::array<double, 3>{4.5e6, -7.25e6, 100}, {60, -40, 0}, {0, 0, 30}}) {
    const LoadedScene loaded = load(folder.write("far.obj", written(offset)));
    const double o[3] = {loaded.scene.origin.x, loaded.scene.origin.y, loaded.scene.origin.z};
    EXPECT_NE(loaded.scene.origin, Vec3d{});
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(o[k], std::round(o[k] / 16) * 16);
      EXPECT_NEAR(o[k], offset[k] + 10, 9);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3f& p = loaded.scene.positions[i];
      const double q[3] = {p.x, p.y, p.z};
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(o[k] + q[k], points[i][k] + offset[k], 1.1e-6);
    }
  }
}

TEST(Obj, AllModelsOfTheDataFolderLoad) {
  const auto models = test::shared_models();
  if (models.empty()) GTEST_SKIP() << test::lacks("models");
  for (const std::filesystem::path& path : models) {
    const auto loaded = read_scene(path, {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->defects.triangles_left_out, 0u) << path;
  }
}

TEST(Obj, TheRoomOfTheDataFolderLoads) {
  const auto data = test::shared_data("room");
  if (!data) GTEST_SKIP() << test::lacks("room");
  const auto room = read_scene(*data / "scene.obj", {}, {});
  ASSERT_TRUE(room.ok());
  EXPECT_EQ(room->scene.triangle_count(), 301709u);
  EXPECT_EQ(room->scene.textures.size(), 2u);
  EXPECT_TRUE(room->defects.empty());
}

}  // namespace
}  // namespace atlas

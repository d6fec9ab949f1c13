#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "libatlas/scene/text_scanner.h"
#include "tests/scene/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

LoadedScene load(const std::filesystem::path& path, const ReadOptions& options = {}) {
  auto loaded = read_scene(path, options, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  return loaded.ok() ? std::move(*loaded) : LoadedScene{};
}

TEST(TextScanner, NumbersAgreeWithTheLibrary) {
  std::mt19937_64 random(7);
  const char* formats[] = {"{}", "{:.3f}", "{:.17g}", "{:e}", "{:.0f}", "+{}", "{:.25f}"};
  for (int i = 0; i < 20000; ++i) {
    const double magnitude = std::exp(std::uniform_real_distribution<>(-40, 40)(random));
    const std::string text = fmt::format(fmt::runtime(formats[i % 7]), magnitude);
    for (const std::string& s : {text, text[0] == '+' ? text : "-" + text}) {
      const std::string line = "  " + s + " x\n";
      TextScanner scan(line.data(), line.data() + line.size() - 1);
      double value = 0;
      ASSERT_TRUE(scan.number(value)) << s;
      EXPECT_EQ(value, std::strtod(s.c_str(), nullptr)) << s;
      EXPECT_EQ(scan.word(), "x");
    }
  }
}

TEST(TextScanner, OddNumbers) {
  const auto parse = [](std::string s, double& value) {
    s += '\n';
    TextScanner scan(s.data(), s.data() + s.size() - 1);
    return scan.number(value);
  };
  double v = 0;
  for (const char* good : {"5.", ".5", "-.5e3", "1e5", "1E-5", "nan", "inf", "-inf", "+3"}) {
    EXPECT_TRUE(parse(good, v)) << good;
  }
  for (const char* bad : {"", ".", "-", "+-3", "1.2.3", "12a", "e5", "0x10", "1,5", "--1"}) {
    EXPECT_FALSE(parse(bad, v)) << bad;
  }
  EXPECT_TRUE(parse("1e999", v) && std::isinf(v));
  EXPECT_TRUE(parse("-1e999", v) && v < 0 && std::isinf(v));
  EXPECT_TRUE(parse("1e-999", v) && v == 0);
  EXPECT_TRUE(parse("1" + std::string(400, '0'), v) && std::isinf(v));
  EXPECT_TRUE(parse("0." + std::string(400, '0') + "1", v) && v == 0);
}

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

// As editors of other systems leave text: the first vertex must not go with the byte order mark.
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

  const auto wide = read_scene(folder.write("w.obj", "\xff\xfev"), {}, {});
  ASSERT_EQ(wide.status().code(), ErrorCode::unsupported);
  EXPECT_NE(wide.status().message().find("save it as UTF-8"), std::string::npos);
}

TEST(Obj, GroupsAreObjectsOnlyWithoutObjects) {
  const TempFolder folder;
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto groups = load(folder.write("g.obj", v + "g a\nf 1 2 3\ng b\nf 1 2 3\ng a\nf 3 2 1\n"));
  EXPECT_EQ(groups.scene.triangle_object, (std::vector<std::uint32_t>{0, 1, 0}));
  const auto both = load(folder.write("og.obj", v + "o x\ng a\nf 1 2 3\ng b\nf 1 2 3\n"));
  EXPECT_EQ(both.scene.object_names, std::vector<std::string>{"x"});
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

TEST(Obj, TexturesThatAreMissingOrBrokenFallBackToTheColour) {
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
  }
  EXPECT_EQ(loaded.scene.materials[0].texture, -1);
  EXPECT_EQ(loaded.scene.materials[0].diffuse, (Vec3f{0.1f, 0.2f, 0.3f}));
  ReadOptions options;
  options.load_textures = false;
  EXPECT_TRUE(load(path, options).defects.empty());
}

TEST(Obj, ATextureOfAnotherMachineIsFoundBesideTheMaterials) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "wood.png", Image8(2, 2, 3, 77), {}).ok());
  folder.write("m.mtl", "newmtl a\nmap_Kd C:\\Users\\me\\My Maps\\wood.png\n");
  const LoadedScene loaded = load(folder.write(
      "s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 2\nusemtl a\nf 1/1 2/1 3/1\n"));
  EXPECT_TRUE(loaded.defects.empty());
  ASSERT_EQ(loaded.scene.textures.size(), 1u);
  EXPECT_EQ(loaded.scene.textures[0].path.filename(), "wood.png");
}

// Options before a texture's name: what changes nothing is passed over, what cannot be followed is
// told.
TEST(Obj, TextureOptions) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "maps");
  ASSERT_TRUE(write_png(folder / "maps" / "a b.png", Image8(2, 2, 3, 77), {}).ok());
  const auto ignored = [&](const std::string& options) {
    folder.write("m.mtl", "newmtl a\nmap_Kd " + options + " maps\\a b.png\n");
    const LoadedScene loaded = load(folder.write(
        "s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 2\nusemtl a\nf 1/1 2/1 3/1\n"));
    EXPECT_EQ(loaded.scene.textures.size(), 1u) << options;
    EXPECT_EQ(loaded.scene.materials[0].texture, 0) << options;
    const std::uint64_t count = loaded.defects.count(DefectKind::texture_option_ignored);
    EXPECT_EQ(loaded.defects.empty(), count == 0) << options;
    return count;
  };
  for (const char* options : {"", "-mm 0 1", "-clamp off", "-blendu on", "-blendv off -cc off",
                              "-o 0", "-s 1 1 1 -mm 0 1.0 -o 0 0"}) {
    EXPECT_EQ(ignored(options), 0u) << options;
  }
  for (const char* options : {"-mm 0.5 1", "-mm 0 2", "-clamp on", "-t 0.1", "-t 0 0 1", "-bm 0.5",
                              "-imfchan r", "-texres 512"}) {
    EXPECT_EQ(ignored(options), 1u) << options;
  }
  EXPECT_EQ(ignored("-clamp on -mm 1 1 -blendu off"), 2u);
}

// A file of several pieces, with every trap at piece borders, against a reader of ten lines.
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
  EXPECT_NE(status_with("two.txt", "1 2\n").message().find("two.txt:1:"), std::string::npos);
  EXPECT_EQ(status_with("none.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\n").code(), ErrorCode::bad_input);
  ReadOptions missing;
  missing.illumination_file = folder / "nowhere.txt";
  EXPECT_EQ(read_scene(mesh, missing, {}).status().code(), ErrorCode::not_found);
}

// What is wrong with the second file's light is told, and told of that file; the first one's light
// is not used.
TEST(Illumination, DefectsAreTheSecondFiles) {
  const TempFolder folder;
  const auto mesh = folder.write(
      "mesh.obj", "v 0 0 0 nan 1 1\nv 1 0 0 1 1 1\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
  folder.write("light.obj", "v 0 0 0 1 2 3\nv 0 0 0 1 2 inf\nv 0 0 0 1 2 3\nv 0 0 0\n");
  folder.write("light.txt", "1\nnan\n-1\n4\n");
  const auto defects = [&](const std::string& name) {
    ReadOptions options;
    options.illumination_file = folder / name;
    return load(mesh, options).defects;
  };
  for (const char* name : {"light.obj", "light.txt"}) {
    const DefectReport report = defects(name);
    EXPECT_EQ(report.count(DefectKind::illumination_not_finite), 1u) << name;
    EXPECT_EQ(report.defects.size(), 2u) << name;
    for (const Defect& defect : report.defects)
      EXPECT_NE(defect.first_places.front().find(name), std::string::npos)
          << defect.first_places.front();
  }
  EXPECT_EQ(defects("light.obj").count(DefectKind::illumination_missing), 1u);
  EXPECT_EQ(defects("light.txt").count(DefectKind::illumination_negative), 1u);
}

TEST(Obj, AllModelsOfTheDataFolderLoad) {
  const char* data = std::getenv("LIBATLAS_DATA");
  if (!data) GTEST_SKIP() << "LIBATLAS_DATA is not set";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(data) + "/models")) {
    if (entry.path().extension() != ".obj") continue;
    const auto loaded = read_scene(entry.path(), {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->defects.triangles_left_out, 0u) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 10);
  const auto room = read_scene(std::string(data) + "/room/scene.obj", {}, {});
  ASSERT_TRUE(room.ok());
  EXPECT_EQ(room->scene.triangle_count(), 301709u);
  EXPECT_EQ(room->scene.textures.size(), 2u);
  EXPECT_TRUE(room->defects.empty());
}

}  // namespace
}  // namespace atlas

// Normals are read if they are asked for: from every format that has them, transformed with their
// surface, and repaired or left out where they are damaged.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <utility>

#include "libatlas/scene/check_scene.h"
#include "tests/scene/load_scene.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

LoadedScene load_normals(const std::filesystem::path& path) {
  LoadedScene loaded = load(path, {.normals = true});
  const Status sound = check_scene(loaded.scene);
  EXPECT_TRUE(sound.ok()) << sound.message();
  return loaded;
}

Vec3f normal_at(const Scene& scene, std::size_t corner) {
  return scene.normals.at(scene.normal_indices.at(corner));
}

void expect_near(const Vec3f& a, const Vec3f& b) {
  EXPECT_NEAR(a.x, b.x, 1e-6);
  EXPECT_NEAR(a.y, b.y, 1e-6);
  EXPECT_NEAR(a.z, b.z, 1e-6);
}

Vec3d face_normal(const Scene& scene, std::size_t triangle) {
  const auto at = [&](int c) { return scene.positions[scene.indices[3 * triangle + c]]; };
  const Vec3f a = at(0), b = at(1), c = at(2);
  const double u[3] = {b.x - a.x, b.y - a.y, b.z - a.z}, v[3] = {c.x - a.x, c.y - a.y, c.z - a.z};
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

const std::string kObjSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n";

TEST(Normals, AreLeftOutUnlessAskedFor) {
  const TempFolder folder;
  const auto obj = folder.write("a.obj", kObjSquare + "vn x\nf 1//9 2//9 3//9\n");
  const LoadedScene loaded = load(obj);  // a malformed line is skipped, too
  EXPECT_TRUE(loaded.scene.normals.empty() && loaded.scene.normal_indices.empty());
  EXPECT_TRUE(loaded.defects.empty());
  // If there are none, the arrays stay empty.
  const LoadedScene asked = load_normals(folder.write("b.obj", kObjSquare + "vn 0 0 1\nf 1 2 3\n"));
  EXPECT_TRUE(asked.scene.normals.empty() && asked.scene.normal_indices.empty());
}

TEST(Normals, OfObjPolygonsGoWithTheirCorners) {
  const TempFolder folder;
  const LoadedScene loaded = load_normals(folder.write(
      "a.obj", kObjSquare +
                   "vn 1 0 0\nvn 0 1 0\nvn 0 0 1\nvn 0 0 -2\n"
                   "f 1//1 2//2 3//3 4//4\nf 1/1/-4 2/1/-3 3/1/-2\nf 1 2 3\nf 1//1 2 3//3\n"));
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.triangle_count(), 5u);
  const Vec3f of_vertex[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(normal_at(scene, k), of_vertex[scene.indices[k]]);
  for (std::size_t k = 9; k < 15; ++k) EXPECT_EQ(scene.normal_indices[k], Scene::kNoNormal);
  EXPECT_EQ(loaded.defects.count(DefectKind::normal_partial), 1u);
  EXPECT_EQ(loaded.defects.count(DefectKind::normal_out_of_range), 0u);
}

// Long files are parsed in parallel chunks. Negative indices count from their own line.
TEST(Normals, OfLongObjFilesCountAcrossPieces) {
  const TempFolder folder;
  std::string text;
  const int faces = 60000;
  for (int i = 0; i < faces; ++i) {
    const double a = 0.001 * i;
    text += fmt::format("v {0} 0 0\nv {0} 1 0\nv {0} 0 1\nvn {1:.9f} {2:.9f} 0\n", i, std::cos(a),
                        std::sin(a));
    text += i % 2 ? "f -3//-1 -2//-1 -1//-1\n"
                  : fmt::format("f {}//{} {}//{} {}//{}\n", 3 * i + 1, i + 1, 3 * i + 2, i + 1,
                                3 * i + 3, i + 1);
  }
  ASSERT_GT(text.size(), std::size_t{4} << 20);
  const LoadedScene loaded = load_normals(folder.write("long.obj", text));
  EXPECT_TRUE(loaded.defects.empty());
  for (int i = 0; i < faces; i += 997)
    expect_near(normal_at(loaded.scene, 3 * std::size_t(i) + 1),
                {float(std::cos(0.001 * i)), float(std::sin(0.001 * i)), 0});
}

TEST(Normals, OutOfRangeAreDefectsOfTheFace) {
  const TempFolder folder;
  for (const char* index : {"2", "9", "0", "-2", "99999999999"}) {
    const LoadedScene loaded = load_normals(folder.write(
        "a.obj",
        kObjSquare + fmt::format("vn 0 0 1\nf 1//1 2//1 3//{}\nf 1//1 3//1 4//1\n", index)));
    EXPECT_EQ(loaded.defects.count(DefectKind::normal_out_of_range), 1u) << index;
    EXPECT_EQ(loaded.scene.triangle_count(), 2u);
    EXPECT_EQ(loaded.scene.normal_indices[2], Scene::kNoNormal);
    EXPECT_EQ(normal_at(loaded.scene, 3), (Vec3f{0, 0, 1}));
  }
}

TEST(Normals, LinesOfObjThatAreNoneEndTheReading) {
  const TempFolder folder;
  for (const char* line : {"vn", "vn 1 2", "vn 1 x 2"}) {
    const auto path = folder.write("a.obj", kObjSquare + line + "\nf 1 2 3\n");
    const auto loaded = read_scene(path, {.normals = true}, {});
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input) << line;
    EXPECT_NE(loaded.status().message().find("a.obj:6"), std::string::npos) << line;
  }
}

// Normals without direction take that of their triangles. Triangles without area have none to give.
TEST(Normals, WithoutDirectionAreReplacedAndCounted) {
  const TempFolder folder;
  for (const char* bad : {"0 0 0", "nan 0 1", "0 inf 0", "-1e999 0 0", "-1.#IND 0 0"}) {
    const LoadedScene loaded = load_normals(
        folder.write("a.obj", kObjSquare + fmt::format("vn {}\nvn {}\nvn 3 0 4\n"
                                                       "f 3//1 2//1 1//3\nf 1//2 1//2 1//2\n",
                                                       bad, bad)));
    EXPECT_EQ(loaded.defects.count(DefectKind::normal_unusable), 2u) << bad;
    EXPECT_EQ(normal_at(loaded.scene, 0), (Vec3f{0, 0, -1})) << bad;
    expect_near(normal_at(loaded.scene, 2), {0.6f, 0, 0.8f});
    EXPECT_EQ(normal_at(loaded.scene, 3), (Vec3f{0, 0, 1})) << bad;
  }
  // The triangles' edges span (0, 0, 4) and (3, 0, 0), together (3, 0, 4).
  const LoadedScene mean = load_normals(
      folder.write("mean.obj",
                   "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 3 0\nv 0 0 1\nvn 0 0 0\nf 1//1 2//1 3//1\n"
                   "f 1//1 4//1 5//1\n"));
  expect_near(normal_at(mean.scene, 0), {0.6f, 0, 0.8f});
}

std::string ply(const std::string& format, const std::string& data, const char* type = "float") {
  return fmt::format(
      "ply\nformat {0} 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty {1} nx\nproperty {1} ny\nproperty {1} nz\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n{2}",
      format, type, data);
}

TEST(Normals, OfPlyAreThoseOfTheVertices) {
  const TempFolder folder;
  const std::string ascii = "0 0 0 1 0 0\n1 0 0 0 1 0\n1 1 0 0 0 1\n0 1 0 0 0 -5\n4 0 1 2 3\n";
  const LoadedScene loaded = load_normals(folder.write("a.ply", ply("ascii", ascii)));
  EXPECT_TRUE(loaded.defects.empty());
  const Vec3f expected[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
  ASSERT_EQ(loaded.scene.triangle_count(), 2u);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_EQ(normal_at(loaded.scene, k), expected[loaded.scene.indices[k]]);
  std::string binary;
  const float rows[4][6] = {
      {0, 0, 0, 1, 0, 0}, {1, 0, 0, 0, 1, 0}, {1, 1, 0, NAN, 0, 1}, {0, 1, 0, 0, 0, -5}};
  binary.append(reinterpret_cast<const char*>(rows), sizeof rows);
  const std::int32_t corners[4] = {0, 1, 2, 3};
  binary += '\4';
  binary.append(reinterpret_cast<const char*>(corners), sizeof corners);
  const LoadedScene packed =
      load_normals(folder.write("b.ply", ply("binary_little_endian", binary)));
  EXPECT_EQ(packed.defects.count(DefectKind::normal_unusable), 1u);
  EXPECT_EQ(packed.scene.normals[2], (Vec3f{0, 0, 1}));  // its triangles'
  EXPECT_EQ(packed.scene.normals[3], (Vec3f{0, 0, -1}));
  for (std::size_t cut = 1; cut < binary.size(); cut += 5) {
    const auto path =
        folder.write("c.ply", ply("binary_little_endian", binary.substr(0, binary.size() - cut)));
    EXPECT_EQ(read_scene(path, {.normals = true}, {}).status().code(), ErrorCode::bad_input);
  }
  // Two of the three components do not make a normal.
  std::string two = ply("ascii", ascii);
  two.replace(two.find("nz\n"), 2, "qz");
  EXPECT_TRUE(load_normals(folder.write("d.ply", two)).scene.normals.empty());
}

TEST(Normals, OfOffInTextAndBinary) {
  const TempFolder folder;
  const LoadedScene text = load_normals(
      folder.write("a.off", "NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 1 0\n0 1 0 0 0 0\n3 0 1 2\n"));
  EXPECT_EQ(text.scene.normals[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(text.scene.normals[1], (Vec3f{0, 1, 0}));
  EXPECT_EQ(text.scene.normals[2], (Vec3f{0, 0, 1}));
  EXPECT_EQ(text.defects.count(DefectKind::normal_unusable), 1u);
  std::string data = "NOFF BINARY\n";
  const auto word = [&](auto value) {
    char bytes[4];
    std::memcpy(bytes, &value, 4);
    for (int i = 3; i >= 0; --i) data += bytes[i];  // big-endian, as Geomview writes it
  };
  for (const std::int32_t i : {3, 1, 0}) word(i);
  for (const float f : {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0}) word(f);
  for (const std::int32_t i : {3, 0, 1, 2, 0}) word(i);
  const LoadedScene binary = load_normals(folder.write("b.off", data));
  EXPECT_EQ(normal_at(binary.scene, 1), (Vec3f{0, 1, 0}));
  EXPECT_EQ(normal_at(binary.scene, 2), (Vec3f{1, 0, 0}));
}

// Transforms of every kind are applied to a slanted triangle. The normal stays perpendicular to it,
// on the side from which its corners run counter-clockwise, which mirroring swaps.
TEST(Normals, OfGltfStayPerpendicularUnderTransforms) {
  const TempFolder folder;
  const double s = 1 / std::sqrt(3.0);
  const float n = float(s);
  const json nodes[] = {
      {{"name", "as it is"}},
      {{"scale", {1, 5, 0.25}}},
      {{"scale", {-1, 1, 1}}},
      {{"scale", {-2, -3, -0.5}}, {"rotation", {0.5, 0.5, 0.5, 0.5}}},
      {{"scale", {1e-4, 1e-4, 1e-4}}},
      {{"scale", {1e-22, 2e-22, 3e-22}}},  // areas are too small and too large for floats
      {{"scale", {1e22, 2e22, 3e22}}},
      {{"matrix", {1, 0, 0, 0, 0.7, 1, 0, 0, 0.2, -0.3, 2, 0, 5, 6, 7, 1}}},
      {{"scale", {1, 1, 0}}},  // flat: the normal is that of the plane
  };
  for (const json& node : nodes) {
    Gltf gltf;
    const int positions = gltf.floats({1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3", 3);
    const int normals = gltf.floats({n, n, n, n, n, n, n, n, n}, "VEC3", 3);
    gltf.single({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}}, node);
    const LoadedScene loaded = load_normals(folder.write("a.glb", gltf.glb()));
    const Vec3d face = face_normal(loaded.scene, 0);
    const double length = std::hypot(face.x, face.y, face.z);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f m = normal_at(loaded.scene, k);
      EXPECT_NEAR((m.x * face.x + m.y * face.y + m.z * face.z) / length, 1, 1e-6) << node.dump();
    }
  }
}

TEST(Normals, OfGltfFollowSkinsMorphsAndInstances) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int normals = gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  const int moves = gltf.floats({0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3", 3);
  const int turns = gltf.floats({2, 0, -2, 2, 0, -2, 2, 0, -2}, "VEC3", 3);
  const json target = {{"POSITION", moves}, {"NORMAL", turns}};
  gltf.single({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
               {"targets", json::array({target})}},
              {{"weights", {0.5}}});
  expect_near(normal_at(load_normals(folder.write("m.glb", gltf.glb())).scene, 1), {1, 0, 0});
  // A joint that rotates z to y replaces the node's own transform.
  Gltf bent = gltf;
  const int joints = bent.accessor({{"bufferView", bent.view(std::vector<std::uint8_t>(12, 0))},
                                    {"componentType", 5121},
                                    {"type", "VEC4"},
                                    {"count", 3}});
  const int weights = bent.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  const double h = std::sqrt(0.5);
  bent.single({{"attributes",
                {{"POSITION", positions},
                 {"NORMAL", normals},
                 {"JOINTS_0", joints},
                 {"WEIGHTS_0", weights}}}},
              {{"skin", 0}, {"scale", {1, 1, 9}}});
  bent.j["nodes"].push_back({{"rotation", {-h, 0, 0, h}}});
  bent.j["skins"] = json::array({{{"joints", {1}}}});
  expect_near(normal_at(load_normals(folder.write("s.glb", bent.glb())).scene, 1), {0, 1, 0});
  Gltf many = gltf;
  const int turned = many.floats({0, 0, 0, 1, float(-h), 0, 0, float(h)}, "VEC4", 4);
  many.single(
      {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}},
      {{"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"ROTATION", turned}}}}}}}});
  const Scene scene = load_normals(folder.write("i.glb", many.glb())).scene;
  ASSERT_EQ(scene.triangle_count(), 2u);
  expect_near(normal_at(scene, 0), {0, 0, 1});
  expect_near(normal_at(scene, 3), {0, 1, 0});
}

TEST(Normals, OfGltfInAnotherNumberAreMalformed) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int normals = gltf.floats({0, 0, 1, 0, 0, 1}, "VEC3", 3);
  gltf.single({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}});
  const auto path = folder.write("a.glb", gltf.glb());
  const auto loaded = read_scene(path, {.normals = true}, {});
  EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
  EXPECT_NE(loaded.status().message().find("another number of normals"), std::string::npos);
  EXPECT_TRUE(read_scene(path, {}, {}).ok());
}

// Primitives that share one set of vertices, and one without normals.
TEST(Normals, OfGltfPrimitivesWithAndWithout) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats(kSquare, "VEC3", 3);
  const int normals = gltf.floats({0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0}, "VEC3", 3);
  const int first = gltf.indices<std::uint16_t>({0, 1, 2}),
            second = gltf.indices<std::uint16_t>({0, 2, 3});
  const json with = {{"POSITION", positions}, {"NORMAL", normals}};
  gltf.single({{"attributes", {{"POSITION", positions}}}, {"indices", first}});
  auto& primitives = gltf.j["meshes"][0]["primitives"];
  primitives.push_back({{"attributes", with}, {"indices", first}});
  primitives.push_back({{"attributes", with}, {"indices", second}});
  const LoadedScene loaded = load_normals(folder.write("a.glb", gltf.glb()));
  const Scene& scene = loaded.scene;
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(scene.normal_indices[k], Scene::kNoNormal);
  EXPECT_EQ(normal_at(scene, 4), (Vec3f{0, 1, 0}));
  EXPECT_EQ(normal_at(scene, 7), (Vec3f{1, 0, 0}));
  EXPECT_EQ(normal_at(scene, 8), (Vec3f{0, 0, 1}));  // its length was 0
  EXPECT_EQ(loaded.defects.count(DefectKind::normal_unusable), 1u);
}

// Whatever happens to the bytes, the result is an error or a scene that keeps its promises.
TEST(Normals, OfDamagedFilesAreSoundOrRefused) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats(kSquare, "VEC3", 3),
            normals = gltf.floats({0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1}, "VEC3", 3);
  gltf.single({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
               {"indices", gltf.indices<std::uint16_t>({0, 1, 2, 0, 2, 3})}});
  const std::pair<const char*, std::string> files[] = {
      {"d.glb", gltf.glb()},
      {"d.obj", kObjSquare + "vn 0 0 1\nvn 0 1 0\nf 1//1 2//2 3//-1\nf 1/1/1 3/1/2 4/1/2\n"},
      {"d.ply", ply("ascii", "0 0 0 1 0 0\n1 0 0 0 1 0\n1 1 0 0 0 1\n0 1 0 0 0 -5\n4 0 1 2 3\n")},
      {"d.off", "NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 1 0\n0 1 0 0 0 0\n3 0 1 2\n"}};
  std::mt19937 random(7);
  for (const auto& [name, good] : files) {
    int survived = 0;
    for (int round = 0; round < 300; ++round) {
      std::string bytes = good;
      if (round % 6 == 0) bytes.resize(1 + random() % bytes.size());
      for (int hits = 1 + int(random() % 3); hits > 0; --hits) {
        // Replacing digits with digits keeps most files readable. What glTF has at its end are
        // data.
        const std::size_t at = random() % bytes.size();
        const bool digit = bytes[at] >= '0' && bytes[at] <= '9';
        const bool data = &good == &files[0].second && at + gltf.bytes.size() >= good.size();
        if (digit) bytes[at] = char('0' + random() % 10);
        if (data || round % 6 == 1) bytes[at] = char(random());
      }
      const auto loaded = read_scene(folder.write(name, bytes), {.normals = true}, {});
      if (!loaded.ok()) continue;
      ++survived;
      const Status sound = check_scene(loaded->scene);
      ASSERT_TRUE(sound.ok()) << name << ' ' << round << ": " << sound.message();
    }
    EXPECT_GT(survived, 100) << name;
  }
}

}  // namespace
}  // namespace atlas::test

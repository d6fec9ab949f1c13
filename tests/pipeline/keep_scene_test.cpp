// Exports that keep the scene, from file to file: every corner keeps what it had, and gets the uvs
// of the same export without that option.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/kept_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using Triangles = std::vector<KeptTriangle>;

void export_to(const std::filesystem::path& scene, const std::filesystem::path& target, bool keep,
               int threads = 1) {
  const auto loaded = read_scene(
      scene, {.unlit_textures = keep, .encoded_textures = keep, .normals = keep, .rest = keep}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ExportOptions options;
  options.target = target;
  options.charts_only = true;
  options.keep_scene = keep;
  options.packing = PackPreset::fast;
  Context context;
  context.threads = threads;
  const auto report = export_world(*loaded, options, {}, context);
  ASSERT_TRUE(report.ok()) << report.status().message();
}

auto tuple_of(const Vec3f& v) {
  return std::tuple(v.x, v.y, v.z);
}
auto tuple_of(const Vec2f& v) {
  return std::tuple(v.x, v.y);
}

// Returns everything except the new uvs.
auto own_of(const KeptTriangle& t) {
  const auto corner = [&](int c) {
    const KeptCorner& k = t.corners[std::size_t(c)];
    return std::tuple(tuple_of(k.position), tuple_of(k.normal), tuple_of(k.texcoord));
  };
  return std::tuple(t.object, t.material, t.has_normals, t.has_texcoords,
                    std::array{corner(0), corner(1), corner(2)});
}

Triangles sorted(Triangles triangles) {
  std::stable_sort(
      triangles.begin(), triangles.end(),
      [](const KeptTriangle& a, const KeptTriangle& b) { return own_of(a) < own_of(b); });
  return triangles;
}

// Adds the uvs that the export without the option gives to the input's triangles. These keep their
// order; those that the export reverses begin with another corner.
void add_plain_uvs(const std::filesystem::path& plain, Triangles& input) {
  const Triangles written = read_kept_obj(plain);
  ASSERT_EQ(written.size(), input.size());
  int turned_round = 0;
  for (std::size_t t = 0; t < input.size(); ++t) {
    std::array<bool, 3> taken{};
    for (KeptCorner& corner : input[t].corners) {
      std::size_t c = 0;
      while (c < 3 && (taken[c] || written[t].corners[c].position != corner.position)) ++c;
      ASSERT_LT(c, 3u) << "triangle " << t;
      taken[c] = true;
      corner.uv = written[t].corners[c].texcoord;
    }
    turned_round += written[t].corners[1].position != input[t].corners[1].position;
  }
  EXPECT_GT(turned_round, 0);
}

void expect_kept(const Triangles& input, const Triangles& written, double tolerance) {
  ASSERT_EQ(input.size(), written.size());
  const Triangles a = sorted(input), b = sorted(written);
  for (std::size_t t = 0; t < a.size(); ++t) {
    ASSERT_EQ(own_of(a[t]), own_of(b[t])) << t << " of " << a[t].object;
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(a[t].corners[c].uv.x, b[t].corners[c].uv.x, tolerance);
      ASSERT_NEAR(a[t].corners[c].uv.y, b[t].corners[c].uv.y, tolerance);
    }
  }
}

// Returns three shapes as objects that are divided among three materials. They have their own
// normals and uvs, which some faces lack. All numbers have few digits, so that nothing is rounded.
// One triangle of each is reversed, one has no area, and one is duplicated.
std::string made_obj() {
  std::string text = "mtllib m.mtl\n";
  const std::pair<const char*, Shape> objects[] = {
      {"a ring", torus(24, 12)}, {"crate", box(3)}, {"ball", icosphere(2)}};
  std::size_t base = 1;
  for (const auto& [name, shape] : objects) {
    text += fmt::format("o {}\n", name);
    for (std::size_t i = 0; i < shape.positions.size(); ++i) {
      const Vec3f p = shape.positions[i];
      text += fmt::format("v {:.4f} {:.4f} {:.4f}\nvt {} {}\nvn {}\n", p.x, p.y, p.z,
                          double(i % 97) / 64, -double(i % 31) / 64,
                          i % 3 == 0 ? "0 0 1" : "0.6 0 -0.8");
    }
    const auto face = [&](std::array<std::uint32_t, 3> v, int kind) {
      text += "f";
      for (const std::uint32_t i : v) {
        const std::size_t k = base + i;
        text += kind == 1   ? fmt::format(" {0}//{0}", k)
                : kind == 2 ? fmt::format(" {0}/{0}", k)
                            : fmt::format(" {0}/{0}/{0}", k);
      }
      text += "\n";
    };
    const std::size_t count = shape.indices.size() / 3;
    for (std::size_t t = 0; t < count; ++t) {
      const std::uint32_t* v = &shape.indices[3 * t];
      if (t % 7 == 0)
        text += fmt::format("usemtl {}\n", t % 3 == 0 ? "plain red" : t % 3 == 1 ? "b" : "c");
      face(t == 5 ? std::array{v[1], v[0], v[2]} : std::array{v[0], v[1], v[2]}, t % 11 == 4   ? 1
                                                                                 : t % 13 == 5 ? 2
                                                                                               : 0);
      if (t == 9) face({v[0], v[1], v[2]}, 0);
      if (t == 10) face({v[0], v[1], v[1]}, 0);
    }
    base += shape.positions.size();
  }
  return text;
}

// Returns what remains in an OBJ, whose only texcoords are the new uvs.
Triangles without_texcoords(Triangles triangles) {
  for (KeptTriangle& t : triangles) {
    t.has_texcoords = true;
    for (KeptCorner& c : t.corners) c.texcoord = c.uv;
  }
  return triangles;
}

TEST(KeepScene, AnObjToGltfAndObj) {
  const TempFolder folder;
  folder.write("m.mtl", "newmtl plain red\nKd 1 0 0\nnewmtl b\nKd 0 0.5 0\nnewmtl c\nKd 0 0 1\n");
  const auto scene = folder.write("scene.obj", made_obj());
  Triangles input = read_kept_obj(scene);
  export_to(scene, folder / "plain.obj", false);
  add_plain_uvs(folder / "plain.obj", input);
  for (const char* name : {"kept.glb", "kept.gltf"}) {
    export_to(scene, folder / name, true);
    Triangles written = read_kept_gltf(folder / name);
    // A corner without its own uvs has the new ones in both sets.
    for (KeptTriangle& t : written)
      for (KeptCorner& c : t.corners)
        if (!t.has_texcoords) c.texcoord = {};
    expect_kept(input, written, 1e-7);
  }
  export_to(scene, folder / "kept.obj", true);
  Triangles written = read_kept_obj(folder / "kept.obj");
  for (KeptTriangle& t : written)
    for (KeptCorner& c : t.corners) c.uv = c.texcoord;
  expect_kept(without_texcoords(input), written, 0);
}

TEST(KeepScene, IsTheSameForAnyNumberOfThreads) {
  const TempFolder folder;
  const auto scene = folder.write("scene.obj", made_obj());
  for (const char* name : {"w.glb", "w.obj"}) {
    export_to(scene, folder / name, true, 1);
    const std::string one = TempFolder::read(folder / name);
    export_to(scene, folder / name, true, 3);
    EXPECT_EQ(TempFolder::read(folder / name), one);
  }
}

Vec3f in_world(const OracleTriangle& t, std::size_t corner) {
  const double* p = &t.attributes.at("POSITION")[3 * corner];
  const auto row = [&](std::size_t r) {
    const std::vector<double>& m = t.matrix;
    return float(m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
  };
  return {row(0), row(1), row(2)};
}

double distance(const Vec3f& a, const Vec3f& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

// Expects the new uvs of each corner to be those of the export without the option, which has the
// triangles in world space and in the same order. Corners are found by position.
void expect_plain_uvs(const std::vector<OracleTriangle>& kept, const std::string& set,
                      const std::filesystem::path& plain) {
  const Triangles written = read_kept_obj(plain);
  ASSERT_EQ(written.size(), kept.size());
  for (std::size_t t = 0; t < kept.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& corners = written[t].corners;
      const auto same = std::min_element(corners.begin(), corners.end(), [&](auto& a, auto& b) {
        return distance(a.position, in_world(kept[t], c)) <
               distance(b.position, in_world(kept[t], c));
      });
      ASSERT_LT(distance(same->position, in_world(kept[t], c)), 1e-5) << t;
      const double* uv = &kept[t].attributes.at(set)[2 * c];
      ASSERT_NEAR(uv[0], same->texcoord.x, 1e-6) << t;
      ASSERT_NEAR(1 - uv[1], same->texcoord.y, 1e-6) << t;
    }
  }
}

// The nodes are kept, and so are the corners of a mirrored node's triangles. Each of the two
// instances has its own charts, which do not overlap those of the other.
TEST(KeepScene, MirroredNodesOfAGltf) {
  const TempFolder folder;
  Gltf gltf;
  const Shape shape = noisy(torus(12, 8), 0.02, 3);
  std::vector<float> positions, normals, uvs;
  for (std::size_t i = 0; i < shape.positions.size(); ++i) {
    const Vec3f p = shape.positions[i];
    positions.insert(positions.end(), {p.x, p.y, p.z});
    normals.insert(normals.end(), {0, i % 2 ? 0.6f : 1.f, i % 2 ? 0.8f : 0.f});
    uvs.insert(uvs.end(), {float(i % 16) / 16, float(i / 16) / 16});
  }
  const json attributes = {{"POSITION", gltf.floats(positions, "VEC3", 3)},
                           {"NORMAL", gltf.floats(normals, "VEC3", 3)},
                           {"TEXCOORD_0", gltf.floats(uvs, "VEC2", 2)}};
  gltf.single({{"attributes", attributes}, {"indices", gltf.indices(shape.indices)}},
              {{"name", "left"}});
  gltf.j["nodes"].push_back(
      {{"name", "right"}, {"mesh", 0}, {"scale", {-1, 1, 1}}, {"translation", {-8, 0, 0}}});
  gltf.j["scenes"][0]["nodes"] = {0, 1};
  const auto scene = folder.write("scene.glb", gltf.glb());
  export_to(scene, folder / "w.glb", true);
  const auto before = GltfOracle(scene).triangles(),
             after = GltfOracle(folder / "w.glb").triangles();
  ASSERT_EQ(before.size(), 2 * shape.indices.size() / 3);
  ASSERT_EQ(after.size(), before.size());
  double areas[2] = {0, 0};  // areas of uvs, which glTF counts clockwise
  for (std::size_t t = 0; t < after.size(); ++t) {
    EXPECT_EQ(after[t].node, before[t].node);
    EXPECT_EQ(after[t].matrix, before[t].matrix);
    for (const auto& [name, values] : before[t].attributes)
      EXPECT_EQ(after[t].attributes.at(name), values) << name;
    const std::vector<double>& uv = after[t].attributes.at("TEXCOORD_1");
    areas[after[t].node == "right"] +=
        ((uv[4] - uv[0]) * (uv[3] - uv[1]) - (uv[2] - uv[0]) * (uv[5] - uv[1])) / 2;
  }
  EXPECT_GT(areas[0], 0.2);
  EXPECT_LT(areas[1], -0.2);  // the file has its corners in reverse order
  EXPECT_LT(areas[0] - areas[1], 1);
  // Charts of what is inside out may come out otherwise, so uvs are compared without the mirror.
  gltf.j["nodes"].back().erase("scale");
  const auto unmirrored = folder.write("unmirrored.glb", gltf.glb());
  export_to(unmirrored, folder / "kept.glb", true);
  export_to(unmirrored, folder / "plain.obj", false);
  expect_plain_uvs(GltfOracle(folder / "kept.glb").triangles(), "TEXCOORD_1", folder / "plain.obj");
}

// Reading removes the origin of a scene that is far from zero; writing adds it again.
TEST(KeepScene, TheOriginIsAddedAgain) {
  const TempFolder folder;
  const auto scene =
      folder.write("far.obj",
                   "o a\nv 500000 4000000 0\nv 500001 4000000 0\nv 500000 4000001.25 0\nvn 0 0 1\n"
                   "f 1//1 2//1 3//1\n");
  export_to(scene, folder / "w.obj", true);
  EXPECT_NE(TempFolder::read(folder / "w.obj").find("v 5e+05 4000001.25 0\n"), std::string::npos);
  export_to(scene, folder / "w.glb", true);
  const auto back = read_scene(folder / "w.glb", {}, {});
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->scene.origin.y + back->scene.positions[2].y, 4000001.25);
}

TEST(KeepScene, IsRefusedForVrml) {
  const TempFolder folder;
  const LoadedScene lit = lit_scene(box(2));
  ExportOptions options;
  options.target = folder / "w.glb";
  options.charts_only = options.keep_scene = true;
  EXPECT_TRUE(export_world(lit, options, {}, {}).ok());
  options.target = folder / "w.wrl";
  EXPECT_EQ(export_world(lit, options, {}, {}).status().code(), ErrorCode::bad_option);
  EXPECT_EQ(folder.count(), 1u);
}

// Textures that were not decoded cannot be used for baking. Luminance includes the reflectance.
TEST(KeepScene, EncodedTexturesAreNotBaked) {
  const TempFolder folder;
  LoadedScene lit = lit_scene(box(2));
  lit.scene.textures.resize(1);
  lit.scene.textures[0].encoded = {0xff, 0xd8, 0xff, 0xe0};
  ExportOptions options;
  options.target = folder / "w.glb";
  const auto baked = export_world(lit, options, {}, {});
  EXPECT_EQ(baked.status().code(), ErrorCode::bad_input);
  EXPECT_NE(baked.status().message().find("textures[0] has no image"), std::string::npos);
  options.quantity = Quantity::luminance;
  EXPECT_TRUE(export_world(lit, options, {}, {}).ok());
}

// This is the recipe of docs/library.md.
Status add_lightmap_uvs(const char* from, const char* to) {
  const auto loaded = read_scene(from, {.keep_scene = true}, {});
  if (!loaded.ok()) return loaded.status();
  const ExportOptions options{.target = to, .charts_only = true, .keep_scene = true};
  return export_world(*loaded, options, {}, {}).status();
}

// The scene has two nodes, one of which shows nothing, a shiny material, and a camera.
std::filesystem::path shiny_scene(const TempFolder& folder) {
  Gltf gltf;
  gltf.j["materials"] = json::array(
      {{{"name", "steel"},
        {"pbrMetallicRoughness", {{"metallicFactor", 0.9}, {"roughnessFactor", 0.2}}}}});
  gltf.j["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}});
  gltf.single({{"attributes", {{"POSITION", gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}},
               {"material", 0}});
  gltf.j["nodes"].push_back({{"name", "empty"}, {"camera", 0}});
  gltf.j["nodes"][0]["children"] = {1};
  return folder.write("shiny.glb", gltf.glb());
}

TEST(KeepScene, RecipeForLightmapsKeepsWhatGltfHas) {
  const TempFolder folder;
  const std::filesystem::path input = shiny_scene(folder), output = folder / "out.glb";
  const Status status = add_lightmap_uvs(input.c_str(), output.c_str());
  ASSERT_TRUE(status.ok()) << status.message();
  const json after = GltfOracle(output).document;
  const json& surface = after["materials"][0]["pbrMetallicRoughness"];
  EXPECT_EQ(surface["metallicFactor"], 0.9);
  EXPECT_EQ(surface["roughnessFactor"], 0.2);
  ASSERT_EQ(after["nodes"].size(), 2u);
  EXPECT_EQ(after["nodes"][1]["name"], "empty");
  EXPECT_TRUE(GltfOracle(output).triangles()[0].attributes.contains("TEXCOORD_1"));
}

// Nothing is lost in silence where the scene was read without its rest.
TEST(KeepScene, WhatWasNotReadIsToldAsNotKept) {
  const TempFolder folder;
  const std::filesystem::path input = shiny_scene(folder);
  for (const char* name : {"out.glb", "out.obj"}) {
    const auto loaded = read_scene(input, {.encoded_textures = true, .normals = true}, {});
    ASSERT_TRUE(loaded.ok());
    const ExportOptions options{.target = folder / name, .charts_only = true, .keep_scene = true};
    const auto report = export_world(*loaded, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    const std::vector<std::string> lost = {
        "1 x cameras", "1 x materials of more than a base colour",
        "1 x nodes with transforms or children, applied to what they show"};
    EXPECT_EQ(report->not_kept, lost) << name;
  }
}

// A mesh that is not shown is kept, so it is not among what is not.
TEST(KeepScene, MeshesThatAreNotShownAreToldApart) {
  const TempFolder folder;
  Gltf gltf;
  gltf.single(
      {{"attributes", {{"POSITION", gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}}});
  for (const std::size_t unseen : {0, 1, 2}) {
    const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), {.keep_scene = true}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const ExportOptions options{
        .target = folder / "w.glb", .charts_only = true, .keep_scene = true};
    const auto report = export_world(*loaded, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    EXPECT_TRUE(report->not_kept.empty());
    ASSERT_EQ(report->advice.size(), unseen == 0 ? 0u : 1u);
    const std::string line = unseen == 0 ? "" : report->advice[0];
    EXPECT_TRUE(line.starts_with(unseen == 0   ? ""
                                 : unseen == 1 ? "1 mesh stays as before, without"
                                               : "2 meshes stay as before, without"))
        << line;
    gltf.j["meshes"].push_back(gltf.j["meshes"][0]);
  }
}

TEST(KeepScene, LinesOfMtlThatWereNotReadAreToldAsNotKept) {
  const TempFolder folder;
  folder.write("s.mtl", "newmtl used\nKd 1 0 0\nNs 30\nKs 1 1 1\nnewmtl unused\nKs 1 1 1\n");
  const auto input =
      folder.write("s.obj", "mtllib s.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl used\nf 1 2 3\n");
  const auto loaded = read_scene(input, {}, {});
  ASSERT_TRUE(loaded.ok());
  EXPECT_TRUE(loaded->scene.materials[0].mtl_lines.empty());
  const ExportOptions options{
      .target = folder / "out.glb", .charts_only = true, .keep_scene = true};
  const auto report = export_world(*loaded, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  const std::vector<std::string> lost = {"1 x lines of the MTL: Ks", "1 x lines of the MTL: Ns"};
  EXPECT_EQ(report->not_kept, lost);
}

}  // namespace
}  // namespace atlas::test

// Tests which properties of PLY a scene takes: the names of colours and texture coordinates, and
// the textures that MeshLab names.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "libatlas/core/srgb.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/load_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::load;
using test::TempFolder;

// Programs name the same properties differently.
TEST(Ply, NamesOfColoursAndTexcoords) {
  const TempFolder folder;
  const std::array<const char*, 3> colours[] = {
      {"r", "g", "b"},
      {"illumination_r", "illumination_g", "illumination_b"},
      {"illuminance_r", "illuminance_g", "illuminance_b"},
      {"diffuse_red", "diffuse_green", "diffuse_blue"}};
  const std::array<const char*, 2> texcoords[] = {
      {"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
  for (const auto& names : colours) {
    for (const auto& uv : texcoords) {
      std::string header = "ply\nformat ascii 1.0\nobj_info none\nelement vertex 3\n";
      for (const char* name : {"x", "y", "z", names[0], names[1], names[2], uv[0], uv[1]})
        header += std::string("property float ") + name + "\n";
      const auto loaded = read_scene(
          folder.write("n.ply",
                       header + "element face 1\nproperty list uchar int vertex_indices\n"
                                "element vertex 0\nproperty float x\nend_header\n"
                                "0 0 0 1 2 3 .25 .5\n1 0 0 4 5 6 0 0\n0 1 0 7 8 9 0 0\n3 0 1 2\n"),
          {}, {});
      ASSERT_TRUE(loaded.ok()) << loaded.status().message();
      ASSERT_TRUE(loaded->scene.lit()) << names[0];
      EXPECT_EQ(loaded->scene.illumination[1], (Vec3f{4, 5, 6})) << names[0];
      ASSERT_FALSE(loaded->scene.texcoord_indices.empty()) << uv[0];
      EXPECT_EQ(loaded->scene.texcoords[0], (Vec2f{.25f, .5f})) << uv[0];
    }
  }
}

// In PLY, neither a backslash at the end of a line nor a '#' means anything.
TEST(Ply, BackslashesAndHashesMeanNothing) {
  const TempFolder folder;
  const Scene scene =
      load(folder.write("c.ply",
                        "ply\nformat ascii 1.0\ncomment made in C:\\models\\\n"
                        "comment TextureFile wall #2.png\nobj_info C:\\\nelement vertex 3\n"
                        "property float x\nproperty float y\nproperty float z\nelement face 1\n"
                        "property list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"))
          .scene;
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_EQ(scene.materials[0].name, "wall #2.png");
}

// Colours are decoded only where they are asked for, are not linear by their name, and lie within
// 0 to 1.
TEST(Ply, ColoursOfScansAreDecoded) {
  const TempFolder folder;
  const auto file = [&](const char* type, const std::array<const char*, 3>& names,
                        const char* values) {
    std::string header = "ply\nformat ascii 1.0\nelement vertex 3\n";
    for (const char* name : {"x", "y", "z"}) header += fmt::format("property float {}\n", name);
    for (const char* name : names) header += fmt::format("property {} {}\n", type, name);
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    return folder.write("c.ply",
                        header + fmt::format("0 0 0 {0}\n1 0 0 {0}\n0 1 0 {0}\n3 0 1 2\n", values));
  };
  const ReadOptions scan{.srgb_colours = true};
  const auto bytes = file("uchar", {"red", "green", "blue"}, "128 0 255");
  EXPECT_EQ(load(bytes).scene.illumination[1], (Vec3f{128 / 255.0f, 0, 1}));
  const Vec3f decoded = load(bytes, scan).scene.illumination[1];
  EXPECT_EQ(srgb_encode8(decoded.x), 128);
  EXPECT_EQ(decoded.y, 0);
  EXPECT_EQ(decoded.z, 1);
  const auto floats = file("float", {"red", "green", "blue"}, "0.5 2 -1");
  EXPECT_EQ(load(floats, scan).scene.illumination[0], (Vec3f{srgb_decode(0.5f), 2, -1}));
  const auto light = file("float", {"illuminance_r", "illuminance_g", "illuminance_b"}, "0.5 0 1");
  EXPECT_EQ(load(light, scan).scene.illumination[0], (Vec3f{0.5f, 0, 1}));
}

// MeshLab writes textures like this: a comment for each, and a number in each face.
// A square of two triangles, whose faces have more properties.
std::string square_of_faces(const std::string& properties, const std::string& first,
                            const std::string& second) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face 2\nproperty list uchar int vertex_indices\n" +
         properties + "end_header\n0 0 0\n2 0 0\n2 3 0\n0 3 0\n3 0 1 2 " + first + "\n3 0 2 3 " +
         second + "\n";
}

std::string properties_of(const std::string& type, const std::vector<const char*>& names) {
  std::string lines;
  for (const char* name : names) lines += fmt::format("property {} {}\n", type, name);
  return lines;
}

TEST(Ply, ColoursOfFacesAreThoseOfTheirCorners) {
  const TempFolder folder;
  struct Case {
    const char* type;
    std::vector<const char*> names;
    const char *first, *second;
    Vec3f light[2];
  };
  const Case cases[] = {
      {"uchar",
       {"red", "green", "blue"},
       "51 0 255",
       "0 1 2",
       {{0.2f, 0, 1}, {0, 1 / 255.f, 2 / 255.f}}},
      {"ushort", {"red", "green", "blue"}, "13107 0 65535", "0 0 0", {{0.2f, 0, 1}, {0, 0, 0}}},
      {"float", {"red", "green", "blue"}, "0.2 0 7", "1 1 1", {{0.2f, 0, 7}, {1, 1, 1}}},
      {"float", {"r", "g", "b"}, "1 2 3", "4 5 6", {{1, 2, 3}, {4, 5, 6}}},
      {"double", {"illuminance"}, "9", "8", {{9, 9, 9}, {8, 8, 8}}},
      {"uchar",
       {"diffuse_red", "diffuse_green", "diffuse_blue"},
       "255 0 0",
       "0 255 0",
       {{1, 0, 0}, {0, 1, 0}}}};
  for (const Case& c : cases) {
    const Scene scene = load(folder.write("f.ply", square_of_faces(properties_of(c.type, c.names),
                                                                   c.first, c.second)))
                            .scene;
    ASSERT_TRUE(scene.lit()) << c.type << " " << c.names[0];
    EXPECT_EQ(scene.positions.size(), 6u);
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_EQ(scene.illumination[scene.indices[k]], c.light[k / 3])
          << c.type << " " << c.names[0];
  }
  const Scene same =
      load(folder.write("s.ply", square_of_faces(properties_of("uchar", {"red", "green", "blue"}),
                                                 "9 8 7", "9 8 7")))
          .scene;
  EXPECT_EQ(same.positions.size(), 4u);
}

// They are colours of scans like those of vertices, and linear by the same names.
TEST(Ply, ColoursOfFacesAreDecoded) {
  const TempFolder folder;
  const auto first = [&](std::vector<const char*> names) {
    return load(folder.write("f.ply",
                             square_of_faces(properties_of("float", names), "0.5 1 2", "0 0 0")),
                {.srgb_colours = true})
        .scene.illumination[0];
  };
  EXPECT_EQ(first({"red", "green", "blue"}), (Vec3f{srgb_decode(0.5f), 1, 2}));
  EXPECT_EQ(first({"illuminance_r", "illuminance_g", "illuminance_b"}), (Vec3f{0.5f, 1, 2}));
}

TEST(Ply, ColoursOfFacesGiveWayToThoseOfVertices) {
  const TempFolder folder;
  const std::string rgb = properties_of("uchar", {"red", "green", "blue"});
  const LoadedScene loaded = load(
      folder.write("f.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                   "property float z\n" +
                       rgb + "element face 1\nproperty list uchar int vertex_indices\n" + rgb +
                       "end_header\n0 0 0 255 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2 0 255 0\n"));
  EXPECT_EQ(loaded.scene.illumination[0], (Vec3f{1, 0, 0}));
  ASSERT_EQ(loaded.defects.count(DefectKind::element_ignored), 1u);
  EXPECT_NE(loaded.defects.lines()[0].find("colours of faces"), std::string::npos);
}

TEST(Ply, AlphaOfFacesIsKept) {
  const TempFolder folder;
  const auto path = folder.write(
      "f.ply", square_of_faces(properties_of("uchar", {"red", "green", "blue", "alpha"}),
                               "9 8 7 51", "9 8 7 255"));
  const Scene scene = load(path, {.rest = true}).scene;
  ASSERT_EQ(scene.vertex_opacity.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_EQ(scene.vertex_opacity[scene.indices[k]], k < 3 ? 0.2f : 1);
}

TEST(Ply, TexturesAreNamedInComments) {
  const TempFolder folder;
  const auto path =
      folder.write("t.ply",
                   "ply\nformat ascii 1.0\ncomment TextureFile a b.png\ncomment TextureFile c.png\n"
                   "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "property float illuminance\n"
                   "element face 7\nproperty list uchar int vertex_indices\n"
                   "property list uchar float texcoord\nproperty int texnumber\nend_header\n"
                   "0 0 0 1\n1 0 0 2\n0 1 nan 3\n"
                   "3 0 1 1 6 0 0 1 0 0.5 1 1\n3 0 1 0 6 0 0 1 0 0 1 0\n3 0 0 1 6 0 0 1 0 0 1 7\n"
                   "3 0 1 2 6 0 0 1 0 0 1 0\n3 0 1 1 6 0 0 1 0 0 1 -1\n"
                   "3 0 1 1 6 0 0 1 0 0 1 2\n3 0 1 1 6 0 0 1 0 0 1 -2\n");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.triangle_count(), 6u);
  ASSERT_EQ(s.materials.size(), 3u);
  EXPECT_EQ(s.materials[s.triangle_material[0]].name, "c.png");
  EXPECT_EQ(s.materials[s.triangle_material[1]].name, "a b.png");
  EXPECT_EQ(s.triangle_material[2], 2u);  // no texture has that number
  EXPECT_EQ(s.triangle_material[3], 2u);  // -1: the face has no texture
  EXPECT_EQ(s.triangle_material[4], 2u);
  EXPECT_EQ(s.triangle_material[5], 2u);
  EXPECT_EQ(s.materials[2].name, "");
  EXPECT_EQ(loaded->defects.count(DefectKind::material_unknown), 3u);
  EXPECT_EQ(s.texcoords[s.texcoord_indices[2]], (Vec2f{0.5f, 1}));
  EXPECT_EQ(s.illumination[1], (Vec3f{2, 2, 2}));
  EXPECT_EQ(loaded->defects.count(DefectKind::texture_missing), 2u);
  EXPECT_EQ(loaded->defects.count(DefectKind::bad_position_used), 1u);
  for (const Defect& d : loaded->defects.defects) {
    if (d.kind == DefectKind::position_not_finite) {
      EXPECT_EQ(d.first_places[0], path.string() + ":17");
    }
    if (d.kind == DefectKind::material_unknown) {
      EXPECT_EQ(
          d.first_places[0],
          path.string() + ":20: texnumber 7, but the textures are 0 to 1 (name all in the header)");
    }
  }
}

// A list must be read by its values. Its length, here 1, is no texture's number.
TEST(Ply, TextureNumbersInLists) {
  const TempFolder folder;
  const auto path =
      folder.write("t.ply",
                   "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\n"
                   "comment TextureFile c.png\nelement vertex 3\nproperty float x\n"
                   "property float y\nproperty float z\nelement face 6\n"
                   "property list uchar int vertex_indices\n"
                   "property list uchar int texnumber\nend_header\n"
                   "0 0 0\n1 0 0\n0 1 0\n"
                   "3 0 1 2 1 2\n3 0 1 2 1 0\n3 0 1 2 3 1 1 1\n3 0 1 2 3 1 1 2\n3 0 1 2 0\n"
                   "3 0 1 2 1 9\n");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  std::vector<std::string> names;
  for (const std::uint32_t m : s.triangle_material) names.push_back(s.materials[m].name);
  EXPECT_EQ(names, (std::vector<std::string>{"c.png", "a.png", "b.png", "", "", ""}));
  EXPECT_EQ(loaded->defects.count(DefectKind::material_unknown), 2u);
  for (const Defect& d : loaded->defects.defects) {
    if (d.kind == DefectKind::material_unknown) {
      EXPECT_EQ(d.first_places[0],
                path.string() + ":20: texnumber has different values (give the face one)");
    }
  }
}

// Numbers mean nothing where no texture is named.
TEST(Ply, TextureNumbersWithoutTextures) {
  const TempFolder folder;
  const auto path = folder.write("t.ply",
                                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                 "property float y\nproperty float z\nelement face 2\n"
                                 "property list uchar int vertex_indices\n"
                                 "property list uchar int texnumber\nend_header\n"
                                 "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 3 0 1 2\n3 0 1 2 1 0\n");
  const auto loaded = read_scene(path, {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.materials.size(), 1u);
  EXPECT_TRUE(loaded->defects.empty());
}

// What a scene has no arrays for is counted if the scene is to be kept.
TEST(Ply, CountsPropertiesThatASceneCannotHold) {
  const TempFolder folder;
  const auto path = folder.write(
      "t.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar alpha\nproperty float quality\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property int texnumber\nproperty uchar red\nproperty float alpha\nend_header\n"
      "0 0 0 0 0 1 9 9 9 255 1\n1 0 0 0 0 1 9 9 9 254 2\n0 1 0 0 0 1 9 9 9 0 3\n"
      "3 0 1 2 6 0 0 1 0 0 1 0 7 1\n3 0 1 2 6 0 0 1 0 0 1 0 8 1\n");
  ReadOptions options;
  options.keep_scene = true;
  options.load_textures = false;
  const auto kept = read_scene(path, options, {});
  ASSERT_TRUE(kept.ok()) << kept.status().message();
  EXPECT_EQ(kept->scene.not_read, (LossCounts{{"textures of materials", 1},
                                              {"values of faces: red", 2},
                                              {"values of vertices: quality", 3}}));
  EXPECT_EQ(kept->scene.vertex_opacity, (std::vector<float>{1, 254 / 255.0f, 0}));
  const auto read = read_scene(path, {}, {});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->scene.not_read, LossCounts{});
  EXPECT_TRUE(read->scene.vertex_opacity.empty());
}

// They may be the light under another name, which a program can then say.
TEST(Ply, ValuesOfVerticesWithoutLightAreCounted) {
  const TempFolder folder;
  const auto not_read = [&](const std::string& value) {
    const auto path = folder.write(
        "t.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty "
        "float " +
            value +
            "\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0 0 0 1 5\n1 0 0 0 0 1 6\n0 1 0 0 0 1 7\n3 0 1 2\n");
    const auto read = read_scene(path, {}, {});
    EXPECT_TRUE(read.ok()) << read.status().message();
    return read.ok() ? read->scene.not_read : LossCounts{};
  };
  EXPECT_EQ(not_read("intensity"), (LossCounts{{"values of vertices: intensity", 3}}));
  EXPECT_EQ(not_read("illuminance"), LossCounts{});
}

}  // namespace
}  // namespace atlas

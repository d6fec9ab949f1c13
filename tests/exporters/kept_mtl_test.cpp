// Tests World::scene: materials that were read from an MTL.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using nlohmann::json;
using std::filesystem::path;
using Lines = std::vector<std::string>;

const ReadOptions kMtlRest{
    .unlit_textures = true, .encoded_textures = true, .normals = true, .rest = true};

// All lines of an MTL stay. Textures become comments, because the uvs for them are not in the file.
TEST(KeptMtl, LinesOfMtl) {
  const TempFolder folder;
  folder.write("m.mtl",
               "Ns 7\nnewmtl a\n  Ka 1 1 1\nKd 0.5 0 0\nKe 2 2 0 # glows\nKs 1 0 1\nNs 250\nd 0.5\n"
               "Tr 0.5\n# a comment\nillum 2\nmap_Kd -s 2 2 a b.png\nmap_Bump n.png\nbump n.png\n"
               "MAP_Ks s.png\nNi 1.45\nmap_d \\\n x.png\nnewmtl b\nkd 0.25 0 0\nd -halo 0.3\n");
  const path obj = folder.write(
      "s.obj",
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\n"
      "f 1/1 3/1 2/1\n");
  const WorldFile written = keep(obj, folder / "w.obj", kMtlRest);
  EXPECT_EQ(written.not_kept, (Lines{"5 x textures of materials (lines of the MTL, now comments)",
                                     "2 x triangles with uvs of their own"}));
  const std::string mtl = TempFolder::read(folder / "w.mtl");
  EXPECT_NE(mtl.find("newmtl a\nKd 0.5 0 0\nd 0.5\nKa 1 1 1\nKe 2 2 0 # glows\nKs 1 0 1\nNs 250\n"
                     "Tr 0.5\nillum 2\n#map_Kd -s 2 2 a b.png\n#map_Bump n.png\n#bump n.png\n"
                     "#MAP_Ks s.png\nNi 1.45\n#map_d "),
            std::string::npos)
      << mtl;
  EXPECT_NE(mtl.find("\nnewmtl b\nKd 0.25 0 0\nd -halo 0.3\n"), std::string::npos) << mtl;
  const auto back = read_scene(folder / "w.obj", kMtlRest, {});
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_TRUE(back->scene.textures.empty());
  EXPECT_EQ(
      keep(obj, folder / "w.glb", kMtlRest).not_kept,
      (Lines{"1 x lines of the MTL: Ka", "1 x lines of the MTL: Ks", "1 x lines of the MTL: MAP_Ks",
             "1 x lines of the MTL: Ni", "1 x lines of the MTL: Ns", "1 x lines of the MTL: Tr",
             "1 x lines of the MTL: bump", "1 x lines of the MTL: d", "1 x lines of the MTL: illum",
             "1 x lines of the MTL: map_Bump", "1 x lines of the MTL: map_d"}));
}

// Without normals, smoothing groups decide the shading, so they are missed there and only there.
TEST(KeptMtl, SmoothingGroupsAndInnerGroupsAreCounted) {
  const TempFolder folder;
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
  const auto not_kept = [&](const std::string& lines) {
    const path obj = folder.write("s.obj", points + lines);
    const Lines in_obj = keep(obj, folder / "w.obj", kMtlRest).not_kept;
    EXPECT_EQ(keep(obj, folder / "w.glb", kMtlRest).not_kept, in_obj);
    return in_obj;
  };
  const std::string plain = "f 1 2 3\n", with_normals = "f 1//1 2//1 3//1\n";
  EXPECT_EQ(not_kept("s 1\n" + plain + "s 2\n" + plain + "s 1\n" + plain + "s off\n" + plain),
            Lines{"2 x smoothing groups (s) of faces without normals"});
  EXPECT_EQ(not_kept("s 1\n" + with_normals + "s 0\n" + plain + "s 7\n"), Lines{});
  EXPECT_EQ(not_kept("s 1\n" + with_normals + plain),
            Lines{"1 x smoothing groups (s) of faces without normals"});
  EXPECT_EQ(not_kept("o a\ng left\n" + plain + "g right\n" + plain + "o b\ng left\n" + plain),
            Lines{"2 x groups (g) within objects"});
  EXPECT_EQ(not_kept("g left\n" + plain + "g right\n" + plain), Lines{}) << "they are objects";
  const auto loaded = read_scene(folder.write("s.obj", points + "s 1\n" + plain), {}, {});
  ASSERT_TRUE(loaded.ok());
  EXPECT_TRUE(loaded->scene.not_read.empty()) << "only scenes that are kept need it";
}

// Of the lines `d`, a scene holds one fraction only. The others stay in an OBJ and are counted in a
// glTF, even beside a fraction.
TEST(KeptMtl, OpacityThatDependsOnTheViewIsNotLostInSilence) {
  const TempFolder folder;
  folder.write("m.mtl",
               "newmtl a\nd 0.5\nd -halo 0.3\nnewmtl b\nD -HALO 0.3\nnewmtl c\nd 2\n"
               "newmtl e\nd\t0.5 # no -halo\n");
  const path obj = folder.write("s.obj",
                                "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"
                                "usemtl b\nf 1 3 2\nusemtl c\nf 1 2 3\nusemtl e\nf 1 2 3\n");
  EXPECT_EQ(keep(obj, folder / "w.obj", kMtlRest).not_kept, Lines{});
  const std::string mtl = TempFolder::read(folder / "w.mtl");
  EXPECT_NE(mtl.find("newmtl a\nKd 1 1 1\nd 0.5\nd -halo 0.3\nnewmtl b\nKd 1 1 1\nd -HALO 0.3\n"
                     "newmtl c\nKd 1 1 1\nd 2\nnewmtl e\nKd 1 1 1\nd 0.5\n"),
            std::string::npos)
      << mtl;
  EXPECT_EQ(keep(obj, folder / "w.glb", kMtlRest).not_kept, Lines{"3 x lines of the MTL: d"});
  EXPECT_EQ(keep(obj, folder / "v.glb", {}).not_kept, Lines{"3 x lines of the MTL: d"});
}

// glTF's factor is at most 1. A texture that shapes the emission is not read, and counts as a loss.
TEST(KeptMtl, EmissionOfMtlInGltfAndBack) {
  const TempFolder folder;
  folder.write(
      "m.mtl",
      "newmtl lamp\nKe 4 2 0\nnewmtl dim\nKe 0.5 0 0\nnewmtl off\nKe 0 0 0\nnewmtl screen\n"
      "Ke 1 1 1\nmap_Ke a.png\nKd 3 0 0\n");
  const path obj =
      folder.write("s.obj",
                   "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl lamp\nf 1 2 3\n"
                   "usemtl dim\nf 1 3 2\nusemtl off\nf 1 2 3\nusemtl screen\nf 1 2 3\n");
  EXPECT_EQ(keep(obj, folder / "w.gltf", kMtlRest).not_kept,
            (Lines{"1 x colours of materials beyond 0 to 1, limited to it",
                   "1 x lines of the MTL: Ke", "1 x lines of the MTL: map_Ke"}));
  const json document = json::parse(TempFolder::read(folder / "w.gltf"));
  const json& materials = document["materials"];
  EXPECT_EQ(materials[0]["emissiveFactor"], (json{1, 0.5, 0}));
  EXPECT_EQ(materials[0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 4);
  EXPECT_EQ(document["extensionsUsed"], json{"KHR_materials_emissive_strength"});
  EXPECT_EQ(materials[1]["emissiveFactor"], (json{0.5, 0, 0}));
  EXPECT_FALSE(materials[1].contains("extensions"));
  EXPECT_FALSE(materials[2].contains("emissiveFactor"));
  EXPECT_FALSE(materials[3].contains("emissiveFactor"));
  keep(folder / "w.gltf", folder / "back.obj", kMtlRest);
  const std::string mtl = TempFolder::read(folder / "back.mtl");
  EXPECT_NE(mtl.find("newmtl lamp\nKd 1 1 1\nKe 4 2 0\n"), std::string::npos) << mtl;
  EXPECT_EQ(mtl.find("newmtl off\nKd 1 1 1\nKe"), std::string::npos) << mtl;
}

// Tests what both MTL and glTF have: opacity, and textures that are clamped at their edges.
TEST(KeptMtl, OpacityAndClampingOfMtlInGltf) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  folder.write("m.mtl", "newmtl a\nd 0.5\nmap_Kd -clamp on a.png\nnewmtl b\nmap_Kd a.png\n");
  const path obj =
      folder.write("s.obj",
                   "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 0 2\nusemtl a\n"
                   "f 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\n");
  EXPECT_EQ(keep(obj, folder / "w.glb", kMtlRest).not_kept, Lines{});
  const auto back = read_scene(folder / "w.glb", {}, {});
  ASSERT_TRUE(back.ok()) << back.status().message();
  const std::vector<Material>& materials = back->scene.materials;
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[0].opacity, 0.5f);
  EXPECT_EQ(materials[0].alpha_mode, AlphaMode::blend);
  EXPECT_EQ(materials[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(materials[0].wrap_v, TextureWrap::clamp);
  EXPECT_EQ(materials[1].wrap_u, TextureWrap::repeat);
  EXPECT_EQ(back->scene.textures.size(), 1u);
}

// What shows light already is not lit once more by the viewers of the copy.
TEST(KeptMtl, UnlitTexturesStayUnlitInGltf) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  folder.write("m.mtl", "newmtl a\nillum 0\nmap_Kd a.png\nnewmtl b\nKe 2 2 2\nmap_Kd a.png\n");
  const path obj =
      folder.write("s.obj",
                   "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 0 2\nusemtl a\n"
                   "f 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\n");
  EXPECT_EQ(keep(obj, folder / "w.gltf", kMtlRest).not_kept, Lines{});
  const json document = json::parse(TempFolder::read(folder / "w.gltf"));
  EXPECT_EQ(document["extensionsUsed"].get<std::set<std::string>>(),
            (std::set<std::string>{"KHR_materials_emissive_strength", "KHR_materials_unlit"}));
  const auto back = read_scene(folder / "w.gltf", {}, {});
  ASSERT_TRUE(back.ok()) << back.status().message();
  ASSERT_EQ(back->scene.materials.size(), 2u);
  EXPECT_TRUE(back->scene.materials[0].unlit);
  EXPECT_FALSE(back->scene.materials[1].unlit);
}

}  // namespace
}  // namespace atlas::test

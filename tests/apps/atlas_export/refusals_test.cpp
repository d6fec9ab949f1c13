// What atlas-export refuses: it prints one line with the reason and the remedy, and writes nothing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>

#include "tests/apps/atlas_export/run_export.h"

namespace atlas::test {
namespace {

TEST_F(AtlasExport, MissingFile) {
  expect_refusal(dir_ / "nowhere.obj", "nowhere.obj");
}

TEST_F(AtlasExport, AFileWithoutAnEnding) {
  expect_refusal("/dev/null", "/dev/null: no reader for a name without an ending (use .obj");
  expect_refusal(write("a.max", ""), "no reader for '.max' (use .obj");
}

TEST_F(AtlasExport, MalformedLine) {
  expect_refusal(write("bad.obj", "v 0 0 0 1 1 1\nv 1 zero 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n"),
                 "bad.obj:2");
}

// Control sequences of a terminal (colours, titles, cursor moves) would outlive the message, and a
// megabyte of text would hide it.
TEST_F(AtlasExport, MessagesObeyNothingThatFilesHold) {
  expect_refusal(write("bad.obj", "v 0 0 \033[31m\302\233x\n"), "'?[31m?x' is not a number");
  write("name.gltf", "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"a" +
                         std::string(1 << 20, '\033') + "b\"]}");
  const RunResult r = run(fmt::format("{0}/name.gltf -o {0}/w.wrl", dir_.string()));
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_EQ(r.output.find('\033'), std::string::npos);
  EXPECT_LT(r.output.size(), 1000u);
}

TEST_F(AtlasExport, TruncatedBinary) {
  expect_refusal(write("cut.ply",
                       "ply\nformat binary_little_endian 1.0\nelement vertex 1000\n"
                       "property float x\nproperty float y\nproperty float z\n"
                       "element face 1\nproperty list uchar int vertex_indices\nend_header\nabc"),
                 "cut.ply");
}

TEST_F(AtlasExport, EmptyScene) {
  expect_refusal(write("empty.obj", "# nothing\n"), "empty.obj");
}

TEST_F(AtlasExport, OnlyBadTriangles) {
  expect_refusal(write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), "range.obj");
  expect_refusal(write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "nan.obj");
}

TEST_F(AtlasExport, OptionsOutOfRange) {
  const fs::path scene = write("box.obj", lit_box(2));
  expect_refusal(scene, "--atlases", "--atlases 0");
  expect_refusal(scene, "--atlas-size", "--atlas-size 1000");
  expect_refusal(scene, "--texel", "--texel 5parsec");
  expect_refusal(scene, "--tone", "--tone sepia");
  expect_refusal(scene, "--memory", "--memory lots");
  expect_refusal(scene, "mm, in, ft or km", "--texel 1um");
  // Options that would have no effect.
  expect_refusal(scene, "--uv-aspect requires --keep-uv-charts", "--uv-aspect 2");
  expect_refusal(scene, "--charts-only excludes --exr", "--charts-only --exr");
  expect_refusal(scene, "--budget is for --packing best (give both or none)", "--budget 1s");
  expect_refusal(scene, "/dev/stdout is standard output", "--report -");
}

// Every number has its range, and NaN is in none.
TEST_F(AtlasExport, AbsurdNumbers) {
  const fs::path scene = write("box.obj", lit_box(2));
  for (const std::string option :
       {"--max-stretch 0.5", "--max-stretch inf", "--cone 400",
        "--cone nan",        "--crease -5",       "--threads -1",
        "--threads 2.5",     "--atlases -3",      "--atlas-size 2147483648",
        "--white -1",        "--exposure 1e9",    "--slip inf",
        "--shifts 0",        "--mips 9",          "--uv-aspect 0",
        "--bake x",          "--preset good",     "--memory 1",
        "--unit 0",          "--threshold nan",   "--bogus",
        "--budget -1s"}) {
    expect_refusal(scene, option.substr(0, option.find(' ')), option);
  }
  expect_refusal(scene, "more than the side of a square", "-q --texel 1km");
  expect_refusal(scene, "more than once", "-o again.wrl");
}

TEST_F(AtlasExport, OverwritesNothingThatItReads) {
  const fs::path scene = write("box.obj", lit_box(2));
  const std::string text = slurp(scene);
  EXPECT_EQ(run(fmt::format("{0}/box.obj -o {0}/./box.obj", dir_.string())).exit_code, 2);
  expect_refusal(scene, "would overwrite", fmt::format("--report {}/box.obj", dir_.string()));
  expect_refusal(scene, "would overwrite", fmt::format("--report {}/world.wrl", dir_.string()));
  for (const char* name : {"v.mtl", "v_0.png"}) {
    const RunResult r =
        run(fmt::format("{0}/box.obj -o {0}/v.obj --report {0}/{1}", dir_.string(), name));
    EXPECT_EQ(r.exit_code, 2) << r.output;
    EXPECT_NE(r.output.find(name), std::string::npos) << r.output;
  }
  EXPECT_EQ(slurp(scene), text);
  // The material file has a name that viewers can load.
  ASSERT_EQ(run(fmt::format("{0}/box.obj -o '{0}/a #1.obj' -q", dir_.string())).exit_code, 0);
  const std::string obj = slurp(dir_ / "a #1.obj");
  const std::string safe = obj.substr(obj.find("mtllib ") + 7, std::strlen("a__1-0000.mtl"));
  EXPECT_TRUE(safe.starts_with("a__1-") && safe.ends_with(".mtl")) << safe;
  EXPECT_TRUE(fs::exists(dir_ / safe));
  EXPECT_EQ(run(fmt::format("{0}/box.obj -o '{0}/a #1.obj' --report {0}/{1}", dir_.string(), safe))
                .exit_code,
            2);
  // The texture of a scene has the name of the first new page.
  ASSERT_EQ(run(fmt::format("{0}/box.obj -o {0}/w.obj -q", dir_.string())).exit_code, 0);
  const std::string page = slurp(dir_ / "w_0.png");
  write("t.mtl", "newmtl t\nmap_Kd w_0.png\n");
  write("textured.obj", "mtllib t.mtl\nusemtl t\n" + lit_box(2));
  const RunResult again = run(fmt::format("{0}/textured.obj -o {0}/w.wrl", dir_.string()));
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.output.find("w_0.png"), std::string::npos) << again.output;
  EXPECT_EQ(slurp(dir_ / "w_0.png"), page);
  EXPECT_EQ(run(fmt::format("{0}/textured.obj -o {0}/v.wrl -q", dir_.string())).exit_code, 0);
  // A world without its own light gets no pages, and needs no textures.
  EXPECT_EQ(run(fmt::format("{0}/w.obj -o {0}/w.gltf -q", dir_.string())).exit_code, 0);
  EXPECT_EQ(slurp(dir_ / "w_0.png"), page);
}

// The target of a link is overwritten, too, so comparing names is not enough.
TEST_F(AtlasExport, OverwritesNothingBehindLinks) {
  ASSERT_EQ(write("box.obj", lit_box(2)), dir_ / "box.obj");
  ASSERT_EQ(run(fmt::format("{0}/box.obj -o {0}/w.obj -q", dir_.string())).exit_code, 0);
  fs::rename(dir_ / "w_0.png", dir_ / "wood.png");
  write("t.mtl", "newmtl t\nmap_Kd wood.png\n");
  write("textured.obj", "mtllib t.mtl\nusemtl t\n" + lit_box(2));
  fs::create_symlink("wood.png", dir_ / "texture_0.png");
  fs::create_symlink("textured.obj", dir_ / "scene_0.exr");
  fs::create_symlink("t.mtl", dir_ / "materials_1.png");
  fs::create_symlink("textured.obj", dir_ / "beside.mtl");
  fs::create_symlink("wood.png", dir_ / "world.gltf");
  const auto before = files();
  const std::string image = slurp(dir_ / "wood.png"), text = slurp(dir_ / "textured.obj");
  const std::string wood = (dir_ / "wood.png").string();
  for (const std::string& arguments :
       {std::string("texture.wrl"), std::string("scene.wrl --exr"), std::string("materials.gltf"),
        std::string("beside.obj"), std::string("world.gltf"), "v.wrl --report " + wood}) {
    const RunResult r =
        run(fmt::format("{0}/textured.obj -q -o {0}/{1}", dir_.string(), arguments));
    EXPECT_EQ(r.exit_code, 2) << arguments;
    EXPECT_NE(r.output.find("would overwrite"), std::string::npos) << arguments << r.output;
    EXPECT_EQ(files(), before) << arguments;
  }
  EXPECT_EQ(slurp(dir_ / "wood.png"), image);
  EXPECT_EQ(slurp(dir_ / "textured.obj"), text);
  // These write no file of that name: a .glb contains its pages, and EXR was not asked for.
  for (const char* target : {"texture.glb", "scene.wrl"})
    EXPECT_EQ(run(fmt::format("{0}/textured.obj -q -o {0}/{1}", dir_.string(), target)).exit_code,
              0)
        << target;
  EXPECT_EQ(slurp(dir_ / "wood.png"), image);
  EXPECT_EQ(slurp(dir_ / "textured.obj"), text);
}

TEST_F(AtlasExport, ScenesThatCannotBeKept) {
  const fs::path scene = write("box.obj", lit_box(2));
  expect_refusal(scene, "--keep-scene: VRML has no room", "--keep-scene --charts-only");
  expect_refusal(scene, "--keep-scene: VRML has no room", "--keep-scene");
  const auto before = files();
  for (const auto& [line, text] :
       {std::pair{"w.glb --charts-only",
                  "--keep-scene: a scene that is kept has uvs without light "
                  "on one page (leave out --atlases, or add --udim)"},
        {"w.obj",
         "--atlases: an .obj that keeps its scene has one page for its light (write .gltf "
         "or .glb, or leave out --atlases)"}}) {
    const RunResult r =
        run(fmt::format("{0}/box.obj --keep-scene --atlases 2 -o {0}/{1}", dir_.string(), line));
    EXPECT_EQ(r.exit_code, 2) << line;
    EXPECT_NE(r.output.find(text), std::string::npos) << r.output;
  }
  EXPECT_EQ(files(), before);
}

TEST_F(AtlasExport, ALightmapOverwritesNoTextureOfItsScene) {
  write("box.obj", lit_box(2));
  ASSERT_EQ(run(fmt::format("{0}/box.obj -o {0}/w.wrl -q", dir_.string())).exit_code, 0);
  const std::string image = slurp(dir_ / "w_0.png");
  write("t.mtl", "newmtl t\nmap_Kd w_0.png\n");
  write("t.obj",
        "mtllib t.mtl\nv 0 0 0 1 2 3\nv 1 0 0 1 2 3\nv 0 1 0 1 2 3\nvt 0 0\nvt 1 0\nvt 0 1\n"
        "usemtl t\nf 1/1 2/2 3/3\n");
  const auto before = files();
  for (const char* target : {"w.glb", "w.gltf", "w.obj"}) {
    const RunResult r =
        run(fmt::format("{0}/t.obj -o {0}/{1} --keep-scene -q", dir_.string(), target));
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_NE(r.output.find("would overwrite"), std::string::npos) << r.output;
  }
  EXPECT_EQ(files(), before);
  EXPECT_EQ(slurp(dir_ / "w_0.png"), image);
}

// Files that an export has written name the images of their lightmap, whether it is read or not.
TEST_F(AtlasExport, LightFromAnotherFileOverwritesNoLightmapOfTheScene) {
  write("box.obj", lit_box(2));
  for (const char* kept : {"w.glb", "w.obj"}) {
    ASSERT_EQ(
        run(fmt::format("{0}/box.obj -o {0}/{1} --keep-scene -q", dir_.string(), kept)).exit_code,
        0);
    const auto before = files();
    const std::string image = slurp(dir_ / "w_0.png");
    const RunResult r =
        run(fmt::format("{0}/{1} --illumination {0}/box.obj -o {0}/w.wrl -q", dir_.string(), kept));
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_NE(r.output.find("its images would overwrite"), std::string::npos) << r.output;
    EXPECT_EQ(files(), before);
    EXPECT_EQ(slurp(dir_ / "w_0.png"), image);
  }
}

// The textures of a scene that is kept are copied beside a .gltf, but never over one of them.
TEST_F(AtlasExport, AKeptSceneOverwritesNoneOfItsTextures) {
  const fs::path scene = write("box.obj", lit_box(2));
  ASSERT_EQ(run(fmt::format("{0}/box.obj -o {0}/lit.obj -q", dir_.string())).exit_code, 0);
  fs::rename(dir_ / "lit_0.png", dir_ / "w_texture0.png");
  const std::string image = slurp(dir_ / "w_texture0.png");
  write("t.mtl", "newmtl t\nmap_Kd w_texture0.png\n");
  write("t.obj",
        "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl t\n"
        "f 1/1 2/2 3/3\n");
  const auto before = files();
  const RunResult r = run(fmt::format("{0}/t.obj -o {0}/w.gltf --keep-scene -q", dir_.string()));
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.output.find("would overwrite"), std::string::npos) << r.output;
  EXPECT_EQ(files(), before);
  for (const char* target : {"v.gltf", "w.glb", "w.obj"})
    EXPECT_EQ(
        run(fmt::format("{0}/t.obj -o {0}/{1} --keep-scene -q", dir_.string(), target)).exit_code,
        0);
  EXPECT_EQ(slurp(dir_ / "v_texture0.png"), image);
  EXPECT_EQ(slurp(dir_ / "w_texture0.png"), image);
}

// Nor are images in formats that are not decoded.
TEST_F(AtlasExport, AKeptGltfOverwritesNoneOfItsImages) {
  const std::string bytes = "DDS |abc";
  write("w_texture0.dds", bytes);
  write("s.gltf", R"({"asset": {"version": "2.0"}, "extensionsUsed": ["MSFT_texture_dds"],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
                  R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
    "images": [{"uri": "w_texture0.dds"}],
    "textures": [{"extensions": {"MSFT_texture_dds": {"source": 0}}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})");
  const auto before = files();
  for (const char* line : {"-o {0}/w.gltf", "-o {0}/v.gltf --report {0}/v_texture0.dds",
                           "-o {0}/v.gltf --report {0}/w_texture0.dds"}) {
    const RunResult r = run(fmt::format("{}/s.gltf --keep-scene -q ", dir_.string()) +
                            fmt::format(fmt::runtime(line), dir_.string()));
    EXPECT_EQ(r.exit_code, 2) << line;
    EXPECT_NE(r.output.find("would overwrite"), std::string::npos) << r.output;
    EXPECT_EQ(files(), before);
  }
  EXPECT_EQ(run(fmt::format("{0}/s.gltf -o {0}/v.gltf --keep-scene -q", dir_.string())).exit_code,
            0);
  EXPECT_EQ(slurp(dir_ / "v_texture0.dds"), bytes);
  EXPECT_EQ(slurp(dir_ / "w_texture0.dds"), bytes);
}

// Textures are not read where no page needs them.
TEST_F(AtlasExport, OverwritesNoTextureThatItNeedNotRead) {
  const fs::path wood = write("wood.png", "an image"), bump = write("bump.png", "another");
  write("t.mtl", "newmtl t\nmap_Kd wood.png\nmap_bump -bm 0.5 bump.png\nnewmtl other\n");
  write("t.obj", "mtllib t.mtl\nusemtl t\n" + lit_box(2));
  write("other.obj", "mtllib t.mtl\nusemtl other\n" + lit_box(2));
  const auto before = files();
  for (const char* arguments :
       {"t.obj --charts-only --report", "t.obj --charts-only --depfile", "t.obj --plan --report",
        "other.obj --report", "t.obj --charts-only --keep-scene --report"}) {
    for (const fs::path& image : {wood, bump}) {
      const RunResult r =
          run(fmt::format("{0}/{1} {2} -o {0}/w.obj", dir_.string(), arguments, image.string()));
      EXPECT_EQ(r.exit_code, 2) << arguments << image << r.output;
      EXPECT_NE(r.output.find("would overwrite"), std::string::npos) << r.output;
      EXPECT_EQ(files(), before) << arguments;
    }
  }
  EXPECT_EQ(slurp(wood), "an image");
  EXPECT_EQ(slurp(bump), "another");
}

// The materials of an OBJ and the buffer of a glTF are known only when the scene has been read.
TEST_F(AtlasExport, OverwritesNoMaterialsAndNoBuffer) {
  const fs::path materials = write("m.mtl", "newmtl red\nKd 1 0 0\n");
  write("box.obj", "mtllib m.mtl\nusemtl red\n" + lit_box(2));
  const RunResult obj = run(fmt::format("{0}/box.obj -o {0}/m.obj --charts-only", dir_.string()));
  EXPECT_EQ(obj.exit_code, 2);
  EXPECT_NE(obj.output.find("would overwrite"), std::string::npos) << obj.output;
  EXPECT_EQ(slurp(materials), "newmtl red\nKd 1 0 0\n");
  EXPECT_FALSE(fs::exists(dir_ / "m.obj"));
  ASSERT_EQ(run(fmt::format("{0}/box.obj -o {0}/w.gltf -q", dir_.string())).exit_code, 0);
  fs::rename(dir_ / "w.gltf", dir_ / "lit.gltf");
  const std::string buffer = slurp(dir_ / "w.bin");
  const RunResult gltf = run(fmt::format("{0}/lit.gltf -o {0}/w.gltf", dir_.string()));
  EXPECT_EQ(gltf.exit_code, 2);
  EXPECT_NE(gltf.output.find("w.bin"), std::string::npos) << gltf.output;
  EXPECT_EQ(slurp(dir_ / "w.bin"), buffer);
}

TEST_F(AtlasExport, TooManyChartsForThePagesNamesTheOptions) {
  const fs::path scene = write("box.obj", lit_box(2));
  const RunResult r = run(fmt::format("{0} -o {1}/w.obj --atlases 1 --atlas-size 64 --mips 5",
                                      scene.string(), dir_.string()));
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.output.find("do not fit 1 page of 64 x 64 even as small as allowed (give more "
                          "--atlases or a larger --atlas-size, or a lower --min-side or --mips)"),
            std::string::npos)
      << r.output;
  for (const char* mips : {"0", "5"}) {
    const RunResult plain =
        run(fmt::format("{0} -o {1}/w.obj --charts-only --square --atlas-size "
                        "64 --mips {2}",
                        scene.string(), dir_.string(), mips));
    const bool refused = *mips == '5';
    EXPECT_EQ(plain.exit_code, refused ? 1 : 0) << plain.output;
    EXPECT_EQ(plain.output.find("or a lower --mips)") != std::string::npos, refused)
        << plain.output;
  }
}

TEST_F(AtlasExport, LightOnNoArea) {
  const fs::path flat = write("flat.obj", "v 1 1 1 1 1 1\nv 1 1 1 1 1 1\nv 1 1 1 1 1 1\nf 1 2 3\n");
  expect_refusal(flat, "no triangle has an area", "-q");
}

TEST_F(AtlasExport, Directories) {
  fs::create_directories(dir_ / "folder");
  fs::create_directories(dir_ / "folder.obj");
  expect_refusal(dir_ / "folder", "is a directory");
  expect_refusal(dir_ / "folder.obj", "is a directory");
}

TEST_F(AtlasExport, UnwritableTarget) {
  const fs::path scene = write("box.obj", lit_box(2));
  const auto before = files();
  const RunResult r = run(fmt::format("{} -o {}/no/such/world.wrl", scene.string(), dir_.string()));
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.output.find("no/such"), std::string::npos) << r.output;
  EXPECT_EQ(files(), before);
  expect_refusal(scene, "report", fmt::format("--report {}/no/report.json", dir_.string()));
}

TEST_F(AtlasExport, UnknownTargetFormat) {
  const fs::path scene = write("box.obj", lit_box(2));
  const RunResult r = run(fmt::format("{} -o {}/world.max", scene.string(), dir_.string()));
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.output.find(".wrl"), std::string::npos) << r.output;
}

}  // namespace
}  // namespace atlas::test

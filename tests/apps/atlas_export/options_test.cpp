// Every option of atlas-export reaches the export: seen in the plan, the report or the files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "tests/apps/atlas_export/export_flags.h"

namespace atlas::test {
namespace {

// The light of the box, without its faces and its positions.
std::string light_of(const std::string& obj) {
  std::istringstream lines(obj);
  std::string light;
  double x = 0, r = 0, g = 0, b = 0;
  for (std::string line; std::getline(lines, line);)
    if (std::sscanf(line.c_str(), "v %lf %lf %lf %lf %lf %lf", &x, &x, &x, &r, &g, &b) == 6)
      light += fmt::format("{} {} {}\n", r, g, b);
  return light;
}

TEST_F(ExportFlags, ConfineRefusesFilesOutsideOfTheFolder) {
  fs::create_directory(dir_ / "in");
  write("secret.mtl", "newmtl a\nKd 1 0 0\n");
  write("in/a.obj", "mtllib ../secret.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  done("{0}/in/a.obj -o {0}/w.obj");
  const RunResult r = run(fmt::format("{0}/in/a.obj -o {0}/v.obj --confine", dir_.string()));
  EXPECT_EQ(r.exit_code, 1) << r.output;
  EXPECT_TRUE(holds(r.output, "secret.mtl, which lies outside of the scene's folder")) << r.output;
  EXPECT_TRUE(holds(r.output, "leave out --confine)")) << r.output;
  EXPECT_FALSE(fs::exists(dir_ / "v.obj"));
}

TEST_F(ExportFlags, LimitsInProportionToTheFileCanBeLifted) {
  std::string wrl =
      "#VRML V2.0 utf8\nDEF a Group { children [ Shape { geometry IndexedFaceSet { "
      "coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 "
      "1 2 -1 ] } } WorldInfo { info \"" +
      std::string(100'000, 'x') + "\" } ] }\n";
  for (int i = 0; i < 700; ++i) wrl += "USE a ";
  write("a.wrl", wrl);
  const RunResult r = run(fmt::format("{0}/a.wrl --plan", dir_.string()));
  EXPECT_EQ(r.exit_code, 1) << r.output;
  EXPECT_TRUE(holds(r.output, "--no-limits lifts the limit)")) << r.output;
  done("{0}/a.wrl --plan --no-limits");
}

TEST_F(ExportFlags, TexelsOfPlainUvsSizeThePage) {
  const std::string coarse = done("{0}/box.obj -o {0}/w.obj --charts-only --texel 10cm");
  EXPECT_TRUE(holds(coarse, "texels of 0.1 m")) << coarse;
  EXPECT_NE(coarse, done("{0}/box.obj -o {0}/w.obj --charts-only --texel 1cm"));
  const RunResult r = run(fmt::format(
      "{0}/box.obj -o {0}/w.obj --charts-only --texel 1mm --atlas-size 64", dir_.string()));
  EXPECT_EQ(r.exit_code, 1) << r.output;
  EXPECT_TRUE(holds(r.output, "--texel: 0.001 m needs more room")) << r.output;
}

// A page of 2048 x 2048 texels takes 4 bytes a texel and a third more for its mip levels: 22.4 MB.
TEST_F(ExportFlags, MemoryBecomesPages) {
  for (const auto& [memory, budget] : {std::pair("50MB", "2 pages of 2048²"),
                                       {"22.37MB", "1 page of 2048²"},
                                       {"22.36MB", "3 pages of 1024²"},
                                       {"1MB", "2 pages of 256²"},
                                       {"1000kB", "2 pages of 256²"},
                                       {"1e6", "2 pages of 256²"},
                                       {"1MiB", "3 pages of 256²"},
                                       {"1024KiB", "3 pages of 256²"},
                                       {"1048576b", "3 pages of 256²"},
                                       {"1048576", "3 pages of 256²"},
                                       {"'0.0009765625 GiB'", "3 pages of 256²"},
                                       {"0.001G", "2 pages of 256²"},
                                       {"22000", "1 page of 64²"}}) {
    const std::string text = plan(fmt::format("--memory {}", memory));
    EXPECT_TRUE(holds(text, fmt::format("run  packing      {}, ", budget))) << memory << text;
  }
  EXPECT_TRUE(holds(plan("--memory 25MB --atlas-size 1024"), "4 pages of 1024²"));
}

TEST_F(ExportFlags, UnitsAndLengthsAreMetresInTheEnd) {
  for (const auto& [unit, metres] : {std::pair("m", 1.0),
                                     {"cm", 0.01},
                                     {"mm", 1e-3},
                                     {"in", 0.0254},
                                     {"ft", 0.3048},
                                     {"km", 1e3},
                                     {"2.5", 2.5}}) {
    const auto json = report(fmt::format("{{0}}/box.obj -o {{0}}/w.wrl -q --plan --unit {}", unit));
    EXPECT_NEAR(json["plan"]["surface_area_m2"], 6 * metres * metres, 1e-6 * metres * metres);
    EXPECT_DOUBLE_EQ(json["scene"]["metres_per_unit"], metres);
  }
  for (const auto& [texel, metres] : {std::pair("0.05", 0.05),
                                      {"5mm", 0.005},
                                      {"'0.5 cm'", 0.005},
                                      {"1in", 0.0254},
                                      {"0.1ft", 0.03048},
                                      {"0.00002km", 0.02},
                                      {"0.1m", 0.1}}) {
    const auto json =
        report(fmt::format("{{0}}/box.obj -o {{0}}/w.wrl -q --plan --texel {}", texel));
    EXPECT_DOUBLE_EQ(json["plan"]["texel_m"], metres) << texel;
  }
  for (const char* wrong : {"--unit 5mm", "--texel 0", "--texel -5mm", "--texel inf",
                            "--memory 0.5", "--memory 1xB", "--memory 1MBit", "--memory 1e30TB"})
    EXPECT_EQ(run(fmt::format("{0}/box.obj -o {0}/w.wrl {1}", dir_.string(), wrong)).exit_code, 2)
        << wrong;
}

TEST_F(ExportFlags, ThePlanShowsThem) {
  for (const auto& [option, words] :
       {std::pair("--tone reinhard", "exposure     reinhard tone curve, white measured"),
        {"--white 5", "linear tone curve, white given"},
        {"--threshold 0.25", "threshold 0.2500"},
        {"--threshold 0", "skip downsizing   the threshold is 0"},
        {"--threshold 1", "threshold 1.0000"},
        {"--shifts 7", "7 shifted grids, gutters for mip levels 0 to 2, or more where"},
        {"--mips 3", "4 shifted grids, gutters for mip levels 0 to 3\n"},
        {"--slip 0.7", "slip at most 0.7 texels"},
        {"--no-simplify", "skip simplify     switched off"},
        {"--slip 0.3", "run  simplify"},
        {"--no-error", "skip error        switched off"},
        {"--cone 60", "normals within 60° of a chart's axis"},
        {"--max-stretch 1.1", "stretch at most 1.1 over"},
        {"--quantity luminance", "skip reflectance  the values are luminance already"},
        {"--quantity colour", "skip reflectance  the values are colours already"},
        {"--quantity colour", "linear tone curve, white at 1"},
        {"--quantity ILLUMINANCE", "skip reflectance  no textures"},
        {"--charts-only", "skip exposure     charts only were asked for"},
        {"--atlases 3 --atlas-size 512", "packing      3 pages of 512²"}})
    EXPECT_TRUE(holds(plan(option), words)) << option << "\n" << plan(option);
}

TEST_F(ExportFlags, LightMayComeFromAFileOfItsOwn) {
  const std::string box = lit_box(4);
  std::string dark;
  std::istringstream lines(box);
  double x = 0, y = 0, z = 0;
  for (std::string line; std::getline(lines, line);)
    dark += std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3
                ? fmt::format("v {} {} {}\n", x, y, z)
                : line + "\n";
  write("dark.obj", dark);
  write("light.txt", light_of(box));
  EXPECT_TRUE(holds(done("{0}/dark.obj -o {0}/w.wrl --plan"), "skip exposure"));
  EXPECT_TRUE(holds(done("{0}/dark.obj -o {0}/w.wrl --plan --illumination {0}/light.txt"),
                    "run  exposure"));
  // It is no place for outputs.
  const std::string light = slurp(dir_ / "light.txt");
  fs::create_symlink("light.txt", dir_ / "v.mtl");
  fs::create_symlink("light.txt", dir_ / "u_0.png");
  fs::create_symlink("light.txt", dir_ / "t.obj");
  for (const char* outputs :
       {"-o {0}/v.obj", "-o {0}/u.wrl", "-o {0}/t.obj", "-o {0}/w.wrl --report {0}/light.txt"}) {
    const RunResult r = run(fmt::format(
        fmt::runtime(std::string("{0}/dark.obj --illumination {0}/light.txt ") + outputs),
        dir_.string()));
    EXPECT_EQ(r.exit_code, 2) << outputs;
    EXPECT_TRUE(holds(r.output, "would overwrite")) << r.output;
    EXPECT_EQ(slurp(dir_ / "light.txt"), light) << outputs;
  }
}

TEST_F(ExportFlags, TheWorldShowsThem) {
  done("{0}/box.obj -o {0}/w.wrl -q --texel 5cm");
  EXPECT_FALSE(holds(slurp(dir_ / "w.wrl"), "the z axis points up"));
  const std::string page = slurp(dir_ / "w_0.png");
  done("{0}/box.obj -o {0}/w.wrl -q --texel 5cm --up z");
  EXPECT_TRUE(holds(slurp(dir_ / "w.wrl"), "the z axis points up"));
  EXPECT_EQ(slurp(dir_ / "w_0.png"), page);
  for (const char* option : {"--bake average", "--exposure 1", "--white 9", "--shifts 1"}) {
    done(std::string("{0}/box.obj -o {0}/w.wrl -q --texel 5cm ") + option);
    EXPECT_NE(slurp(dir_ / "w_0.png"), page) << option;
  }
  done("{0}/box.obj -o {0}/w.wrl -q --texel 5cm --png-level 0");
  EXPECT_GT(slurp(dir_ / "w_0.png").size(), 2 * page.size());
  done("{0}/box.obj -o {0}/x.wrl -q --texel 5cm --exr");
  EXPECT_TRUE(fs::exists(dir_ / "x_0.exr"));
  EXPECT_FALSE(fs::exists(dir_ / "w_0.exr"));
}

TEST_F(ExportFlags, TheReportShowsThem) {
  const std::string few = "{0}/box.obj -o {0}/w.wrl -q --texel 2cm";
  const auto plain = report(few);
  EXPECT_EQ(plain["packing"]["outlines"], report(few + " --packing fast")["packing"]["outlines"]);
  EXPECT_TRUE(plain.contains("error"));
  EXPECT_FALSE(report(few + " --no-error").contains("error"));
  EXPECT_TRUE(plain.contains("simplify"));
  EXPECT_FALSE(report(few + " --no-simplify").contains("simplify"));
  // Right triangles are packed by their outlines, unless that is switched off.
  std::string triangles;
  for (int i = 0; i < 8; ++i)
    triangles += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} 1 0\nf -3 -2 -1\n", 2 * i, 2 * i + 1);
  write("triangles.obj", triangles);
  const std::string uvs = "{0}/triangles.obj -o {0}/t.obj --charts-only -q";
  EXPECT_EQ(report(uvs)["packing"]["outlines"], true);
  EXPECT_EQ(report(uvs + " --boxes")["packing"]["outlines"], false);
  // Two materials on a flat sheet.
  write("m.mtl", "newmtl a\nnewmtl b\n");
  write("two.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nusemtl a\n"
        "f 1 2 3 4\nusemtl b\nf 2 5 6 3\n");
  EXPECT_EQ(report("{0}/two.obj -o {0}/t.obj -q")["charts"]["count"], 2);
  EXPECT_EQ(report("{0}/two.obj -o {0}/t.obj -q --across-materials")["charts"]["count"], 1);
  // Two walls with vertices of their own, lit differently.
  write("corner.obj",
        "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 1 1 0 1 1 1\nv 0 1 0 1 1 1\nv 1 0 0 .2 .2 .2\n"
        "v 1 0 1 .2 .2 .2\nv 1 1 1 .2 .2 .2\nv 1 1 0 .2 .2 .2\nf 1 2 3 4\nf 5 6 7 8\n");
  const std::string corner = "{0}/corner.obj -o {0}/t.obj -q --texel 1cm";
  EXPECT_EQ(report(corner)["charts"]["count"], 2);
  EXPECT_EQ(report(corner)["light"]["seam_length"], 1);
  EXPECT_EQ(report(corner + " --across-light")["charts"]["count"], 1);
}

// A texture of 16 texels or more a unit asks for finer texels than 50 cm.
TEST_F(ExportFlags, TexturesMakeTexelsFinerUnlessTheyAreIgnored) {
  done("{0}/box.obj -o {0}/wood.obj -q --texel 5cm");
  write("t.mtl", "newmtl t\nmap_Kd wood_0.png\n");
  write("t.obj",
        "mtllib t.mtl\nusemtl t\nv 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 1 1 0 1 1 2\nv 0 1 0 1 1 1\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
  const std::string words = "finer where diffuse textures are",
                    plan = "{0}/t.obj -o {0}/w.wrl --plan";
  EXPECT_TRUE(holds(done(plan + " --texel 50cm"), words));
  EXPECT_FALSE(holds(done(plan + " --texel 50cm --ignore-texture-density"), words));
}

TEST_F(ExportFlags, PlainPagesHaveTheSidesAndTheNumberAskedFor) {
  std::string many;
  for (int i = 0; i < 300; ++i)
    many += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} 1 0\nf -3 -2 -1\n", 2 * i, 2 * i + 1);
  write("many.obj", many);
  const auto pages = [&](const std::string& options) {
    return report("{0}/many.obj -o {0}/many_out.obj -q --charts-only " +
                  options)["packing"]["pages"];
  };
  const auto one = pages("--atlas-size 64");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_LE(std::max(int(one[0]["width"]), int(one[0]["height"])), 64);
  const auto three = pages("--atlas-size 64 --atlases 3");
  ASSERT_EQ(three.size(), 3u);
  EXPECT_EQ(three[2]["width"], 64);
  EXPECT_EQ(pages("").size(), 1u);
  const auto square = pages("--square --atlas-size 128");
  EXPECT_EQ(square[0]["width"], 128);
  EXPECT_EQ(square[0]["height"], 128);
  // 5000 charts of 1024 texels each need more than the usual page of 2048 x 2048.
  many.clear();
  for (int i = 0; i < 5000; ++i)
    many += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} 1 0\nf -3 -2 -1\n", 2 * i, 2 * i + 1);
  write("many.obj", many);
  const auto grown = pages("--square --preset fast --packing fast --boxes");
  EXPECT_EQ(grown[0]["width"], 4096);
}

TEST_F(ExportFlags, TheLastLinesTellWhatWasMade) {
  const std::string one = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  write("one.obj", one);
  const std::string plain = done("{0}/one.obj -o {0}/w.obj --square --atlas-size 64");
  EXPECT_TRUE(holds(plain, "the result has plain uvs and no images.\n")) << plain;
  EXPECT_TRUE(holds(plain, "w.obj: 1 triangle on 1 page, uvs of a square page, packed for 64 x 64"))
      << plain;
  EXPECT_TRUE(holds(done("{0}/one.obj -o {0}/w.glb --keep-scene"),
                    "the result has plain uvs and no light.\n"));
  // 6 m² of texels of 1 mm fill a page of 2048 x 2048, which is 21.3 MiB with its mip levels.
  const std::string lit =
      done("{0}/box.obj -o {0}/v.wrl --texel 1mm --threshold 0 --atlases 1 --no-simplify");
  EXPECT_TRUE(holds(lit, "v.wrl: 192 triangles on 1 page, 21.3 MiB of graphics memory")) << lit;
  EXPECT_FALSE(holds(lit, "carries no illumination")) << lit;
  const std::string coarse = done("{0}/box.obj -o {0}/v.wrl --texel 2cm");
  EXPECT_TRUE(holds(coarse, "v.wrl: 12 triangles on 1 page")) << coarse;
}

TEST_F(ExportFlags, TheReportIncludesReading) {
  const auto json = report("{0}/box.obj -o {0}/w.wrl -q --texel 2cm");
  EXPECT_EQ(json["scene"]["file"], (dir_ / "box.obj").string());
  ASSERT_GT(json["stages"].size(), 2u);
  const auto& reading = json["stages"][0];
  EXPECT_EQ(reading["stage"], "reading");
  EXPECT_EQ(reading["in"], 6 * 25);
  EXPECT_EQ(reading["out"], 192);
  double cpu = 0, wall = 0, most = 0;
  for (const auto& stage : json["stages"]) {
    cpu += double(stage["cpu_ms"]) / 1000;
    wall += double(stage["wall_ms"]) / 1000;
    most = std::max(most, double(stage["peak_mib"]));
  }
  EXPECT_LT(double(reading["wall_ms"]), 1000 * double(json["wall_s"]));
  EXPECT_GE(double(json["cpu_s"]), 0.9 * cpu);
  EXPECT_GE(double(json["wall_s"]), 0.5 * wall);
  EXPECT_GE(double(json["peak_mib"]), most);
}

// What the report advises names flags, as the messages do.
TEST_F(ExportFlags, AdviceInTheReportNamesFlags) {
  const auto json =
      report("{0}/box.obj -o {0}/w.wrl -q --texel 1mm --threshold 0 --atlases 1 --atlas-size 64");
  ASSERT_FALSE(json["advice"].empty());
  const std::string advice = json["advice"][0];
  EXPECT_TRUE(holds(advice, "not the 1 mm of --texel")) << advice;
  EXPECT_FALSE(holds(advice, "Options::")) << advice;
  const std::string told =
      done("{0}/box.obj -o {0}/w.wrl --texel 1mm --threshold 0 --atlases 1 --atlas-size 64");
  EXPECT_TRUE(holds(told, "atlas-export: " + advice + "\n")) << told;
}

// In the folder of the target, which has no parent in its name.
TEST_F(ExportFlags, ImagesOfASceneStayWhereNoFolderIsNamed) {
  done("{0}/box.obj -o {0}/w.obj -q --texel 5cm");
  write("t.mtl", "newmtl t\nmap_Kd w_0.png\n");
  write("textured.obj", "mtllib t.mtl\nusemtl t\n" + lit_box(2));
  const std::string page = slurp(dir_ / "w_0.png");
  const fs::path before = fs::current_path();
  fs::current_path(dir_);
  const RunResult r = run("textured.obj -o w.wrl -q"), other = run("textured.obj -o v.wrl -q");
  const RunResult name = run("box.obj -o w_.obj -q --texel 5cm --report w_0.json");
  fs::current_path(before);
  EXPECT_EQ(r.exit_code, 2) << r.output;
  EXPECT_TRUE(holds(r.output, "would overwrite")) << r.output;
  EXPECT_EQ(slurp(dir_ / "w_0.png"), page);
  EXPECT_EQ(other.exit_code, 0) << other.output;
  EXPECT_EQ(name.exit_code, 0) << name.output;
}

TEST_F(ExportFlags, ReportsThatImagesWouldReplaceAreRefused) {
  for (const char* name : {"v_0.png", "v_12.exr", "v_texture3.jpg", "v_texture0.png"}) {
    const RunResult r =
        run(fmt::format("{0}/box.obj -o {0}/v.gltf --report {0}/{1}", dir_.string(), name));
    EXPECT_EQ(r.exit_code, 2) << name;
    EXPECT_TRUE(holds(r.output, "is the name of an image of the world")) << r.output;
  }
  for (const char* name : {"v_0.json", "v_.png", "v_0a.png", "x_0.png"})
    EXPECT_EQ(run(fmt::format("{0}/box.obj -o {0}/v.gltf -q --texel 5cm --report {0}/{1}",
                              dir_.string(), name))
                  .exit_code,
              0)
        << name;
}

// Of what a kept scene holds, nothing is left out on the way from file to file.
TEST_F(ExportFlags, AKeptSceneKeepsItsNormalsAndImages) {
  done("{0}/box.obj -o {0}/wood.obj -q --texel 5cm");
  const std::string image = slurp(dir_ / "wood_0.png");
  write("t.mtl", "newmtl t\nmap_Kd wood_0.png\n");
  write("t.obj",
        "mtllib t.mtl\nusemtl t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n"
        "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1/1 2/2/1 3/3/1\n");
  for (const char* names : {"{0}/t.obj -o {0}/k.glb", "{0}/k.glb -o {0}/l.glb",
                            "{0}/k.glb -o {0}/m.gltf", "{0}/t.obj -o {0}/n.gltf"}) {
    done(std::string(names) + " --keep-scene -q");
    const std::string target = names + std::string(names).rfind('/') + 1;
    const std::string world = slurp(dir_ / target);
    EXPECT_TRUE(holds(world, "\"NORMAL\"")) << target;
    EXPECT_TRUE(holds(world, "\"TEXCOORD_1\"")) << target;
    EXPECT_EQ(holds(world, image), target.ends_with(".glb")) << target;
  }
  EXPECT_EQ(slurp(dir_ / "n_texture0.png"), image);
  done("{0}/k.glb -o {0}/o.obj --keep-scene -q");
  EXPECT_TRUE(holds(slurp(dir_ / "o.obj"), "\nvn 0 0 1\n"));
}

}  // namespace
}  // namespace atlas::test

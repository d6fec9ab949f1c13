// Tests atlas-export as users run it: exit codes, messages, and the files afterwards.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "tests/apps/atlas_export/run_export.h"

namespace atlas::test {
namespace {

TEST_F(AtlasExport, WritesWorldImagesAndReport) {
  const fs::path scene = write("box.obj", lit_box(12));
  const RunResult r = run(fmt::format(
      "{0}/box.obj -o {0}/world.wrl --texel 1cm --report {0}/report.json", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(files(), (std::set<std::string>{"box.obj", "report.json", "world.wrl", "world_0.png"}));
  const auto report = nlohmann::json::parse(slurp(dir_ / "report.json"));
  EXPECT_EQ(report["scene"]["triangles"], 12 * 12 * 2 * 6);
  EXPECT_EQ(report["charts"]["distortion"]["flips"], 0);
  EXPECT_GT(report["error"]["psnr"].get<double>(), 45);
  // For six flat sides, two triangles each are enough once the light is in the texture.
  EXPECT_LE(report["simplify"]["triangles_out"].get<int>(), 6 * 4);
}

TEST_F(AtlasExport, ThePageOfTheReportNamesItsKeys) {
  write("box.obj", lit_box(4));
  const std::string page = slurp(REPORT_PAGE);
  for (const char* more : {"", " --charts-only"}) {
    ASSERT_EQ(run(fmt::format("{0}/box.obj -o {0}/w.wrl --report {0}/r.json --report-charts{1}",
                              dir_.string(), more))
                  .exit_code,
              0);
    const auto report = nlohmann::json::parse(slurp(dir_ / "r.json"));
    for (const auto& object : {report, report["charts"], report["charts"]["cpu_parts_s"],
                               report["charts"]["charts"][0], report["packing"]})
      for (const auto& [key, value] : object.items()) {
        const bool named = page.find(fmt::format("`{}`", key)) != page.npos ||
                           page.find(fmt::format("`{}[]`", key)) != page.npos;
        EXPECT_TRUE(named) << key;
      }
  }
}

TEST_F(AtlasExport, TheReportSaysHowItWasMade) {
  write("box.obj", lit_box(2));
  const std::string arguments = fmt::format(
      "{0}/box.obj -o {0}/w.glb -q --atlas-size 64 --up Z --report {0}/r.json", dir_.string());
  ASSERT_EQ(run(arguments).exit_code, 0);
  const auto report = nlohmann::json::parse(slurp(dir_ / "r.json"));
  const std::string version = run("--version").output;
  EXPECT_EQ("atlas-export " + report["version"].get<std::string>() + "\n", version);
  EXPECT_EQ(report["command"], fmt::format("{} {}", ATLAS_EXPORT, arguments));
  const auto& options = report["options"];
  EXPECT_EQ(options["scene"], (dir_ / "box.obj").string());
  EXPECT_EQ(options["--atlas-size"], "64");
  EXPECT_EQ(options["--up"], "Z");
  EXPECT_EQ(options["--quiet"], "true");
  EXPECT_EQ(options["--quantity"], "illuminance") << "by default";
  EXPECT_FALSE(options.contains("--exr")) << "was not given";
}

TEST_F(AtlasExport, ThePageOfProgramsExplainsEveryLineOfAStage) {
  write("box.obj", lit_box(4));
  const std::string page = slurp(PROGRAMS_PAGE);
  const RunResult r = run(fmt::format("{0}/box.obj -o {0}/w.wrl", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  std::istringstream lines(r.output);
  int stages = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(" -> ") == line.npos) continue;
    const std::string stage = line.substr(0, line.find(' '));
    EXPECT_NE(page.find(fmt::format("| `{}` |", stage)), page.npos) << line;
    ++stages;
  }
  EXPECT_EQ(stages, 12);
}

TEST_F(AtlasExport, GlbHoldsItsImages) {
  write("box.obj", lit_box(6));
  const RunResult r = run(fmt::format("{0}/box.obj -o {0}/w.glb --texel 2cm", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(files(), (std::set<std::string>{"box.obj", "w.glb"}));
}

// What was not measured has no key, because its value would read as a perfect 0.
TEST_F(AtlasExport, TheReportHasNoKeysOfWhatNobodyMeasured) {
  write("box.obj", lit_box(4));
  struct Case {
    const char* options;
    bool gaps, drawn_twice, grouping;
  };
  for (const Case& c : {Case{"-o {0}/w.wrl", true, false, true},
                        Case{"-o {0}/w.wrl --atlases 1", true, false, false},
                        Case{"-o {0}/w.obj --charts-only", false, true, false},
                        Case{"-o {0}/w.glb --charts-only --keep-scene", true, true, false}}) {
    const std::string options = fmt::format(fmt::runtime(c.options), dir_.string());
    const RunResult r =
        run(fmt::format("{0}/box.obj {1} --report {0}/r.json", dir_.string(), options));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    const auto report = nlohmann::json::parse(slurp(dir_ / "r.json"));
    EXPECT_EQ(report["packing"].contains("border_texels"), c.gaps) << c.options;
    EXPECT_EQ(report["packing"].contains("shared_border_texels"), c.gaps) << c.options;
    EXPECT_EQ(report["packing"].contains("texels_drawn_twice"), c.drawn_twice) << c.options;
    EXPECT_EQ(report.contains("grouping"), c.grouping) << c.options;
  }
}

// The images lie beside a .glb, too, and those of an earlier export are named there.
TEST_F(AtlasExport, TellsTheLightmapOfAKeptScene) {
  write("box.obj", lit_box(4));
  write("w_1.png", "of an earlier export");
  const RunResult r =
      run(fmt::format("{0}/box.obj -o {0}/w.glb --keep-scene --exr --white 2.5 --report {0}/r.json",
                      dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  for (const char* line :
       {"lightmap: w_0.png (sRGB-encoded, white is 2.5 of the light at the vertices), w_0.exr "
        "(linear)\n",
        "the new uvs: TEXCOORD_1", "w_1.png"})
    EXPECT_NE(r.output.find(line), std::string::npos) << r.output;
  EXPECT_TRUE(fs::exists(dir_ / "w_0.png") && fs::exists(dir_ / "w_0.exr"));
  const auto report = nlohmann::json::parse(slurp(dir_ / "r.json"));
  ASSERT_EQ(report["packing"]["pages"].size(), 1u);
  EXPECT_EQ(report["packing"]["pages"][0]["image"], "w_0.png");
}

// What is kept of a scene shows in the result. The program reports what is not kept, and where the
// new uvs are.
TEST_F(AtlasExport, TellsWhatItDoesNotKeep) {
  write("m.mtl", "newmtl m\nKd 1 0 0\nKs 1 1 1\nmap_Bump n.png\n");
  write("t.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  const RunResult r =
      run(fmt::format("{0}/t.obj -o {0}/w.glb --keep-scene --report {0}/r.json", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  for (const char* line : {"the new uvs: TEXCOORD_1", "not kept: 1 x lines of the MTL: Ks\n",
                           "not kept: 1 x lines of the MTL: map_Bump\n"})
    EXPECT_NE(r.output.find(line), std::string::npos) << r.output;
  EXPECT_EQ(nlohmann::json::parse(slurp(dir_ / "r.json"))["not_kept"].size(), 2u);
  const RunResult again = run(fmt::format("{0}/w.glb -o {0}/v.glb --keep-scene", dir_.string()));
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_NE(again.output.find("the new uvs: TEXCOORD_2"), std::string::npos) << again.output;
  EXPECT_EQ(again.output.find("not kept"), std::string::npos) << again.output;
  const RunResult same =
      run(fmt::format("{0}/w.glb -o {0}/v.glb --keep-scene --uv-set 1", dir_.string()));
  EXPECT_EQ(same.exit_code, 0) << same.output;
  EXPECT_NE(same.output.find("the new uvs: TEXCOORD_1"), std::string::npos) << same.output;
  EXPECT_EQ(run(fmt::format("{0}/w.glb -o {0}/v.glb --uv-set 1", dir_.string())).exit_code, 2);
  EXPECT_EQ(
      run(fmt::format("{0}/w.glb -o {0}/v.glb --keep-scene --uv-set 8", dir_.string())).exit_code,
      2);
  const RunResult obj =
      run(fmt::format("{0}/w.glb -o {0}/v.obj --keep-scene --uv-set 1", dir_.string()));
  EXPECT_NE(obj.exit_code, 0);
  EXPECT_NE(obj.output.find("--uv-set: only a glTF file"), std::string::npos) << obj.output;
}

// A number for an error that was not measured would read as perfect, or as very bad.
TEST_F(AtlasExport, TheReportTellsNoErrorThatNobodyMeasured) {
  const auto report = [&](const std::string& scene, const std::string& more) {
    write("s.obj", scene);
    const RunResult r = run(fmt::format(
        "{0}/s.obj -o {0}/w.glb --texel 5cm --report {0}/r.json {1}", dir_.string(), more));
    EXPECT_EQ(r.exit_code, 0) << r.output;
    EXPECT_EQ(r.output.find("PSNR 0"), std::string::npos) << r.output;
    return nlohmann::json::parse(slurp(dir_ / "r.json"));
  };
  const auto curve = report(lit_box(6), "--tone reinhard");
  EXPECT_TRUE(curve["error"]["rmse"].is_null());
  EXPECT_GT(curve["error"]["psnr"].get<double>(), 40);
  EXPECT_EQ(curve["packing"]["pages"][0]["image"], "") << "there is no such file";
  const auto dark = report("v 0 0 0 0 0 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n", "");
  EXPECT_EQ(dark["error"]["samples_lit"], 0);
  for (const char* key : {"rmse", "psnr", "psnr_with_unlit", "rmse_display", "p95", "max"})
    EXPECT_TRUE(dark["error"][key].is_null()) << key;
}

TEST_F(AtlasExport, SameBytesForEveryThreadCount) {
  write("box.obj", lit_box(20));
  std::string reference;
  for (const int threads : {1, 2, 8}) {
    const RunResult r = run(fmt::format("{0}/box.obj -o {0}/w.obj --texel 1cm -q --threads {1}",
                                        dir_.string(), threads));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    EXPECT_EQ(r.output, "");
    const std::string bytes = slurp(dir_ / "w.obj") + slurp(dir_ / "w_0.png");
    if (reference.empty()) reference = bytes;
    EXPECT_EQ(bytes, reference) << threads;
  }
}

// The separate triangles of an STL become one chart, because their corners are joined.
TEST_F(AtlasExport, StlAndOffWithoutLight) {
  std::string stl = "solid strip\n", off = "OFF 18 16 0\n";
  const auto at = [](int i) { return fmt::format("{} {} 0", i / 2, i % 2); };
  for (int i = 0; i < 18; ++i) off += at(i) + "\n";
  for (int i = 0; i < 16; ++i) {
    const int b = i + 1 + i % 2, c = i + 2 - i % 2;
    off += fmt::format("3 {} {} {}\n", i, b, c);
    stl += fmt::format("facet normal 0 0 1 outer loop\nvertex {}\nvertex {}\nvertex {}\n", at(i),
                       at(b), at(c)) +
           "endloop endfacet\n";
  }
  write("strip.stl", stl + "endsolid\n");
  write("strip.off", off);
  for (const char* name : {"strip.stl", "strip.off"}) {
    const RunResult r =
        run(fmt::format("{0}/{1} -o {0}/strip.obj --report {0}/strip.json", dir_.string(), name));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    const auto report = nlohmann::json::parse(slurp(dir_ / "strip.json"));
    EXPECT_EQ(report["charts"]["count"], 1) << name;
    EXPECT_EQ(report["scene"]["triangles"], 16) << name;
  }
  expect_refusal(write("cut.off", off.substr(0, off.size() / 2)), "cut.off");
}

// The scene is a few millimetres across, and no texel size is given.
TEST_F(AtlasExport, SmallScenesGetTexels) {
  write("box.obj", lit_box(4));
  const RunResult r =
      run(fmt::format("{0}/box.obj -o {0}/w.wrl --unit 0.0005 --report {0}/r.json", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const auto report = nlohmann::json::parse(slurp(dir_ / "r.json"));
  EXPECT_GT(report["error"]["psnr"].get<double>(), 35);
}

TEST_F(AtlasExport, HelpAndVersion) {
  const RunResult help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.output.find("{false}"), std::string::npos);
  EXPECT_EQ(help.output.find("ENUM"), std::string::npos);
  const RunResult version = run("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.output.rfind("atlas-export ", 0), 0u) << version.output;
}

TEST_F(AtlasExport, SomeBadElementsAreCountedAndNamed) {
  std::string text = "mtllib none.mtl\nusemtl plaster\n" + lit_box(4);
  text += "f 1 2 9999\nf 1 2\nv nan 0 0 1 1 1\nf 1 2 151\n";
  write("some.obj", text);
  const RunResult r =
      run(fmt::format("{0}/some.obj -o {0}/w.wrl --report {0}/r.json", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const auto report = nlohmann::json::parse(slurp(dir_ / "r.json"));
  EXPECT_EQ(report["scene"]["triangles"], 4 * 4 * 2 * 6);
  EXPECT_EQ(report["scene"]["triangles_left_out"], 3);
  std::set<std::string> kinds;
  for (const auto& defect : report["scene"]["defects"]) {
    kinds.insert(defect["kind"]);
    EXPECT_GE(defect["count"].get<int>(), 1);
    EXPECT_FALSE(defect["first"].empty());
  }
  for (const char* kind : {"index_out_of_range", "too_few_corners", "bad_position_used",
                           "position_not_finite", "material_file_missing"}) {
    EXPECT_TRUE(kinds.count(kind)) << kind;
  }
}

TEST_F(AtlasExport, MissingTextureIsReported) {
  write("m.mtl", "newmtl wood\nKd 0.5 0.5 0.5\nmap_Kd gone.png\n");
  write("t.obj",
        "mtllib m.mtl\nv 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\n"
        "vt 0 0\nvt 1 0\nvt 0 1\nusemtl wood\nf 1/1 2/2 3/3\n");
  const RunResult r = run(fmt::format("{0}/t.obj -o {0}/w.wrl", dir_.string()));
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("gone.png"), std::string::npos) << r.output;
}

TEST_F(AtlasExport, PlanRunsNothing) {
  const fs::path scene = write("box.obj", lit_box(4));
  const auto before = files();
  const RunResult r = run(fmt::format("{} -o {}/w.wrl --plan", scene.string(), dir_.string()));
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_NE(r.output.find("skip reflectance"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("run  baking"), std::string::npos) << r.output;
  EXPECT_EQ(files(), before);
}

// Nothing is written, so no name is needed, and none is checked.
TEST_F(AtlasExport, APlanNeedsNoOutput) {
  const fs::path scene = write("box.obj", lit_box(4));
  const auto before = files();
  const RunResult named = run(fmt::format("{} -o {}/w.glb --plan", scene.string(), dir_.string()));
  const RunResult r = run(fmt::format("{} --plan", scene.string()));
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_EQ(r.output, named.output);
  EXPECT_EQ(
      run(fmt::format("{} --plan --charts-only --keep-scene --uv-set 2", scene.string())).exit_code,
      0);
  EXPECT_EQ(run(fmt::format("{} --plan --texel 50m", scene.string())).exit_code, 2);
  const RunResult none = run(scene.string());
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.output.find("--output is required"), std::string::npos) << none.output;
  EXPECT_EQ(files(), before);
}

TEST_F(AtlasExport, ThePlanCanBeReported) {
  write("box.obj", lit_box(4));
  const RunResult r =
      run(fmt::format("{0}/box.obj -o {0}/w.wrl --plan -q --report {0}/plan.json", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(files(), (std::set<std::string>{"box.obj", "plan.json"}));
  const auto report = nlohmann::json::parse(slurp(dir_ / "plan.json"));
  EXPECT_EQ(report["scene"]["triangles"], 192);
  EXPECT_NEAR(report["plan"]["surface_area_m2"], 6, 1e-5);
  EXPECT_NEAR(report["plan"]["texel_m"], 0.001, 1e-9);
  EXPECT_NEAR(report["plan"]["estimated_texels"], 6e6, 10);
  EXPECT_EQ(report["plan"]["steps"][1]["stage"], "charts");
  EXPECT_EQ(report["plan"]["steps"][0]["run"], true);
  EXPECT_EQ(report["skipped"][0]["stage"], "reflectance");
  EXPECT_FALSE(report.contains("charts")) << "figures of what was not done";
}

TEST_F(AtlasExport, APlanThatCannotBeCarriedOutSaysSo) {
  write("box.obj", lit_box(4));
  const RunResult r =
      run(fmt::format("{0}/box.obj -o {0}/w.wrl --plan --texel 50m", dir_.string()));
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.output.find("more than the side of a square"), std::string::npos) << r.output;
}

TEST_F(AtlasExport, ValuesThatMayBeLightAreNamed) {
  const auto ply = [&](const std::string& name) {
    write("t.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
          "float z\nproperty float " +
              name +
              "\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
              "0 0 0 5\n1 0 0 6\n0 1 0 7\n3 0 1 2\n");
    const RunResult r =
        run(fmt::format("{0}/t.ply -o {0}/w.wrl --atlases 1 --atlas-size 64", dir_.string()));
    EXPECT_EQ(r.exit_code, 0) << r.output;
    return r.output;
  };
  EXPECT_NE(ply("intensity").find("not read as light: intensity of the vertices"),
            std::string::npos);
  EXPECT_EQ(ply("illuminance").find("not read as light"), std::string::npos);
  EXPECT_EQ(ply("alpha").find("not read as light"), std::string::npos);
}

TEST_F(AtlasExport, UnlitSceneGivesPlainUvs) {
  write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const RunResult r = run(fmt::format("{0}/tri.obj -o {0}/w.obj", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("no illumination"), std::string::npos) << r.output;
  EXPECT_NE(slurp(dir_ / "w.obj").find("\nvt "), std::string::npos);
}

TEST_F(AtlasExport, InterruptLeavesNothing) {
  write("box.obj", lit_box(150));
  const auto before = files();
  for (const int milliseconds : {50, 300, 700, 1200}) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(SIGINT, SIG_DFL);  // which a test in the background of a script may ignore
      ::execl(ATLAS_EXPORT, ATLAS_EXPORT, (dir_ / "box.obj").c_str(), "-o",
              (dir_ / "w.wrl").c_str(), "--texel", "0.5mm", "--threshold", "0", "-q", nullptr);
      ::_exit(127);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status) || WIFSIGNALED(status));
    // The program was stopped before its handler was installed, or by the handler. Either way the
    // folder must be as before.
    ASSERT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "the scene was too small";
    EXPECT_EQ(files(), before) << milliseconds;
  }
}

}  // namespace
}  // namespace atlas::test

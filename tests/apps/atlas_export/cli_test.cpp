// atlas-export as its users meet it: exit codes, messages, and what lies on the disk afterwards.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <thread>

namespace {

namespace fs = std::filesystem;

struct RunResult {
  int exit_code = -1;
  std::string output;  // stdout and stderr together
};

class AtlasExport : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::temp_directory_path() / fmt::format("atlas_export_{}_{}", info->name(), ::getpid());
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name, std::ios::binary) << text;
    return dir_ / name;
  }

  static RunResult run(const std::string& arguments) {
    RunResult result;
    FILE* pipe = ::popen(fmt::format("{} {} 2>&1", ATLAS_EXPORT, arguments).c_str(), "r");
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) {
      result.output.append(buffer, n);
    }
    const int status = ::pclose(pipe);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
  }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(dir_)) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }

  // Runs on a scene that cannot be exported: one line that contains `expected`, exit 1 or 2,
  // nothing written.
  void expect_refusal(const fs::path& scene, const std::string& expected,
                      const std::string& more = "") {
    const auto before = files();
    const RunResult r =
        run(fmt::format("{} -o {} {}", scene.string(), (dir_ / "world.wrl").string(), more));
    EXPECT_TRUE(r.exit_code == 1 || r.exit_code == 2) << r.exit_code << "\n" << r.output;
    EXPECT_EQ(std::count(r.output.begin(), r.output.end(), '\n'), 1) << r.output;
    EXPECT_NE(r.output.find(expected), std::string::npos) << r.output;
    EXPECT_EQ(files(), before);
  }

  fs::path dir_;
};

// A room of n x n quads a side seen from inside, lit by a smooth function of the position.
std::string lit_box(int n) {
  std::ostringstream obj;
  int first = 1;
  for (int side = 0; side < 6; ++side) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        double p[3];
        p[side / 2] = side % 2;
        p[(side / 2 + 1) % 3] = double(i) / n;
        p[(side / 2 + 2) % 3] = double(j) / n;
        const double light = 1 + 0.5 * std::sin(3 * p[0] + 2 * p[1]) * std::cos(2 * p[2]);
        obj << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << ' ' << light << ' ' << light * 0.9
            << ' ' << light * 0.7 << '\n';
      }
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const int a = first + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
        if (side % 2) {
          obj << "f " << a << ' ' << c << ' ' << d << ' ' << b << '\n';
        } else {
          obj << "f " << a << ' ' << b << ' ' << d << ' ' << c << '\n';
        }
      }
    }
    first += (n + 1) * (n + 1);
  }
  return obj.str();
}

std::string slurp(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

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
  // Six flat sides: two triangles each are enough once the light is in the texture.
  EXPECT_LE(report["simplify"]["triangles_out"].get<int>(), 6 * 4);
}

TEST_F(AtlasExport, GlbHoldsItsImages) {
  write("box.obj", lit_box(6));
  const RunResult r = run(fmt::format("{0}/box.obj -o {0}/w.glb --texel 2cm", dir_.string()));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(files(), (std::set<std::string>{"box.obj", "w.glb"}));
}

// A number where nothing was measured would read as perfect, or as hopeless.
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

TEST_F(AtlasExport, MissingFile) {
  expect_refusal(dir_ / "nowhere.obj", "nowhere.obj");
}

TEST_F(AtlasExport, MalformedLine) {
  expect_refusal(write("bad.obj", "v 0 0 0 1 1 1\nv 1 zero 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n"),
                 "bad.obj:2");
}

TEST_F(AtlasExport, TruncatedBinary) {
  expect_refusal(write("cut.ply",
                       "ply\nformat binary_little_endian 1.0\nelement vertex 1000\n"
                       "property float x\nproperty float y\nproperty float z\n"
                       "element face 1\nproperty list uchar int vertex_indices\nend_header\nabc"),
                 "cut.ply");
}

// The soup of an STL becomes one chart, since its corners are joined.
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
  // What would do nothing.
  expect_refusal(scene, "--uv-aspect requires --keep-uv-charts", "--uv-aspect 2");
  expect_refusal(scene, "--charts-only excludes --exr", "--charts-only --exr");
}

// Every number has its range, and no number is in none.
TEST_F(AtlasExport, AbsurdNumbers) {
  const fs::path scene = write("box.obj", lit_box(2));
  for (const std::string option :
       {"--max-stretch 0.5", "--max-stretch inf", "--cone 400",
        "--cone nan",        "--crease -5",       "--threads -1",
        "--threads 2.5",     "--atlases -3",      "--atlas-size 2147483648",
        "--white -1",        "--exposure 1e9",    "--slip inf",
        "--shifts 0",        "--mips 9",          "--uv-aspect 0",
        "--bake x",          "--preset good",     "--memory 1",
        "--unit 0",          "--threshold nan",   "--bogus"}) {
    expect_refusal(scene, option.substr(0, option.find(' ')), option);
  }
  expect_refusal(scene, "more than the whole scene", "-q --texel 1km");
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
  // A scene whose texture has the name of the first new page.
  ASSERT_EQ(run(fmt::format("{0}/box.obj -o {0}/w.obj -q", dir_.string())).exit_code, 0);
  const std::string page = slurp(dir_ / "w_0.png");
  write("t.mtl", "newmtl t\nmap_Kd w_0.png\n");
  write("textured.obj", "mtllib t.mtl\nusemtl t\n" + lit_box(2));
  const RunResult again = run(fmt::format("{0}/textured.obj -o {0}/w.wrl", dir_.string()));
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.output.find("w_0.png"), std::string::npos) << again.output;
  EXPECT_EQ(slurp(dir_ / "w_0.png"), page);
  EXPECT_EQ(run(fmt::format("{0}/textured.obj -o {0}/v.wrl -q", dir_.string())).exit_code, 0);
  // A world without light of its own gets no pages, and needs no textures.
  EXPECT_EQ(run(fmt::format("{0}/w.obj -o {0}/w.gltf -q", dir_.string())).exit_code, 0);
  EXPECT_EQ(slurp(dir_ / "w_0.png"), page);
}

// An OBJ's materials, a glTF's buffer: known only when the scene has been read.
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
  EXPECT_NE(r.output.find("do not fit 1 page of 64 x 64"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("more --atlases or a larger --atlas-size"), std::string::npos);
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

// A few millimetres across, and no texel is asked for.
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
  EXPECT_EQ(report["plan"]["steps"][0]["stage"], "charts");
  EXPECT_EQ(report["plan"]["steps"][0]["run"], true);
  EXPECT_EQ(report["skipped"][0]["stage"], "reflectance");
  EXPECT_FALSE(report.contains("charts")) << "figures of what was not done";
}

TEST_F(AtlasExport, APlanThatCannotBeCarriedOutSaysSo) {
  write("box.obj", lit_box(4));
  const RunResult r =
      run(fmt::format("{0}/box.obj -o {0}/w.wrl --plan --texel 50m", dir_.string()));
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.output.find("more than the whole scene"), std::string::npos) << r.output;
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
      ::execl(ATLAS_EXPORT, ATLAS_EXPORT, (dir_ / "box.obj").c_str(), "-o",
              (dir_ / "w.wrl").c_str(), "--texel", "0.5mm", "--threshold", "0", "-q", nullptr);
      ::_exit(127);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status) || WIFSIGNALED(status));
    // Stopped before the handler stood, or by it: either way the folder is as it was.
    ASSERT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "the scene was too small";
    EXPECT_EQ(files(), before) << milliseconds;
  }
}

}  // namespace

// Tests atlas-play as users run it: every failure ends in one clear line and exit code 1.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "tests/apps/atlas_play/run_play.h"
#include "tests/support/xvfb.h"

namespace atlas::test {
namespace {

TEST_F(AtlasPlay, WithoutAnEglDriver) {
  expect_one_line(run("roof.obj --headless -q", "__EGL_VENDOR_LIBRARY_DIRS=/nonexistent"), "EGL");
}

TEST_F(AtlasPlay, WithAnOldOpenGl) {
  expect_one_line(run("roof.obj --headless --software -q", "MESA_GL_VERSION_OVERRIDE=3.3"),
                  "OpenGL 4.5");
}

TEST_F(AtlasPlay, WithoutADisplay) {
  expect_one_line(run("roof.obj -q", "-u DISPLAY -u WAYLAND_DISPLAY"), "try --headless");
  expect_one_line(run("roof.obj -q", "-u WAYLAND_DISPLAY DISPLAY=:987"), "try --headless");
}

TEST_F(AtlasPlay, WithoutTriangles) {
  expect_one_line(run("points.obj --headless -q"), "points.obj: no triangle");
  expect_one_line(run("absent.obj --headless -q"), "absent.obj");
}

TEST_F(AtlasPlay, ScenesOfStrangersStayInTheirFolder) {
  fs::create_directories(dir_ / "scene");
  std::ofstream(dir_ / "secret.mtl") << "newmtl a\nKd 1 0 0\n";
  std::ofstream(dir_ / "scene/s.obj")
      << "mtllib ../secret.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(run("scene/s.obj --headless --software -q --screenshot s.png").exit_code, 0);
  expect_one_line(run("scene/s.obj --headless --software -q --confine"), "leave out --confine");
}

TEST_F(AtlasPlay, AbsurdOptions) {
  for (const std::string option :
       {"--width 0",     "--width 1.5", "--fov nan",         "--ambient nan",    "--exposure 0",
        "--roughness 0", "--map 15",    "--map-bits 8",      "--pcf 2",          "--march-steps 0",
        "--interval 0",  "--step nan",  "--key-degrees 100", "--shading pink",   "--shadows long",
        "--light-end x", "--up w",      "--frames 0",        "--bench-frames 0", "--bogus",
        "--step -1",     "--speed -1",  "--camera 1,2,3"}) {
    const RunResult r = run("roof.obj --headless --software -q " + option);
    EXPECT_EQ(r.exit_code, 2) << option;
    EXPECT_EQ(r.errors.rfind("atlas-play: error: ", 0), 0u) << r.errors;
    EXPECT_EQ(std::count(r.errors.begin(), r.errors.end(), '\n'), 1) << r.errors;
    EXPECT_NE(r.errors.find(option.substr(0, option.find(' '))), std::string::npos) << r.errors;
  }
}

TEST_F(AtlasPlay, AConfigurationFileWithAnOptionThatDoesNotExist) {
  std::ofstream(dir_ / "good.toml") << "width=20\nheight=10\nshadows=\"none\"\n";
  std::ofstream(dir_ / "bad.toml") << "widht=20\n";
  const std::string headless = "roof.obj --headless --software -q --screenshot c.png --config ";
  EXPECT_EQ(run(headless + "good.toml").exit_code, 0);
  const RunResult r = run(headless + "bad.toml");
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.errors.find("widht"), std::string::npos) << r.errors;
}

TEST_F(AtlasPlay, TheHelpShowsEveryFormOfTheLight) {
  const std::string help = run("--help").output;
  for (const auto& [form, light] : {std::pair("sun:DAY,LATITUDE,HOUR", "sun:172,50.45,9"),
                                    {"fixed:x,y,z", "fixed:1,2,1"},
                                    {"line:x,y,z;x,y,z", "line:1,1,0;-1,1,0"},
                                    {"arc:x,y,z;x,y,z", "arc:1,1,0;-1,1,0"},
                                    {"keys:x,y,z;x,y,z;...", "keys:1,1,0;0,1,1;-1,1,0"}}) {
    EXPECT_NE(help.find(form), std::string::npos) << help;
    const RunResult r = run(fmt::format("roof.obj --headless --software -q --light '{}'", light));
    EXPECT_EQ(r.exit_code, 0) << r.errors;
  }
}

TEST_F(AtlasPlay, LooksStraightDownAndUp) {
  const std::string common =
      "roof.obj --headless --software -q --width 16 --height 12 --map 32 --screenshot ";
  ASSERT_EQ(run(common + "down.png --camera '0,5,0;0,0,0'").exit_code, 0);
  ASSERT_EQ(run(common + "up.png --camera '0,0.5,0;0,5,0'").exit_code, 0);
  ASSERT_EQ(run(common + "sky.png --camera '0,5,0;0,9,0.1'").exit_code, 0);
  EXPECT_NE(text_of(dir_ / "down.png"), text_of(dir_ / "sky.png"));
  EXPECT_NE(text_of(dir_ / "up.png"), text_of(dir_ / "sky.png"));
}

// The readers store positions relative to an origin of their own.
TEST_F(AtlasPlay, TheCameraIsInTheCoordinatesOfTheFile) {
  std::ofstream(dir_ / "far.obj") << "v 499999 1 3999999\nv 500001 1 3999999\nv 500000 1 4000001\n"
                                     "v 499998 0 3999998\nv 500002 0 3999998\nv 500000 0 4000003\n"
                                     "f 3 2 1\nf 6 5 4\n";
  const std::string options =
      " --headless --software -q --width 16 --height 12 --map 32 --light fixed:0,1,1 --screenshot ";
  ASSERT_EQ(run("roof.obj" + options + "near.png --camera '0,3,4;0,0,0'").exit_code, 0);
  ASSERT_EQ(
      run("far.obj" + options + "far.png --camera '500000,3,4000004;500000,0,4000000'").exit_code,
      0);
  EXPECT_EQ(text_of(dir_ / "near.png"), text_of(dir_ / "far.png"));
}

TEST_F(AtlasPlay, ScenesInOtherUnitsAreEnteredAlike) {
  const auto box = [&](const char* name, double s) {  // seen from inside
    std::ofstream f(dir_ / name);
    for (int i = 0; i < 8; ++i)
      f << "v " << s * (i & 1 ? 6 : 0) << ' ' << s * (i & 2 ? 3 : 0) << ' ' << s * (i & 4 ? 4 : 0)
        << '\n';
    f << "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
  };
  box("m.obj", 1);
  box("mm.obj", 1000);
  const std::string options =
      " --headless --software -q --width 64 --height 48 --map 32 --light fixed:0,1,1 --ambient 1 "
      "--screenshot ";
  ASSERT_EQ(run("m.obj" + options + "m.png").exit_code, 0);
  ASSERT_EQ(run("mm.obj" + options + "mm.png --unit mm").exit_code, 0);
  EXPECT_EQ(text_of(dir_ / "m.png"), text_of(dir_ / "mm.png"));
  const RunResult wrong = run("m.obj --headless --software --unit ell");
  EXPECT_NE(wrong.exit_code, 0);
  EXPECT_NE(wrong.errors.find("--unit"), std::string::npos) << wrong.errors;
}

TEST_F(AtlasPlay, SaysWhatTheSceneLacks) {
  std::ofstream(dir_ / "bare.mtl") << "newmtl a\nmap_Kd gone.png\n";
  std::ofstream(dir_ / "bare.obj") << "mtllib bare.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                      "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  const std::string command = "bare.obj --headless --software --width 8 --height 8 --map 32";
  const RunResult r = run(command);
  EXPECT_EQ(r.exit_code, 0) << r.errors;
  EXPECT_NE(r.errors.find("defect: 1 x textures not found"), std::string::npos) << r.errors;
  EXPECT_EQ(run(command + " -q").errors,
            "atlas-play: defect: 1 x textures not found, plain diffuse colour used (first at "
            "gone.png (bare.mtl:2))\n");
}

// The error is reported before anything is drawn.
TEST_F(AtlasPlay, PlacesThatTakeNoFiles) {
  for (const char* option :
       {"--record roof.obj", "--bench roof.obj", "--screenshot a.xyz", "--screenshot no/a.png"}) {
    const RunResult r = run(std::string("roof.obj --headless --software -q ") + option);
    EXPECT_TRUE(r.exit_code == 1 || r.exit_code == 2) << option;
    EXPECT_EQ(std::count(r.errors.begin(), r.errors.end(), '\n'), 1) << r.errors;
    EXPECT_FALSE(fs::exists(dir_ / "no"));
  }
}

TEST_F(AtlasPlay, AStaticLightIsOnePass) {
  const RunResult r =
      run("roof.obj --headless --software --frames 20 --light fixed:0,1,1 --map 64");
  EXPECT_EQ(r.exit_code, 0) << r.errors;
  EXPECT_NE(r.output.find("20 frames"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find(", 1 shadow maps begun"), std::string::npos) << r.output;
}

// Whoever follows the advice to try --headless would otherwise see nothing at all.
TEST_F(AtlasPlay, AHeadlessRunThatWritesNoPictureSaysSo) {
  const std::string bare = "roof.obj --headless --software --width 16 --height 12 --map 32";
  const std::string advice = "no picture was written (--screenshot FILE.png";
  EXPECT_NE(run(bare).output.find(advice), std::string::npos);
  for (const char* kept : {" --screenshot a.png", " --record film", " -q"})
    EXPECT_EQ(run(bare + kept).output.find(advice), std::string::npos) << kept;
}

TEST_F(AtlasPlay, RecordsEveryFrameFromTheCameraAskedFor) {
  const std::string common =
      "roof.obj --headless --software -q --width 32 --height 16 --map 32 --frames 3 --up z "
      "--light 'keys:0,1,0;1,1,0;1,1,1' --light-end back --step 20 ";
  ASSERT_EQ(run(common + "--record a --camera '0,3,4;0,0,0'").exit_code, 0);
  ASSERT_EQ(run(common + "--record b --camera '0,3,4;0,0,0'").exit_code, 0);
  ASSERT_EQ(run(common + "--record c --camera '3,3,1;0,0,0'").exit_code, 0);
  for (int f = 0; f < 3; ++f) {
    const std::string name = fmt::format("frame{:05}.png", f);
    EXPECT_FALSE(text_of(dir_ / "a" / name).empty());
    EXPECT_EQ(text_of(dir_ / "a" / name), text_of(dir_ / "b" / name));
    EXPECT_NE(text_of(dir_ / "a" / name), text_of(dir_ / "c" / name));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_ / "a"), fs::directory_iterator()), 3);
  for (const char* camera : {"1,2,3;1,2,3", "1,2,3;4,5", "1,2,3;4,5,6x", "nan,2,3;4,5,6"}) {
    const RunResult r = run(common + fmt::format("--camera '{}'", camera));
    EXPECT_EQ(r.exit_code, 2) << camera;
    EXPECT_NE(r.errors.find("two different points"), std::string::npos) << r.errors;
  }
}

TEST_F(AtlasPlay, LightPathsThatCannotBe) {
  for (const std::string light : {"fixed:0,0,0", "fixed:1,nan,0", "keys:0,1,0", "arc:1,0,0;-1,0,0",
                                  "sun:1,89,12", "line:", "nowhere:1", "line:1,0,0;0,1,0;0,0,1"}) {
    const RunResult r =
        run(fmt::format("roof.obj --headless --software -q --frames 1 --light '{}'", light));
    EXPECT_EQ(r.exit_code, 2) << light;
    EXPECT_EQ(r.errors.rfind(fmt::format("atlas-play: error: --light {}: ", light), 0), 0u)
        << r.errors;
    EXPECT_EQ(std::count(r.errors.begin(), r.errors.end(), '\n'), 1) << r.errors;
  }
}

TEST_F(AtlasPlay, TheBenchMeasuresWhatItIsAsked) {
  const std::string bench =
      "roof.obj --software --width 48 --height 32 --map 32 --bench-seconds 0 --bench-frames 2 "
      "--bench-shadings unlit,ward --bench-methods none,march --bench-error-frames 2 "
      "--bench-intervals 2,4 --bench ";
  const RunResult r = run(bench + "b");
  EXPECT_NE(r.output.find("\n| unlit | none |"), std::string::npos) << r.output;
  ASSERT_EQ(r.exit_code, 0) << r.errors;
  for (const char* words : {"| unlit | none |", "| ward | march |", "| march | 2 |",
                            "| march | 4 |", "wrote b (gnuplot"}) {
    EXPECT_NE(r.output.find(words), std::string::npos) << words << "\n" << r.output;
  }
  EXPECT_EQ(r.output.find("lambert |"), std::string::npos);
  EXPECT_NE(text_of(dir_ / "b" / "summary.json").find("ward"), std::string::npos);
  EXPECT_TRUE(fs::exists(dir_ / "b" / "error.dat"));
  const RunResult times = run(bench + "c --no-errors");
  ASSERT_EQ(times.exit_code, 0) << times.errors;
  EXPECT_EQ(times.output.find("| march | 2 |"), std::string::npos) << times.output;
}

TEST_F(AtlasPlay, FramesOfAnEarlierRecordingAreNamed) {
  const std::string command =
      "roof.obj --headless --software --width 8 --height 8 --map 32 --record film --frames ";
  EXPECT_EQ(run(command + "5").output.find("earlier"), std::string::npos);
  const RunResult r = run(command + "2");
  EXPECT_EQ(r.exit_code, 0) << r.errors;
  EXPECT_NE(
      r.output.find("film/frame00002.png to frame00004.png: of an earlier recording with more "
                    "frames, no part of this one (may be removed)"),
      std::string::npos)
      << r.output;
  EXPECT_TRUE(fs::exists(dir_ / "film" / "frame00004.png"));
}

TEST_F(AtlasPlay, TheStartTellsHowFarShadowsReach) {
  const std::string command = "roof.obj --plan --software --map 64 ";
  EXPECT_NE(run(command).output.find("shadows reach everywhere; a map's texel is 0."),
            std::string::npos);
  EXPECT_NE(run(command + "--fit-view --view-distance 2.5")
                .output.find("shadows reach 2.5 units from the camera (--view-distance)"),
            std::string::npos);
  EXPECT_EQ(run(command + "--shading unlit").output.find("shadows reach"), std::string::npos);
}

// The page is dark, so a sun on it would be seen.
TEST_F(AtlasPlay, NoSunFallsOnAWorldUnlessOneIsAskedFor) {
  std::ofstream(dir_ / "page.ppm") << "P3\n1 1\n255\n40 60 90\n";
  std::ofstream(dir_ / "world.wrl")
      << "#VRML V2.0 utf8\nShape {\n  appearance Appearance { texture ImageTexture { url "
         "\"page.ppm\" } }\n  geometry IndexedFaceSet {\n    coord Coordinate { point [ -1 0 -1, "
         "1 0 -1, 0 0 1 ] }\n    coordIndex [ 2, 1, 0, -1 ]\n    texCoord TextureCoordinate { "
         "point [ 0 0, 1 0, 0 1 ] }\n    texCoordIndex [ 0, 1, 2, -1 ]\n  }\n}\n";
  const auto picture = [&](const std::string& options) {
    const RunResult r = run(
        "world.wrl --headless --software --width 16 --height 12 --map 32 --camera '0,3,0.1;0,0,0' "
        "--screenshot p.png " +
        options);
    EXPECT_EQ(r.exit_code, 0) << r.errors;
    EXPECT_EQ(r.output.find("no sun: ") != std::string::npos, options.empty()) << r.output;
    return text_of(dir_ / "p.png");
  };
  const std::string stored = picture("--shading unlit");
  EXPECT_EQ(picture(""), stored);
  const std::string sunny = picture("--shading lambert");
  EXPECT_NE(sunny, stored);
  for (const char* options : {"--sun 0.9", "--light sun:172,50.45,9", "--shadows march"})
    EXPECT_EQ(picture(options), sunny) << options;
  EXPECT_NE(picture("--visibility"), stored);
}

TEST_F(AtlasPlay, ThePlanNamesWhatIsNotCompiled) {
  const RunResult r = run("roof.obj --plan --software --shading unlit");
  EXPECT_EQ(r.exit_code, 0) << r.errors;
  for (const char* words :
       {"compiled: unlit\n", "no shadow maps", "no texture code", "no baked light"})
    EXPECT_NE(r.output.find(words), std::string::npos) << words << "\n" << r.output;
}

TEST_F(AtlasPlay, AWindowShowsItsPanelAndCloses) {
  const Xvfb server;
  if (!server.runs()) GTEST_SKIP() << "Xvfb is not installed";
  const RunResult r =
      run("roof.obj --width 160 --height 120 --map 64 --close-after 5 --screenshot w.png --debug "
          "--record film",
          server.environment());
  EXPECT_EQ(r.exit_code, 0) << r.errors;
  EXPECT_NE(r.output.find("5 frames"), std::string::npos) << r.output;
  EXPECT_TRUE(fs::exists(dir_ / "w.png"));
  EXPECT_TRUE(fs::exists(dir_ / "film/frame00004.png")) << "every frame is recorded";
}

TEST_F(AtlasPlay, AWindowEndsByCtrlC) {
  const Xvfb server;
  if (!server.runs()) GTEST_SKIP() << "Xvfb is not installed";
  const int status = std::system(
      fmt::format("cd '{0}' && env {1} XDG_RUNTIME_DIR='{0}' LSAN_OPTIONS=detect_leaks=0 timeout "
                  "--preserve-status -s INT 4 '{2}' roof.obj --width 160 --height 120 --map 64 "
                  ">out 2>err",
                  dir_.string(), server.environment(), ATLAS_PLAY)
          .c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130) << text_of(dir_ / "err");
}

TEST_F(AtlasPlay, ADisplayThatGoes) {
  Xvfb server;
  if (!server.runs()) GTEST_SKIP() << "Xvfb is not installed";
  RunResult r;
  std::thread player(
      [&] { r = run("roof.obj --width 160 --height 120 --map 64", server.environment()); });
  // The plan is printed once the window is open.
  for (int i = 0; i < 600 && text_of(dir_ / "out").find("compiled") == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  server.kill();
  player.join();
  // Drivers may complain, too, in lines of their own (Mesa 24 and newer does).
  std::istringstream lines(std::exchange(r.errors, {}));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("atlas-play")) r.errors += line + '\n';
  expect_one_line(r, "the display server has gone");
}

}  // namespace
}  // namespace atlas::test

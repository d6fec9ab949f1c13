// What atlas-play makes of its options: pictures, measurements, and the files that stay.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_play/run_play.h"

namespace atlas::test {
namespace {

constexpr const char* kSmall = " --headless --software --width 32 --height 24 --map 32 ";

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(AtlasPlay, TheBenchTellsItsSettings) {
  const std::string few =
      "roof.obj --software --width 48 --height 32 --map 64 --pcf 1 -k 5 --bench-frames 2 "
      "--bench-shadings unlit --bench-methods march --bench-error-frames 2 --bench-intervals 4 ";
  const auto errors = [&](const std::string& more) {
    const RunResult r = run(few + "--bench b " + more);
    EXPECT_EQ(r.exit_code, 0) << r.errors;
    EXPECT_TRUE(
        holds(r.output, "(software renderer), 48 x 32, maps 64², k = 5, pcf 1, 2 triangles\n"))
        << r.output;
    const auto json = nlohmann::json::parse(text_of(dir_ / "b/summary.json"));
    EXPECT_EQ(json["errors"].size(), 1u);
    return double(json["errors"][0]["mean_visibility_error"]);
  };
  const double slow = errors("--camera '0,3,4;0,0,0' --step 1");
  EXPECT_GT(slow, 0);
  EXPECT_NE(errors("--camera '0,3,4;0,0,0' --step 4"), slow);
  EXPECT_EQ(errors("--camera '0,3,4;0,9,4.1' --step 4"), 0) << "nothing but sky is seen";
}

TEST_F(AtlasPlay, TheBenchTellsKeysByDegrees) {
  const RunResult r =
      run("roof.obj --software --width 8 --height 8 --map 16 --interval-degrees 4 --bench b "
          "--no-errors "
          "--bench-frames 1 --bench-shadings unlit --bench-methods none");
  EXPECT_TRUE(holds(r.output, "maps 16², keys every 4°, pcf 3")) << r.output << r.errors;
}

// Eight frames take the light 24 degrees far. Keys are nearer only where that is asked for.
TEST_F(AtlasPlay, KeysAreNoFartherApartThanAskedFor) {
  const auto maps = [&](const std::string& more) {
    const RunResult r = run(
        std::string("roof.obj --frames 29 --step 3 --light 'arc:1,1,0;-1,1,0.1' ") + kSmall + more);
    EXPECT_EQ(r.exit_code, 0) << r.errors;
    const std::size_t at = r.output.rfind(" ms, ");
    return at == std::string::npos ? -1 : std::stoi(r.output.substr(at + 5));
  };
  const int usual = maps("");
  EXPECT_GT(usual, 3);
  EXPECT_EQ(maps("--key-degrees 80"), usual);
  EXPECT_EQ(maps("--key-degrees 25"), usual);
  EXPECT_GT(maps("--key-degrees 5"), 2 * usual);
}

// Of an OBJ, textures are colours, which the moving light lights.
TEST_F(AtlasPlay, TexturesHoldLightOnlyWhereTheyAreSaidTo) {
  ASSERT_TRUE(write_png(dir_ / "t.png", Image8(4, 4, 3, 128), {}).ok());
  std::ofstream(dir_ / "t.mtl") << "newmtl a\nmap_Kd t.png\n";
  std::ofstream(dir_ / "t.obj") << "mtllib t.mtl\nusemtl a\nv -2 0 2\nv 2 0 2\nv 0 0 -2\n"
                                   "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  const auto picture = [&](const std::string& more) {
    const RunResult r = run("t.obj -q --screenshot p.png --camera '0,3,4;0,0,0' " + more + kSmall);
    EXPECT_EQ(r.exit_code, 0) << r.errors;
    EXPECT_EQ(r.output, "") << "quiet";
    return text_of(dir_ / "p.png");
  };
  EXPECT_EQ(picture(""), picture("--no-baked-textures"));
  EXPECT_NE(picture(""), picture("--baked-textures"));
}

TEST_F(AtlasPlay, OutputsReplaceNeitherTheSceneNorAFile) {
  fs::create_symlink("roof.obj", dir_ / "shot.png");
  const std::string scene = text_of(dir_ / "roof.obj");
  for (const auto& [option, words] :
       {std::pair("--screenshot shot.png", "shot.png: would overwrite"),
        {"--screenshot roof.obj", "roof.obj: the screenshot must end in .png"},
        {"--record roof.obj", "roof.obj: is a file (name a folder"},
        {"--bench roof.obj", "roof.obj: is a file (name a folder"}}) {
    const RunResult r = run(std::string("roof.obj") + kSmall + option);
    EXPECT_EQ(r.exit_code, 2) << option;
    EXPECT_TRUE(holds(r.errors, words)) << r.errors;
    EXPECT_EQ(r.output, "") << "before anything is drawn";
    EXPECT_EQ(text_of(dir_ / "roof.obj"), scene);
  }
  // Endings may be capitals, and folders may be there.
  fs::create_directories(dir_ / "frames");
  EXPECT_EQ(run(std::string("roof.obj -q --screenshot P.PNG --record frames") + kSmall).exit_code,
            0);
  EXPECT_TRUE(fs::exists(dir_ / "P.PNG") && fs::exists(dir_ / "frames/frame00000.png"));
}

TEST_F(AtlasPlay, OutputsReplaceNoTextureOfTheScene) {
  fs::create_directories(dir_ / "film");
  for (const char* name : {"t.png", "film/frame00001.png", "bumps.png"})
    ASSERT_TRUE(write_png(dir_ / name, Image8(4, 4, 3, 128), {}).ok());
  std::ofstream(dir_ / "t.mtl") << "newmtl a\nmap_Kd t.png\nbump bumps.png\n"
                                   "newmtl b\nmap_Kd film/frame00001.png\n";
  std::ofstream(dir_ / "t.obj") << "mtllib t.mtl\nv -2 0 2\nv 2 0 2\nv 0 0 -2\nvt 0 0\nvt 1 0\n"
                                   "usemtl a\nf 1/1 2/2 3/1\nusemtl b\nf 3/1 2/2 1/1\n";
  const std::string texture = text_of(dir_ / "t.png");
  for (const auto& [option, words] :
       {std::pair("--screenshot t.png", "t.png: would overwrite"),
        {"--screenshot bumps.png", "bumps.png: would overwrite"},
        {"--record film", "film: holds frame00001.png, which is read"}}) {
    const RunResult r = run(std::string("t.obj --frames 2") + kSmall + option);
    EXPECT_EQ(r.exit_code, 2) << option;
    EXPECT_TRUE(holds(r.errors, words)) << r.errors;
    EXPECT_EQ(r.output, "") << "before anything is drawn";
    EXPECT_EQ(text_of(dir_ / "t.png"), texture);
    EXPECT_EQ(text_of(dir_ / "film/frame00001.png"), texture);
  }
  EXPECT_EQ(run(std::string("t.obj -q --screenshot p.png --record other") + kSmall).exit_code, 0);
}

// F12 and the panel's box write files that no option names. Without a window they are not written.
TEST_F(AtlasPlay, AWindowReplacesNoTextureByFilesThatWereNotNamed) {
  fs::create_directories(dir_ / "recording");
  for (const char* name : {"screenshot.png", "recording/frame00001.png"}) {
    ASSERT_TRUE(write_png(dir_ / name, Image8(4, 4, 3, 128), {}).ok());
    std::ofstream(dir_ / "t.mtl") << "newmtl a\nmap_Kd " << name << "\n";
    std::ofstream(dir_ / "t.obj") << "mtllib t.mtl\nv -2 0 2\nv 2 0 2\nv 0 0 -2\nvt 0 0\nvt 1 0\n"
                                     "usemtl a\nf 1/1 2/2 3/1\n";
    const RunResult window = run("t.obj", "-u DISPLAY -u WAYLAND_DISPLAY");
    EXPECT_EQ(window.exit_code, 2) << name;
    EXPECT_TRUE(holds(window.errors, std::string(name).substr(0, 9))) << window.errors;
    EXPECT_EQ(run(std::string("t.obj -q") + kSmall).exit_code, 0) << name;
  }
}

TEST_F(AtlasPlay, OptionsThatWouldChangeNothingAreRefused) {
  for (const auto& [options, words] :
       {std::pair("--plan --screenshot p.png", "--plan draws nothing, so --screenshot"),
        {"--plan --record film", "--plan draws nothing, so --record"},
        {"--plan --bench b", "--plan draws nothing, so --bench"},
        {"--bench b --frames 3", "--frames is not for --bench (give --bench-frames)"},
        {"--bench b --close-after 3", "--close-after is not for --bench"},
        {"--bench b --shading ward", "--shading is not for --bench (give --bench-shadings)"},
        {"--bench b --shadows hold", "--shadows is not for --bench (give --bench-methods)"},
        {"--bench b --visibility", "--visibility is not for --bench"},
        {"", "--software is for --headless"}}) {
    const RunResult r = run(std::string("roof.obj --software ") + options);
    EXPECT_EQ(r.exit_code, 2) << options;
    EXPECT_TRUE(holds(r.errors, words)) << r.errors;
  }
}

}  // namespace
}  // namespace atlas::test

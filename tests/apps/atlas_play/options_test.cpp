// The command line of atlas-play: every option fills in what it is named after.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "apps/atlas-play/command_line.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using app::CommandLine;

app::Parsed parsed(std::vector<std::string> words) {
  words.insert(words.begin(), "atlas-play");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  return app::parse_command_line(int(argv.size()), argv.data());
}

CommandLine good(std::vector<std::string> words) {
  words.insert(words.begin(), "in.obj");
  const app::Parsed p = parsed(words);
  EXPECT_FALSE(p.exit_code) << words.back();
  return p.line;
}

int refused(std::vector<std::string> words) {
  words.insert(words.begin(), "in.obj");
  return parsed(words).exit_code.value_or(-1);
}

void expect_near(const Vec3d& a, const Vec3d& b, const std::string& what) {
  EXPECT_NEAR(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), 0, 1e-9) << what;
}

TEST(PlayOptions, OfThePicture) {
  const CommandLine c = good({"--headless",
                              "--width",
                              "31",
                              "--height",
                              "17",
                              "--fov",
                              "45",
                              "--shading",
                              "ward",
                              "--ambient",
                              "0.5",
                              "--sun",
                              "0.75",
                              "--exposure",
                              "2",
                              "--specular",
                              "0.125",
                              "--shininess",
                              "9",
                              "--roughness",
                              "0.625",
                              "--visibility",
                              "--baked-light",
                              "3",
                              "--unit",
                              "cm"});
  EXPECT_EQ(c.scene, "in.obj");
  EXPECT_EQ(c.render.width, 31);
  EXPECT_EQ(c.render.height, 17);
  EXPECT_EQ(c.fov, 45);
  EXPECT_EQ(c.render.shading, Shading::ward);
  EXPECT_EQ(c.render.ambient, 0.5);
  EXPECT_EQ(c.render.intensity, 0.75);
  EXPECT_EQ(c.render.exposure, 2);
  EXPECT_EQ(c.render.specular, 0.125);
  EXPECT_EQ(c.render.shininess, 9);
  EXPECT_EQ(c.render.roughness, 0.625);
  EXPECT_EQ(c.render.baked_strength, 3);
  EXPECT_TRUE(c.render.show_visibility);
  EXPECT_EQ(c.unit, 0.01);
  for (const auto& [name, shading] : {std::pair("unlit", Shading::unlit),
                                      {"lambert", Shading::lambert},
                                      {"blinn-phong", Shading::blinn_phong}})
    EXPECT_EQ(good({"--shading", name}).render.shading, shading);
  EXPECT_FALSE(good({"--quantity", "illuminance"}).colours);
  EXPECT_TRUE(good({"--quantity", "colour"}).colours);
  EXPECT_FALSE(good({"--headless", "--up", "z"}).sun_asked);
  for (const char* option :
       {"--shading=unlit", "--sun=1", "--light=fixed:0,1,0", "--shadows=none", "--visibility"})
    EXPECT_TRUE(good({option}).sun_asked) << option;
  EXPECT_EQ(good({}).baked_textures, std::nullopt);
  EXPECT_EQ(good({"--baked-textures"}).baked_textures, true);
  EXPECT_EQ(good({"--no-baked-textures"}).baked_textures, false);
  EXPECT_EQ(refused({"--baked-textures", "--no-baked-textures"}), 2);
}

// A window is larger than a picture, unless its size is given.
TEST(PlayOptions, WindowsAndPicturesHaveTheirOwnSizes) {
  const auto size = [](const std::vector<std::string>& words) {
    const CommandLine c = good(words);
    return std::pair(c.render.width, c.render.height);
  };
  EXPECT_EQ(size({}), std::pair(1280, 800));
  EXPECT_EQ(size({"--width", "99"}), std::pair(99, 800));
  EXPECT_EQ(size({"--height", "99"}), std::pair(1280, 99));
  for (const char* option : {"--headless", "--plan"})
    EXPECT_EQ(size({option}), std::pair(640, 400)) << option;
  EXPECT_EQ(size({"--bench", "b"}), std::pair(640, 400));
}

TEST(PlayOptions, OfShadows) {
  const CommandLine c = good({"--shadows",
                              "slerp",
                              "--map",
                              "512",
                              "--map-bits",
                              "16",
                              "--pcf",
                              "5",
                              "--march-steps",
                              "7",
                              "--slope-bias",
                              "0.25",
                              "--normal-offset",
                              "0.5",
                              "--fit-view",
                              "--view-distance",
                              "12",
                              "--no-snap",
                              "--interval-degrees",
                              "3",
                              "--key-degrees",
                              "20",
                              "--no-slices"});
  EXPECT_EQ(c.render.shadows, ShadowMethod::slerp);
  EXPECT_EQ(c.render.map_resolution, 512);
  EXPECT_EQ(c.render.map_bits, 16);
  EXPECT_EQ(c.render.pcf, 5);
  EXPECT_EQ(c.render.march_steps, 7);
  EXPECT_EQ(c.render.slope_bias, 0.25);
  EXPECT_EQ(c.render.normal_offset, 0.5);
  EXPECT_TRUE(c.render.fit_view);
  EXPECT_EQ(c.render.view_distance, 12);
  EXPECT_FALSE(c.render.snap);
  EXPECT_EQ(c.render.schedule.interval_degrees, 3);
  EXPECT_EQ(c.key_degrees, 20);
  EXPECT_FALSE(c.render.schedule.sliced);
  const CommandLine plain = good({"-k", "5"});
  EXPECT_EQ(plain.render.schedule.interval_frames, 5);
  EXPECT_TRUE(plain.render.snap && plain.render.schedule.sliced && !plain.render.fit_view);
  EXPECT_EQ(plain.key_degrees, std::nullopt);
  for (const ShadowMethod method : kAllMethods)
    EXPECT_EQ(good({"--shadows", name_of(method)}).render.shadows, method);
  for (const int bits : {16, 24, 32})
    EXPECT_EQ(good({"--map-bits", std::to_string(bits)}).render.map_bits, bits);
  for (const int taps : {0, 1, 3, 5})
    EXPECT_EQ(good({"--pcf", std::to_string(taps)}).render.pcf, taps);
}

TEST(PlayOptions, OfRunning) {
  const CommandLine c = good({"--headless", "--software", "--frames", "12", "--record", "r",
                              "--screenshot", "s.png", "--debug", "-q", "--step", "4"});
  EXPECT_TRUE(c.headless && c.software && c.debug && c.quiet && !c.plan && c.vsync);
  EXPECT_EQ(c.play.frames, 12);
  EXPECT_EQ(c.play.record, "r");
  EXPECT_EQ(c.play.screenshot, "s.png");
  EXPECT_EQ(c.play.degrees_per_frame, 4);
  const CommandLine w =
      good({"--close-after", "7", "--no-vsync", "--speed", "30", "--max-step", "5"});
  EXPECT_TRUE(w.in_window() && !w.vsync && !w.software && !w.debug && !w.quiet);
  EXPECT_EQ(w.play.close_after, 7);
  EXPECT_EQ(w.play.degrees_per_second, 30);
  EXPECT_EQ(w.play.max_step, 5);
  EXPECT_FALSE(good({"--plan"}).in_window());
  EXPECT_EQ(refused({"--plan", "--headless", "--close-after", "7"}), 2);
  EXPECT_EQ(good({"--plan", "--frames", "7"}).play.frames, 7);
  EXPECT_EQ(refused({"--plan", "--quiet"}), 2) << "it would tell nothing";
}

TEST(PlayOptions, OfTheBench) {
  const CommandLine c =
      good({"--bench", "b", "--bench-seconds", "1.5", "--bench-frames", "9", "--bench-shadings",
            "ward,unlit", "--bench-methods", "march,none", "--bench-intervals", "3,5",
            "--bench-error-frames", "11", "--no-errors"});
  EXPECT_EQ(c.bench, "b");
  EXPECT_EQ(c.measure.seconds, 1.5);
  EXPECT_EQ(c.measure.frames, 9);
  EXPECT_EQ(c.measure.shadings, (std::vector{Shading::ward, Shading::unlit}));
  EXPECT_EQ(c.measure.methods, (std::vector{ShadowMethod::march, ShadowMethod::none}));
  EXPECT_EQ(c.measure.error_intervals, (std::vector{3, 5}));
  EXPECT_EQ(c.measure.error_frames, 11);
  EXPECT_TRUE(c.no_errors);
  EXPECT_FALSE(good({"--bench", "b"}).no_errors);
}

// At noon on the northern half of the earth the sun stands in the south, halfway up at 45 degrees
// on the day when day and night are equal.
TEST(PlayOptions, TheSunFollowsTheAxesOfTheScene) {
  const double h = std::sqrt(0.5);
  const auto noon = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--light", "sun:81,45,12"});
    const CommandLine c = good(words);
    return std::pair(c.render.up, c.play.light.direction(0));
  };
  struct Case {
    const char* up;
    Vec3d axis, north;
  };
  for (const Case& c : {Case{"x", {1, 0, 0}, {0, 1, 0}}, Case{"y", {0, 1, 0}, {0, 0, -1}},
                        Case{"z", {0, 0, 1}, {0, 1, 0}}, Case{"X", {1, 0, 0}, {0, 1, 0}},
                        Case{"Y", {0, 1, 0}, {0, 0, -1}}}) {
    const auto [up, sun] = noon({"--up", c.up});
    expect_near(up, c.axis, c.up);
    const Vec3d wanted{h * (c.axis.x - c.north.x), h * (c.axis.y - c.north.y),
                       h * (c.axis.z - c.north.z)};
    EXPECT_NEAR(std::hypot(sun.x - wanted.x, sun.y - wanted.y, sun.z - wanted.z), 0, 0.02) << c.up;
  }
  expect_near(noon({}).first, {0, 1, 0}, "y by default");
  const Vec3d east = noon({"--north", "1,0,0"}).second;
  EXPECT_NEAR(std::hypot(east.x + h, east.y - h, east.z), 0, 0.02);
}

// After the whole path and a tenth of it.
TEST(PlayOptions, TheLightLoopsGoesBackOrStops) {
  const auto after = [](const std::vector<std::string>& end) {
    std::vector<std::string> words{"--light", "arc:1,0,0;0,1,0"};
    words.insert(words.end(), end.begin(), end.end());
    const LightPath light = good(words).play.light;
    EXPECT_NEAR(light.length(), 90, 1e-9);
    const Vec3d d = light.direction(100);
    return std::lround(std::atan2(d.y, d.x) * 180 / 3.14159265358979);
  };
  EXPECT_EQ(after({}), 10);
  EXPECT_EQ(after({"--light-end", "loop"}), 10);
  EXPECT_EQ(after({"--light-end", "back"}), 80);
  EXPECT_EQ(after({"--light-end", "stop"}), 90);
  EXPECT_EQ(after({"--light-end", "Back"}), 80);
}

// Worlds of atlas-export say that z points up; the option has the last word.
TEST(PlayOptions, WorldsSayWhatIsUp) {
  const test::TempFolder folder;
  const auto file =
      folder.write("up.wrl", "#VRML V2.0 utf8\nWorldInfo { info \"the z axis points up\" }\n");
  expect_near(parsed({file.string()}).line.render.up, {0, 0, 1}, "as the file says");
  expect_near(parsed({file.string(), "--up", "y"}).line.render.up, {0, 1, 0}, "as the user says");
}

TEST(PlayOptions, TheCameraIsTwoPoints) {
  ViewScene scene;
  scene.bounds = {{-1, -1, -1}, {1, 1, 1}};
  scene.origin = {100, 200, 300};
  CommandLine line = good({"--camera", "101, 202,303; 100,200.5,-3e2"});
  const Result<Camera> camera = app::camera_of(line, scene);
  ASSERT_TRUE(camera.ok());
  expect_near(camera->eye, {1, 2, 3}, "eye");
  expect_near(camera->target, {0, 0.5, -600}, "target");
  EXPECT_EQ(camera->fov_degrees, 60);
  CommandLine wide = good({"--fov", "100", "--camera", "101,202,303;0,0,0"});
  EXPECT_EQ(app::camera_of(wide, scene)->fov_degrees, 100);
  wide.camera.clear();
  EXPECT_EQ(app::camera_of(wide, scene)->fov_degrees, 100);
  // From far away, the planes enclose the scene closely.
  line.camera = "100,200,1300;100,200,300";
  const Result<Camera> far = app::camera_of(line, scene);
  EXPECT_GT(far->near_plane, 500);
  EXPECT_LE(far->near_plane, 999);
  EXPECT_GE(far->far_plane, 1001);
  for (const char* wrong :
       {"1,2,3;1,2,3", "1,2,3;4,5", "1,2,3,4,5,6", "1;2,3,4,5,6", "1,2,3;4,5,6;", "1,2,3;4,5,inf",
        "1,2,3;4,5,nan", ",2,3;4,5,6", "1,2,3;4,5,6 7"}) {
    line.camera = wrong;
    const Result<Camera> bad = app::camera_of(line, scene);
    ASSERT_FALSE(bad.ok()) << wrong;
    EXPECT_EQ(bad.status().code(), ErrorCode::bad_option) << wrong;
  }
}

}  // namespace
}  // namespace atlas::test

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "libatlas/exporters/world.h"
#include "libatlas/image/image_io.h"
#include "libatlas/view/bench.h"
#include "libatlas/view/play.h"
#include "tests/support/full_disk.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

namespace fs = std::filesystem;

class Folder : public ::testing::Test {
 protected:
  Folder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = fs::temp_directory_path() / (std::string("atlas-view-") + info->name());
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Folder() override { fs::remove_all(path_); }
  fs::path path_;
};

using Play = Folder;
using Bench = Folder;

RenderOptions small() {
  RenderOptions o;
  o.width = 48;
  o.height = 32;
  o.map_resolution = 128;
  return o;
}

// A courtyard that is ready to be played, small and in three frames.
struct Show {
  Show() {
    options.camera = view.camera;
    options.light = *LightPath::make({});
    options.frames = 3;
  }
  Result<PlaySummary> play(const Context& context = {}) {
    return play_headless(test_context(), renderer, options, context);
  }

  View view = courtyard_view();
  Renderer renderer = must_render(view.scene, small());
  PlayOptions options;
};

TEST_F(Play, RecordsNumberedPicturesAndTheLastOne) {
  Show show;
  PlayOptions& o = show.options;
  o.record = path_ / "series";
  o.screenshot = path_ / "last.png";
  const Result<PlaySummary> done = show.play();
  ASSERT_TRUE(done.ok()) << done.status().message();
  EXPECT_EQ(done->frames, 3);
  EXPECT_EQ(done->recorded, 3);
  for (const char* name : {"frame00000.png", "frame00001.png", "frame00002.png"}) {
    const Result<Image8> image = read_image8(o.record / name);
    ASSERT_TRUE(image.ok());
    EXPECT_EQ(image->width, 48);
  }
  EXPECT_EQ(read_image8(o.record / "frame00002.png")->texels, read_image8(o.screenshot)->texels);
}

TEST_F(Play, AFullDiskLeavesNoPicture) {
  Show show;
  PlayOptions& o = show.options;
  for (auto* file : {&o.screenshot, &o.record}) {
    o.screenshot.clear();
    o.record.clear();
    *file = path_ / "p.png";
    if (file == &o.screenshot) std::ofstream(*file) << "what was there before";
    const test::FullDisk full(200);
    const Result<PlaySummary> done = show.play();
    ASSERT_EQ(done.status().code(), ErrorCode::io);
    EXPECT_NE(done.status().message().find("p.png"), std::string::npos);
    EXPECT_EQ(done.status().message().find(".part"), std::string::npos) << done.status().message();
    if (file == &o.screenshot) {
      EXPECT_EQ(fs::file_size(*file), 21u);  // unchanged
      fs::remove(*file);
    }
    EXPECT_TRUE(fs::is_empty(file == &o.record ? *file : path_));
  }
}

TEST_F(Play, ErrorsAreOneLine) {
  Show show;
  PlayOptions& o = show.options;
  std::ofstream(path_ / "file") << "x";
  o.record = path_ / "file" / "series";
  const Result<PlaySummary> done = show.play();
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.status().code(), ErrorCode::io);
  EXPECT_EQ(done.status().message().find('\n'), std::string::npos);
  std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  o.record.clear();
  EXPECT_EQ(show.play(context).status().code(), ErrorCode::cancelled);
}

TEST_F(Play, ALostContextIsOneLineThatSaysWhy) {
  Show show;
  GlContext& gl = test_context();
  EXPECT_TRUE(gl.check_alive().ok());
  const std::pair<unsigned, const char*> cases[] = {{GL_GUILTY_CONTEXT_RESET, "this program"},
                                                    {GL_INNOCENT_CONTEXT_RESET, "another program"},
                                                    {GL_UNKNOWN_CONTEXT_RESET, "does not tell"}};
  for (const auto& [reset, reason] : cases) {
    int frames = 0;
    gl.set_reset_source([&, after = reset] { return ++frames < 2 ? GL_NO_ERROR : after; });
    const Result<PlaySummary> done = show.play();
    gl.set_reset_source({});
    ASSERT_FALSE(done.ok());
    EXPECT_EQ(frames, 2) << "nothing is drawn after the reset";
    EXPECT_EQ(done.status().code(), ErrorCode::unsupported);
    EXPECT_NE(done.status().message().find("context is lost"), std::string::npos);
    EXPECT_NE(done.status().message().find(reason), std::string::npos);
    EXPECT_EQ(done.status().message().find('\n'), std::string::npos);
  }
  EXPECT_TRUE(show.play().ok());
}

// The driver is asked to report resets, not only our code.
TEST_F(Play, ContextsAreMadeSoThatTheyTellOfResets) {
  test_context();
  GLint strategy = 0;
  glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
  EXPECT_EQ(strategy, GL_LOSE_CONTEXT_ON_RESET);
}

TEST_F(Play, LoadsScenesAndSaysWhatIsWrongWithThem) {
  std::ofstream(path_ / "one.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(path_ / "none.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(load_view(path_ / "one.obj", {}, {})->triangle_count(), 1u);
  for (const char* name : {"none.obj", "absent.obj"}) {
    const Result<ViewScene> v = load_view(path_ / name, {}, {});
    ASSERT_FALSE(v.ok());
    EXPECT_NE(v.status().message().find(name), std::string::npos);
    EXPECT_EQ(v.status().message().find('\n'), std::string::npos);
  }
}

TEST_F(Play, SaysWhichMaterialsStayDark) {
  std::ofstream(path_ / "lamps.obj") << "mtllib lamps.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl "
                                        "lamp\nf 1 2 3\nusemtl screen\nf 3 2 1\n";
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  std::ofstream(path_ / "lamps.mtl") << "newmtl lamp\nKe 2 2 1\nnewmtl screen\nmap_Ke film.png\n";
  const Result<ViewScene> view = load_view(path_ / "lamps.obj", {}, context);
  ASSERT_TRUE(view.ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("1 material ('screen') emits light by a texture: it is not shown"), 0u)
      << said[0];
  ASSERT_EQ(view->emission.size(), view->positions.size());
  const auto shine = [&](const Vec3f& e) {
    return std::count(view->emission.begin(), view->emission.end(), e);
  };
  EXPECT_EQ(shine({2, 2, 1}), 3);
  EXPECT_EQ(shine({0, 0, 0}), 3);
  EXPECT_TRUE(make_view_scene(room(), {})->emission.empty()) << "memory for nothing";
  // Several are told in one line.
  std::ofstream(path_ / "lamps.mtl") << "newmtl lamp\nmap_Ke a.png\nnewmtl screen\nmap_Ke b.png\n";
  said.clear();
  ASSERT_TRUE(load_view(path_ / "lamps.obj", {}, context).ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("2 materials ('lamp', ...) emit light by a texture"), 0u) << said[0];
}

// The codes 128 and 255 are 0.2158 and 1. Without the option they are light, as fractions.
TEST_F(Play, ColoursOfScansAreReflectance) {
  std::ofstream(path_ / "s.ply")
      << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
         "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face "
         "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 128 128 128\n1 0 0 128 128 "
         "128\n0 1 0 255 0 0\n3 0 1 2\n";
  const ViewScene light = *load_view(path_ / "s.ply", {}, {});
  EXPECT_EQ(light.illumination.size(), 3u);
  EXPECT_EQ(light.colours[0], (Vec3f{1, 1, 1}));
  const ViewScene view = *load_view(path_ / "s.ply", {.vertices_hold_colours = true}, {});
  EXPECT_TRUE(view.illumination.empty());
  EXPECT_FALSE(view.baked());
  ASSERT_EQ(view.colours.size(), 3u);
  EXPECT_EQ(std::count(view.colours.begin(), view.colours.end(), Vec3f{1, 0, 0}), 1);
  for (const Vec3f& c : view.colours)
    EXPECT_TRUE(c.x == 1 || std::abs(c.x - 0.2158f) < 1e-3f) << c.x;
}

TEST_F(Play, SaysWhatIsShownOpaque) {
  std::ofstream(path_ / "p.obj") << "mtllib p.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl "
                                    "pane\nf 1 2 3\nusemtl wall\nf 3 2 1\n";
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  std::ofstream(path_ / "p.mtl") << "newmtl pane\nd 0.1\nnewmtl wall\nd 1\n";
  ASSERT_TRUE(load_view(path_ / "p.obj", {}, context).ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("1 material ('pane') is transparent: shown opaque"), 0u) << said[0];
  std::ofstream(path_ / "p.mtl") << "newmtl pane\nd 1\nnewmtl wall\nd 1\n";
  ASSERT_TRUE(load_view(path_ / "p.obj", {}, context).ok());
  EXPECT_EQ(said.size(), 1u);
}

TEST_F(Play, SaysWhatTheReaderLeftOut) {
  std::ofstream(path_ / "torn.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n";
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  ASSERT_TRUE(load_view(path_ / "torn.obj", {}, context).ok());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("defect: "), 0u) << said[0];
  EXPECT_NE(said[0].find("torn.obj:5"), std::string::npos) << said[0];
}

TEST_F(Play, TexturesHoldLightIfTheCallerSaysSo) {
  ASSERT_TRUE(write_png(path_ / "t.png", Image8(2, 2, 3, 128), {}).ok());
  std::ofstream(path_ / "a.mtl") << "newmtl m\nmap_Kd t.png\n";
  std::ofstream(path_ / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                                    "f 1/1 2/1 3/1\n";
  for (const bool baked : {false, true})
    EXPECT_EQ(load_view(path_ / "a.obj", {.textures_hold_light = baked}, {})->baked(), baked);
}

// As those of exported .obj files do.
TEST_F(Play, TexturesThatNothingLightsHoldLight) {
  ASSERT_TRUE(write_png(path_ / "t.png", Image8(2, 2, 3, 128), {}).ok());
  std::ofstream(path_ / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                                    "f 1/1 2/1 3/1\n";
  for (const int model : {0, 1, 2}) {
    std::ofstream(path_ / "a.mtl") << "newmtl m\nillum " << model << "\nmap_Kd t.png\n";
    EXPECT_EQ(load_view(path_ / "a.obj", {}, {})->baked(), model == 0) << model;
    EXPECT_FALSE(load_view(path_ / "a.obj", {.textures_hold_light = false}, {})->baked());
  }
}

// Two triangles with a texture, in glTF whose second material only may be unlit.
std::string two_materials(const std::string& first, const std::string& second) {
  const std::string look = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
  return R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_materials_unlit"],)"
         R"("buffers":[{"uri":"t.bin","byteLength":60}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,)"
         R"("min":[0,0,0],"max":[1,1,0]},)"
         R"({"bufferView":1,"componentType":5126,"type":"VEC2","count":3}],)"
         R"("images":[{"uri":"t.png"}],"textures":[{"source":0}],"materials":[{)" +
         look + first + "},{" + look + second +
         R"(}],"meshes":[{"primitives":[)"
         R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0},)"
         R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":1}]}],)"
         R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})";
}

// The name of the extension says nothing where no material has it.
TEST_F(Play, MaterialsSayWhetherTheirTexturesHoldLight) {
  ASSERT_TRUE(write_png(path_ / "t.png", Image8(2, 2, 3, 128), {}).ok());
  const float values[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::ofstream(path_ / "t.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(values), sizeof values);
  const std::string light = R"(,"extensions":{"KHR_materials_unlit":{}})";
  const std::string other = R"(,"extras":{"note":"KHR_materials_unlit"})";
  const auto unlit = [&](const std::string& first, const std::string& second,
                         std::optional<bool> asked = {}) {
    std::ofstream(path_ / "a.gltf") << two_materials(first, second);
    const Result<ViewScene> view = load_view(path_ / "a.gltf", {.textures_hold_light = asked}, {});
    EXPECT_TRUE(view.ok()) << view.status().message();
    return view->unlit;
  };
  EXPECT_EQ(unlit("", other), Unlit::none);
  EXPECT_EQ(unlit("", light), Unlit::some);
  EXPECT_EQ(unlit(light, light), Unlit::all);
  EXPECT_EQ(unlit(light, light, false), Unlit::none);
  EXPECT_EQ(unlit("", other, true), Unlit::all);
}

TEST_F(Play, KnowsWhichWorldsAreZUp) {
  World world;
  world.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  world.uvs = {{0, 0}, {1, 0}, {0, 1}};
  world.pages.push_back({"", "", {0, 1, 2}, {0, 1, 2}});
  for (const char* name : {"a.wrl", "a.wrz", "a.obj"})
    for (const Up up : {Up::y, Up::z}) {
      world.up = up;
      AtomicFiles files;
      ASSERT_TRUE(write_world(world, path_ / name, files, {}).ok());
      ASSERT_TRUE(files.commit().ok());
      EXPECT_EQ(world_is_z_up(path_ / name), up == Up::z && std::string(name) != "a.obj") << name;
    }
  EXPECT_FALSE(world_is_z_up(path_ / "absent.wrl"));
  EXPECT_FALSE(world_is_z_up(path_));
}

TEST_F(Bench, MeasuresEveryCombinationAndWritesItsFiles) {
  const View view = courtyard_view();
  BenchOptions o;
  o.render = small();
  o.render.schedule.interval_frames = 2;
  o.camera = view.camera;
  o.frames = 4;
  o.warm_up = 1;
  o.error_intervals = {2, 4};
  o.error_frames = 4;
  const Renderer first = must_render(view.scene, o.render);
  BenchResult r;
  r.device = test_context().info().renderer;
  r.software = test_context().info().software;
  const LightPath path = *LightPath::make({});
  std::atomic<bool> stop{true};
  Context stopped;
  stopped.cancel = &stop;
  EXPECT_EQ(bench_times(first, path, o, stopped).status().code(), ErrorCode::cancelled);
  EXPECT_EQ(bench_errors(first, path, o, stopped).status().code(), ErrorCode::cancelled);
  r.times = bench_times(first, path, o).value();
  r.errors = bench_errors(first, path, o).value();
  EXPECT_EQ(r.times.runs.size(), 3u * 7u);
  EXPECT_EQ(r.errors.size(), 2u * 5u);
  for (const BenchRun& run : r.times.runs) {
    EXPECT_EQ(run.frames.size(), 4u);
    EXPECT_LE(run.cpu.p50, run.cpu.worst);
    std::vector<double> gpu;
    for (const FrameTime& f : run.frames) gpu.push_back(f.gpu());
    EXPECT_GT(run.gpu.p50, 0.0);
    EXPECT_EQ(run.gpu.worst, *std::max_element(gpu.begin(), gpu.end()));
    // The classic method submits every caster in every frame, `none` never does.
    const std::uint32_t casters = run.frames[0].triangles_shadow;
    if (run.method == ShadowMethod::classic) {
      EXPECT_EQ(casters, view.scene.triangle_count());
    }
    if (run.method == ShadowMethod::none) {
      EXPECT_EQ(casters, 0u);
    }
  }
  // Each round of the control does as much arithmetic as fits into a frame of the warm-up.
  EXPECT_GT(r.times.control.rounds, 0u);
  EXPECT_GT(r.times.control.cpu.p50, 0.0);
  EXPECT_LE(r.times.control.cpu.p50, 1.1 * r.times.control.wall.worst);
  EXPECT_NE(bench_table(r).find("| control | fixed arithmetic |"), std::string::npos);
  ASSERT_TRUE(write_bench(r, path_ / "out").ok());
  std::ifstream json_file(path_ / "out" / "summary.json");
  const nlohmann::json j = nlohmann::json::parse(json_file);
  EXPECT_EQ(j["runs"].size(), 21u);
  EXPECT_EQ(j["errors"].size(), 10u);
  EXPECT_EQ(j["control"]["rounds"], r.times.control.rounds);
  EXPECT_GE(j["runs"][0]["wall_ms"]["p95_over_p50"], 1.0);
  std::ifstream csv(path_ / "out" / "frames.csv");
  int lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 1 + 21 * 4);
  const std::string cost = r.software ? "cpu" : "gpu";
  for (const std::string& name : {std::string("plots.gp"), std::string("fps-march.dat"),
                                  cost + "-lambert.dat", cost + "-ward.dat"})
    EXPECT_TRUE(fs::exists(path_ / "out" / name)) << name;
}

TEST_F(Bench, SumsUpTheFramesOfARun) {
  const View view = courtyard_view();
  BenchOptions o;
  o.render = small();
  o.render.schedule.interval_frames = 3;
  o.camera = view.camera;
  o.shadings = {Shading::lambert};
  o.methods = {ShadowMethod::classic, ShadowMethod::linear};
  o.frames = 8;
  o.error_intervals = {4};
  const Renderer first = must_render(view.scene, o.render);
  const LightPath path = *LightPath::make({});
  const BenchTimes times = *bench_times(first, path, o);
  ASSERT_EQ(times.runs.size(), 2u);
  for (const BenchRun& run : times.runs) {
    double shadow = 0, gpu = 0, work = 0, worst = 0;
    for (const FrameTime& f : run.frames) {
      shadow += f.gpu_shadow;
      gpu += f.gpu();
      work += f.triangles_shadow + f.triangles_lit;
      worst = std::max(worst, double(f.triangles_shadow + f.triangles_lit));
    }
    EXPECT_NEAR(run.shadow_share, shadow / gpu, 1e-6);
    EXPECT_NEAR(run.work_mean, work / double(run.frames.size()), 1e-6);
    EXPECT_EQ(run.work_worst, worst);
  }
  EXPECT_GT(times.runs[1].work_worst, times.runs[1].work_mean) << "maps are drawn now and then";
  // Light positions come in whole intervals.
  std::vector<BenchError> errors;
  for (const int frames : {1, 4, 5, 8}) {
    o.error_frames = frames;
    const std::vector<BenchError> measured = *bench_errors(first, path, o);
    ASSERT_EQ(measured.size(), 1u) << "classic is the truth itself";
    errors.push_back(measured[0]);
  }
  for (const auto& [some, whole] : {std::pair{0, 1}, {2, 3}}) {
    EXPECT_EQ(errors[some].visibility.mean, errors[whole].visibility.mean);
    EXPECT_EQ(errors[some].psnr, errors[whole].psnr);
    EXPECT_GT(errors[some].visibility.mean, 0);
  }
}

// The errors once more, frame by frame.
TEST_F(Bench, ErrorsAreMeansOverTheLightsPositions) {
  const View view = courtyard_view();
  BenchOptions o;
  o.render = small();
  o.render.shading = Shading::lambert;
  o.camera = view.camera;
  o.methods = {ShadowMethod::linear};
  o.error_intervals = {4};
  o.error_frames = 8;
  const Renderer first = must_render(view.scene, o.render);
  const LightPath path = *LightPath::make({});
  const BenchError measured = (*bench_errors(first, path, o))[0];
  o.render.schedule.interval_frames = 4;
  o.render.schedule.interval_degrees = 0;
  std::vector<Renderer> renderers;  // the truth's visibility and colours, then those of the method
  for (const ShadowMethod method : {ShadowMethod::classic, ShadowMethod::linear})
    for (const bool visibility : {true, false}) {
      o.render.shadows = method;
      o.render.show_visibility = visibility;
      renderers.push_back(must_render(view.scene, o.render));
    }
  double mean = 0, wrong = 0, squares = 0, similarity = 0;
  for (int f = 0; f < 8; ++f) {
    std::vector<Image8> pictures;
    for (Renderer& r : renderers) {
      const auto ahead = [&](int n) { return path.direction((f + n) * o.degrees_per_frame); };
      ASSERT_TRUE(r.draw(o.camera, {ahead(0), ahead}).ok());
      pictures.push_back(r.read_image());
    }
    const VisibilityError e = visibility_error(pictures[2], pictures[0]);
    mean += e.mean / 8;
    wrong += e.wrong / 8;
    for (std::size_t i = 0; i < pictures[1].texels.size(); ++i)
      squares += std::pow((pictures[3].texels[i] - pictures[1].texels[i]) / 255.0, 2);
    similarity += ssim(pictures[3], pictures[1]) / 8;
  }
  EXPECT_NEAR(measured.visibility.mean, mean, 1e-9);
  EXPECT_NEAR(measured.visibility.wrong, wrong, 1e-9);
  EXPECT_NEAR(measured.ssim, similarity, 1e-9);
  squares /= 8.0 * 48 * 32 * 3;
  EXPECT_NEAR(measured.psnr, -10 * std::log10(squares), 1e-6);
  EXPECT_GT(squares, 0);
}

}  // namespace
}  // namespace atlas::testing

// Runs the benchmark of every stage once on small work. They must give rows with figures; costs are
// not checked.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>

#include "benchmarks/light_leak/light_leak.h"
#include "benchmarks/rivals/rivals.h"
#include "benchmarks/support/callgrind.h"
#include "benchmarks/support/staged.h"
#include "libatlas/core/parallel.h"
#include "tests/support/temp_folder.h"

namespace atlas::bench {
namespace {

TEST(Work, MeetsItsSizeAndIsValid) {
  for (const char* kind : {"sphere", "scan", "rough", "torus", "terrain", "assembly", "fasteners",
                           "genus", "soup", "needles"}) {
    const Result<LoadedScene> made = make_work(std::string(kind) + ":20000", {});
    ASSERT_TRUE(made.ok()) << made.status().message();
    const Scene& scene = made->scene;
    EXPECT_NEAR(double(scene.triangle_count()), 20000, 6000) << kind;
    EXPECT_EQ(scene.illumination.size(), scene.positions.size());
    for (const std::uint32_t i : scene.indices) ASSERT_LT(i, scene.positions.size());
    for (const Vec3f& e : scene.illumination) ASSERT_TRUE(std::isfinite(e.x) && e.x >= 0) << kind;
  }
  for (const char* bad : {"sphere", "sphere:", "sphere:x", "sphere:3", "ball:1000", "sphere:1000 "})
    EXPECT_FALSE(make_work(bad, {}).ok()) << bad;
  const std::string complaint = make_work("ball:1000", {}).status().message();
  for (const char* kind : {"cabin", "file:", "needles"})
    EXPECT_NE(complaint.find(kind), std::string::npos) << complaint;
}

TEST(Stages, GiveFiguresOnSmallWork) {
  const Context context;
  Result<LoadedScene> scene = make_work("scan:1500", context);
  ASSERT_TRUE(scene.ok());
  Staged staged("scan:1500", std::move(*scene), context);
  staged.settings.pages = 1;
  staged.settings.page_size = 256;
  std::vector<Row> rows;
  const StageRun run{staged, 1, false, [&](Row row) { rows.push_back(std::move(row)); }};
  for (const auto& stage : {bench_baseline, bench_charts, bench_downsizing, bench_grouping,
                            bench_packing, bench_baking, bench_simplify, bench_export})
    stage(run);
  std::size_t exports = 0;
  for (const Row& row : rows) {
    EXPECT_TRUE(row.failure.empty()) << row.key() << ": " << row.failure;
    EXPECT_FALSE(line(row).empty());
    exports += row.stage.rfind("export", 0) == 0;
    if (row.stage.rfind("export/", 0) == 0) continue;
    ASSERT_FALSE(row.values.empty()) << row.key();
    for (const auto& [name, v] : row.values) EXPECT_TRUE(std::isfinite(v)) << row.key() << name;
    EXPECT_GT(row.memory_mib, 0) << row.key();
  }
  EXPECT_GE(exports, 5u);
  EXPECT_GE(rows.size(), 8u + 4u);
}

// Memory that one stage freed does not hide what the next one takes, nor does the earlier use of
// threads.
TEST(OwnProcess, HoldsItsInputAndWhatItTakesAlone) {
  std::atomic<std::size_t> chunks = 0;
  parallel_for({}, 1000, 1, [&](std::size_t, std::size_t) { ++chunks; });
  EXPECT_EQ(chunks, 1000u);
  std::vector<Row> rows;
  const TakeRow keep = [&](Row row) { rows.push_back(std::move(row)); };
  for (const std::size_t mib : {200, 50, 100})
    in_own_process({}, keep, [&](const TakeRow& take) {
      Row row;
      row.stage = std::to_string(mib);
      measure(2, row, [&]() -> Status {
        chunks = 0;
        parallel_for({}, 1000, 1, [&](std::size_t, std::size_t) { ++chunks; });
        const std::vector<char> block(mib << 20, 1);
        row.size_in = std::size_t(std::count(block.begin(), block.end(), 1));
        row.size_out = chunks;
        return {};
      });
      take(row);
    });
  ASSERT_EQ(rows.size(), 3u);
  for (const Row& row : rows) {
    EXPECT_EQ(row.size_in, std::stoul(row.stage) << 20);
    EXPECT_EQ(row.size_out, 1000u);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which keep freed memory
    EXPECT_NEAR(row.memory_mib - row.input_mib, std::stod(row.stage), 20);
#endif
  }
}

TEST(OwnProcess, ThatDiesIsReported) {
  std::vector<Row> rows;
  Row otherwise;
  otherwise.stage = "doomed";
  in_own_process(
      otherwise, [&](Row row) { rows.push_back(std::move(row)); },
      [](const TakeRow& take) {
        Row row;
        row.stage = "first";
        take(row);
        ::_exit(3);
      });
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].stage, "first");
  EXPECT_EQ(rows[1].stage, "doomed");
  EXPECT_NE(rows[1].failure.find("code 3"), std::string::npos) << rows[1].failure;
}

TEST(Rivals, AreJudgedTimedOutAndReported) {
  const Context context;
  Staged staged("sphere:500", lit(test::icosphere(2)), context);
  std::vector<Row> rows;
  const StageRun run{staged, 1, false, [&](Row row) { rows.push_back(std::move(row)); }};
  bench_ours(run, 256);
  for (const char* text : {"copies=cp {in} {out}", "slow=sleep 20; cp {in} {out}",
                           "broken=false {in} {out}", "crashing=kill -SEGV $$; : {in} {out}",
                           "killed=kill -KILL $$; : {in} {out}", "own=exit 124; : {in} {out}"}) {
    Result<Rival> rival = parse_rival(text);
    ASSERT_TRUE(rival.ok());
    rival->timeout = rival->name == "slow" ? 0.3 : 60;
    rival->page = 256;
    bench_rival(run, *rival);
  }
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_TRUE(rows[0].failure.empty()) << rows[0].failure;
  EXPECT_EQ(rows[0].value("overlap"), 0);
  EXPECT_EQ(rows[0].value("without_uv"), 0);
  EXPECT_LT(rows[0].value("l2_minus_1"), 0.05);
  EXPECT_EQ(rows[1].failure, "wrote no uvs");
  EXPECT_NE(rows[2].failure.find("timed out"), std::string::npos) << rows[2].failure;
  EXPECT_NE(rows[3].failure.find("code 1"), std::string::npos) << rows[3].failure;
  EXPECT_NE(rows[4].failure.find("signal 11"), std::string::npos) << rows[4].failure;
  EXPECT_NE(rows[5].failure.find("signal 9"), std::string::npos) << rows[5].failure;
  EXPECT_NE(rows[6].failure.find("code 124"), std::string::npos) << rows[6].failure;
  EXPECT_FALSE(parse_rival("no command").ok());
  EXPECT_FALSE(parse_rival("x=unwrap {in}").ok());
}

// A rectangle twice as wide as high that fills its page. It is isometric on a page of these
// proportions.
TEST(Rivals, PagesNeedNotBeSquare) {
  const Context context;
  Staged staged("sphere:500", lit(test::icosphere(2)), context);
  const std::string faces =
      "v 0 0 0\\nv 2 0 0\\nv 2 1 0\\nv 0 1 0\\nvt 0 0\\nvt 1 0\\nvt 1 1\\nvt 0 1\\n"
      "f 1/1 2/2 3/3\\nf 1/1 3/3 4/4\\n";
  for (const bool told : {true, false}) {
    std::vector<Row> rows;
    const StageRun run{staged, 1, false, [&](Row row) { rows.push_back(std::move(row)); }};
    const std::string text = (told ? "# page 128 64\\n" : "") + faces;
    const Result<Rival> rival = parse_rival("x=: {in}; printf '" + text + "' > {out}");
    ASSERT_TRUE(rival.ok());
    bench_rival(run, *rival);
    ASSERT_TRUE(rows.at(0).failure.empty()) << rows[0].failure;
    // On a square page the singular values are 1/sqrt(2) and sqrt(2).
    EXPECT_NEAR(rows[0].value("l2_minus_1"), told ? 0 : std::sqrt(1.25) - 1, 1e-6);
  }
}

TEST(Threads, EveryNumberGivesTheSameFigures) {
  std::vector<Row> rows;
  for (const int threads : {1, 2}) {
    Context context;
    context.threads = threads;
    Result<LoadedScene> scene = make_work("scan:1500", context);
    ASSERT_TRUE(scene.ok());
    Staged staged("scan:1500", std::move(*scene), context);
    staged.threads = threads;
    bench_charts({staged, 1, false, [&](Row row) { rows.push_back(std::move(row)); }});
  }
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].threads, 2);
  for (const char* figure : {"seam", "l2", "p999"})
    EXPECT_EQ(rows[0].value(figure), rows[1].value(figure)) << figure;
}

TEST(Instructions, AreCountedUnderCallgrind) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "valgrind does not run programs with sanitizers";
#endif
  if (std::system("valgrind --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "valgrind is not installed";
  const Result<Results> counted =
      count_instructions({ATLAS_BENCH_PROGRAM, "--work", "sphere:400", "--standard", "--threads",
                          "1", "--stages", "baseline", "charts"});
  ASSERT_TRUE(counted.ok()) << counted.status().message();
  ASSERT_EQ(counted->rows.size(), 2u);
  for (const Row& row : counted->rows) {
    EXPECT_GT(row.instructions, 400 * 100) << row.key();
    EXPECT_LT(row.instructions, 1e10) << row.key();
    EXPECT_EQ(row.cpu_seconds, 0);
  }
  EXPECT_FALSE(count_instructions({"/nonexistent/program"}).ok());
}

TEST(CommandLine, NonsenseIsRefusedBeforeAnythingRuns) {
  for (const char* words : {"--timeout -1", "--atlases 0", "--atlas-size 3", "--texel nan",
                            "--texel -1", "--fit-from -1", "--fit-from x", "--stages chart",
                            "--repeats 0", "--unknown", "--instructions --threads 2"}) {
    const std::string command = std::string(ATLAS_BENCH_PROGRAM) +
                                " --work sphere:400 --stages baseline " + words +
                                " >/dev/null 2>&1";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2) << words;
  }
}

// Stages that need light are left out of an unlit mesh, unless they are asked for by name.
TEST(CommandLine, AnUnlitMeshIsNoFailure) {
  const test::Shape shape = test::icosphere(1);
  Scene scene;
  scene.positions = shape.positions;
  scene.indices = shape.indices;
  const test::TempFolder folder;
  const auto path = folder / "unlit.obj";
  ASSERT_TRUE(write_plain_obj(scene, path, false).ok());
  const auto code = [&](const std::string& words) {
    const std::string command = std::string(ATLAS_BENCH_PROGRAM) +
                                " --standard --work file:" + path.string() + words +
                                " >/dev/null 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  EXPECT_EQ(code(""), 0);
  EXPECT_EQ(code(" --stages baking"), 1);
}

// A plane with a straight shadow edge at x = 1/2, which is one mesh cell wide.
Staged half_lit(const Context& context) {
  LoadedScene loaded = lit(test::grid(80, 80));
  for (std::size_t i = 0; i < loaded.scene.positions.size(); ++i) {
    const float e = loaded.scene.positions[i].x > 0.5f ? 100.0f : 10.0f;
    loaded.scene.illumination[i] = {e, e, e};
  }
  loaded.scene.object_names[0] = "door";
  return Staged("plane", std::move(loaded), context);
}

TEST(LightLeak, FindsTheEdgeOfAShadow) {
  const Context context;
  const Staged staged = half_lit(context);
  const ShadowEdge edge = find_shadow_edge(staged.scene(), {});
  EXPECT_EQ(edge.triangles.size(), 12800u);
  ASSERT_FALSE(edge.points.empty());
  for (const Vec3f& p : edge.points) EXPECT_NEAR(p.x, 0.50625, 1e-5);
  EXPECT_NEAR(edge.length, 1, 1e-3);
  ShadowEdgeOptions strict;
  strict.length = 0.005;  // shorter than the edges of the mesh
  EXPECT_TRUE(find_shadow_edge(staged.scene(), strict).points.empty());
  strict = {};
  strict.drop = 0.95;
  EXPECT_TRUE(find_shadow_edge(staged.scene(), strict).points.empty());
  Scene dark = staged.scene();  // an edge far below the mean light
  for (std::size_t i = 0; i < dark.positions.size(); ++i)
    if (dark.positions[i].x < 0.25f) dark.illumination[i] = {1, 1, 1};
  EXPECT_EQ(find_shadow_edge(dark, {}).length, edge.length);
  const NearPoints near(edge.points, 0.1);
  EXPECT_NEAR(near.distance({0.55, 0.5, 0}), 0.04375, 1e-3);
  EXPECT_TRUE(std::isinf(near.distance({0.7, 0.5, 0})));
}

TEST(LightLeak, FallsWithTheTexel) {
  const Context context;
  Staged staged = half_lit(context);
  staged.settings.pages = 1;
  staged.settings.page_size = 512;
  LeakOptions options;
  options.sampling = 0.3;
  std::vector<Leak> leaks;
  for (const double texel : {0.04, 0.01, 0.004}) {
    options.texel = texel;
    const Result<Leak> leak = measure_leak(staged, options);
    ASSERT_TRUE(leak.ok()) << leak.status().message();
    EXPECT_GT(leak->band.points, 100u);
    EXPECT_LE(leak->band.p95, leak->band.maximum);
    leaks.push_back(*leak);
  }
  EXPECT_GT(leaks[0].fixed.rms, 2 * leaks[2].fixed.rms);
  EXPECT_LT(leaks[2].texel, 0.5 * leaks[0].texel);
  EXPECT_LT(leaks[2].whole.p50, 0.01);
  options.picture = 0.4;
  options.pixels = 64;
  const Result<Leak> drawn = measure_leak(staged, options);
  ASSERT_TRUE(drawn.ok());
  const Image8 &input = drawn->picture.input, &baked = drawn->picture.baked;
  ASSERT_EQ(input.width, 64);
  const auto level = [](const Image8& image, int column) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y) sum += image.at(column, y)[1];
    return sum / image.height;
  };
  EXPECT_GT(std::abs(level(input, 4) - level(input, 60)), 50)
      << "the edge runs through the picture";
  for (const int x : {4, 60}) EXPECT_NEAR(level(input, x), level(baked, x), 6);
  EXPECT_EQ(side_by_side({input, baked}).width, 2 * 64 + 8);
  options.edge.object = "window";
  EXPECT_EQ(measure_leak(staged, options).status().code(), ErrorCode::bad_input);
}

}  // namespace
}  // namespace atlas::bench

// atlas-bench-shadows: error against time of the interpolated shadow maps, as rows of stage
// "shadows".
#include <fmt/format.h>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "apps/common/options.h"
#include "benchmarks/shadows/shadow_rows.h"
#include "benchmarks/support/work.h"

int main(int argc, char** argv) {
  using namespace atlas;
  using namespace atlas::bench;
  CLI::App app("Measures the shadow methods of the player on the software renderer.",
               "atlas-bench-shadows");
  ShadowRunOptions options;
  std::string work = "cabin:100000", out;
  bool small = false, gpu = false;
  app.add_option("--work,-w", work, "scene, z up: cabin:TRIANGLES or file:PATH")
      ->capture_default_str();
  app.add_option("--intervals,-k", options.intervals, "frames between key maps")
      ->check(CLI::Range(1, 1'000'000));
  app.add_option("--frames", options.frames, "light positions")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_flag("--gpu", gpu, "on a GPU, if there is one");
  app.add_flag("--small", small, "a scene of 20 000 triangles and two intervals");
  app.add_option("--out,-o", out, "JSON file to write");
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  if (small) {
    work = "cabin:20000";
    options.intervals = {4, 8};
    options.frames = 4;
  }
  // The view of docs/player.md: seats in the sun, over which shadows move.
  if (work.starts_with("cabin:")) options.look = {{4.6, -0.5, 1.75}, {2.6, 0.9, 0.5}};
  options.software = !gpu;
  const auto fail = [](const Status& status) {
    fmt::print(stderr, "atlas-bench-shadows: {}\n", status.message());
    return 1;
  };
  if (const Status s = check_target(out); !s.ok()) return fail(s);
  const Result<LoadedScene> scene = make_work(work, {});
  if (!scene.ok()) return fail(scene.status());
  Result<std::vector<Row>> rows = measure_shadows(scene->scene, work, options);
  if (!rows.ok()) return fail(rows.status());
  Results results;
  results.machine = describe_machine(argc, argv);
  results.rows = std::move(*rows);
  for (const Row& row : results.rows) fmt::print("{}\n", line(row));
  if (out.empty()) return 0;
  const Status s = save(results, out);
  return s.ok() ? 0 : fail(s);
}

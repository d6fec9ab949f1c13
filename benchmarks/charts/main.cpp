// atlas-bench-charts: the tables and the plot of docs/charts-measured.md.
//   atlas-bench-charts --table --mesh figure:30000 hound:20000
//   atlas-bench-charts --sweep docs/images/charts-error --mesh figure:30000
//   atlas-bench-charts --picture docs/images/charts.png --mesh figure:30000
//   atlas-bench-charts --robust --mesh models/*.obj
//   atlas-bench-charts --cases 16 --mesh models/*.obj
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "apps/common/options.h"
#include "benchmarks/charts/charts_bench.h"
#include "benchmarks/shapes/figures.h"
#include "benchmarks/support/work.h"

namespace {

using namespace atlas;
using namespace atlas::bench;

struct Arguments {
  std::vector<std::string> meshes{"figure:30000", "hound:20000",  "figure-scan:40000",
                                  "shaft:20000",  "bracket:8000", "terraces:30000"};
  bool table = false, robust = false;
  std::string sweep, picture;
  int repeats = 3, turns = 6, cases = 0;
};

std::string label(const std::string& mesh) {
  return mesh.find(':') == std::string::npos ? std::filesystem::path(mesh).stem().string() : mesh;
}

Status run(const Arguments& a) {
  Context context;
  context.threads = 1;
  std::vector<ChartsPoint> points;
  std::vector<LoadedScene> drawn;
  if (a.table) fmt::print("{}\n", charts_table_head());
  if (a.robust) fmt::print("{}\n", charts_robust_head());
  if (a.cases > 0) fmt::print("{}\n", charts_cases_head());
  for (const std::string& mesh : a.meshes) {
    Result<LoadedScene> scene = charts_work(mesh, context);
    if (!scene.ok()) return scene.status();
    if (!a.picture.empty()) {
      drawn.push_back(std::move(*scene));
      continue;
    }
    if (a.sweep.empty()) {
      const Result<std::string> row = a.table ? charts_table_row(label(mesh), *scene, context)
                                      : a.robust
                                          ? charts_robust_row(label(mesh), *scene, a.turns, context)
                                          : charts_cases_row(label(mesh), *scene, a.cases, context);
      if (!row.ok()) return row.status();
      fmt::print("{}\n", *row);
      std::fflush(stdout);
      continue;
    }
    const auto swept = charts_sweep(label(mesh), *scene, a.repeats, context);
    if (!swept.ok()) return swept.status();
    for (const ChartsPoint& p : *swept) fmt::print("{}\n", line(p));
    points.insert(points.end(), swept->begin(), swept->end());
  }
  if (!drawn.empty()) return draw_charts(drawn, a.picture, context);
  return points.empty() ? Status() : draw_sweep(points, a.sweep);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Charts and parameterisation: figures, error against time, robustness.",
               "atlas-bench-charts");
  Arguments a;
  app.add_option("--mesh,-m", a.meshes,
                 fmt::format("NAME:TRIANGLES ({}, {}) or a file", kFigures, kShapeKinds));
  auto* kind = app.add_option_group("what");
  kind->add_flag("--table", a.table, "a line of figures a mesh");
  kind->add_option("--sweep", a.sweep,
                   "presets and bounds; draws FILE-stretch.svg and FILE-seams.svg");
  kind->add_option("--picture", a.picture, "PNG of the meshes' charts side by side");
  kind->add_flag("--robust", a.robust, "what units, directions, places and threads change");
  kind->add_option("--cases", a.cases,
                   "how often so many random rotations, units and offsets keep the charts")
      ->check(CLI::Range(1, 10000));
  kind->require_option(1);
  app.add_option("--repeats", a.repeats, "of --sweep: the least CPU time counts")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--turns", a.turns, "of --robust: random rotations")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  const Status status = run(a);
  if (status.ok()) return 0;
  fmt::print(stderr, "atlas-bench-charts: {}\n", status.message());
  return 1;
}

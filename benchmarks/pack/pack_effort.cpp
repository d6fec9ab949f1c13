// What packing costs and gains: makes the charts of meshes, lays them out as unwrap_mesh does, and
// prints CPU seconds of both and the share of the page that is used, a line a mesh and a mean.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/options.h"
#include "benchmarks/pack/command_line.h"
#include "benchmarks/shapes/families.h"
#include "benchmarks/support/work.h"
#include "libatlas/core/clock.h"
#include "libatlas/unwrap/place_charts.h"

namespace {

using namespace atlas;

struct Row {
  std::string name;
  std::size_t charts = 0, pieces = 0;
  double chart_seconds = 0, page_seconds = 0, used = 0;
};

// FAMILY:NUMBER, KIND:TRIANGLES, or a file.
Result<LoadedScene> load(const std::string& name, const Context& context) {
  const auto colon = name.find(':');
  const auto families = bench::families();
  if (colon == std::string::npos ||
      std::find(families.begin(), families.end(), name.substr(0, colon)) == families.end())
    return bench::make_work((std::filesystem::exists(name) ? "file:" : "") + name, context);
  std::uint32_t number = 0;
  std::from_chars(name.data() + colon + 1, name.data() + name.size(), number);
  Result<test::Shape> shape = bench::make_member(name.substr(0, colon), number);
  if (!shape.ok()) return shape.status();
  return bench::lit(std::move(*shape));
}

Result<Row> measure(const std::string& name, const UnwrapOptions& options, const Context& context) {
  const Result<LoadedScene> loaded = load(name, context);
  if (!loaded.ok()) return loaded.status();
  MeshView mesh;
  mesh.positions = loaded->scene.positions;
  mesh.indices = loaded->scene.indices;
  Stopwatch watch(cpu_seconds);
  Result<ChartSet> charts = make_charts(mesh, options.charts, context);
  if (!charts.ok()) return charts.status();
  Row row{std::filesystem::path(name).stem().string(), charts->charts.size()};
  row.chart_seconds = watch.lap();
  const Result<UnwrappedMesh> placed = place_charts(mesh, std::move(*charts), options, context);
  if (!placed.ok()) return placed.status();
  row.page_seconds = watch.lap();
  row.pieces = placed->charts.charts.size();
  row.used = placed->utilization;
  return row;
}

void print(const Row& r) {
  fmt::print(
      "{:<20} charts {:>5} pieces {:>5}  charts {:>7.3f} s  packing {:>7.3f} s  used {:.4f}\n",
      r.name, r.charts, r.pieces, r.chart_seconds, r.page_seconds, r.used);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  UnwrapOptions options;
  std::vector<std::string> names;
  std::uint32_t members = 0;
  CLI::App app("What packing costs, and how full pages become.", "atlas-bench-pack-effort");
  app.add_option("mesh", names,
                 fmt::format("files, FAMILY:NUMBER or KIND:TRIANGLES ({})", bench::kShapeKinds));
  app.add_option("--members", members, "so many members of each family");
  app.add_flag("--square", options.square, "square pages");
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  for (const std::string_view family : bench::families())
    for (std::uint32_t k = 0; k < members; ++k) names.push_back(fmt::format("{}:{}", family, k));
  Context context;
  context.threads = 1;
  Row mean{"mean"}, worst{"worst"};
  worst.used = 1;
  for (const std::string& name : names) {
    const Result<Row> row = measure(name, options, context);
    if (!row.ok()) {
      fmt::print(stderr, "atlas-bench-pack-effort: {}: {}\n", name, row.status().message());
      continue;
    }
    print(*row);
    const double share = 1 / double(names.size());
    mean.chart_seconds += share * row->chart_seconds;
    mean.page_seconds += share * row->page_seconds;
    mean.used += share * row->used;
    worst.chart_seconds = std::max(worst.chart_seconds, row->chart_seconds);
    worst.page_seconds = std::max(worst.page_seconds, row->page_seconds);
    worst.used = std::min(worst.used, row->used);
  }
  print(mean);
  print(worst);
  return 0;
}

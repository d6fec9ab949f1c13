// atlas-bench-leak: the door's light leak against the texel size, as rows of stage "light_leak".
#include <fmt/format.h>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "apps/common/options.h"
#include "benchmarks/light_leak/light_leak.h"
#include "libatlas/image/image_io.h"

namespace {

using namespace atlas;
using namespace atlas::bench;

struct Arguments {
  std::string work = "cabin:300000", out, picture;
  std::vector<double> texels{20, 10, 5, 2.5};
  LeakOptions leak;
  std::uint32_t pages = 50;
  std::int32_t page = 2048;
  bool average = false;
  double patch = 0.16;
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option("--work,-w", a.work, "scene with the object: cabin:TRIANGLES or file:PATH")
      ->capture_default_str();
  app.add_option("--texel,-t", a.texels, "millimetres on the surface, one or more")
      ->check(app::positive());
  app.add_option("--object", a.leak.edge.object, "whose shadow edge")->capture_default_str();
  app.add_option("--drop", a.leak.edge.drop, "of the larger value along a mesh edge")
      ->check(app::within(0, 1, "0..1"))
      ->capture_default_str();
  app.add_option("--edge-length", a.leak.edge.length, "longest mesh edge that counts, metres")
      ->check(app::positive())
      ->capture_default_str();
  app.add_option("--band", a.leak.band_texels, "points within this many texels of the edge")
      ->check(app::positive())
      ->capture_default_str();
  app.add_option("--threshold", a.leak.threshold, "of downsizing")
      ->check(app::within(0, 1, "0..1"))
      ->capture_default_str();
  app.add_option("--atlases", a.pages, "pages at most")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--atlas-size", a.page, "their largest side, texels, a power of two")
      ->check(app::within(64, 16384))
      ->capture_default_str();
  app.add_flag("--average", a.average, "bake as published, without least squares");
  app.add_option("--picture", a.picture, "PNG of a patch: the input, then each texel");
  app.add_option("--patch", a.patch, "side of that patch, metres")
      ->check(app::positive())
      ->capture_default_str();
  app.add_option("--out,-o", a.out, "JSON file to write");
}

Row row_of(const Staged& staged, double millimetres, const Leak& leak) {
  Row row = staged.row("light_leak", fmt::format("texel {} mm", millimetres));
  row.size_out = leak.band.points;
  row.unit = "triangles -> points";
  row.values = {
      {"p95", leak.band.p95},        {"p50", leak.band.p50},         {"p99", leak.band.p99},
      {"max", leak.band.maximum},    {"rms", leak.band.rms},         {"fixed_p95", leak.fixed.p95},
      {"fixed_rms", leak.fixed.rms}, {"object_p95", leak.whole.p95}, {"texel_mm", 1e3 * leak.texel},
      {"asked_mm", millimetres},     {"scale", leak.scale},          {"pages", double(leak.pages)},
      {"edge_m", leak.edge_length}};
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures light leaking across the door's shadow edge (the paper's figures 1 to 3).",
               "atlas-bench-leak");
  Arguments a;
  describe(app, a);
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  const auto fail = [](const Status& status) {
    fmt::print(stderr, "atlas-bench-leak: {}\n", status.message());
    return 1;
  };
  for (const std::string& target : {a.out, a.picture})
    if (const Status s = check_target(target); !s.ok()) return fail(s);
  if (a.average) a.leak.method = BakeMethod::average;
  if (!a.picture.empty()) a.leak.picture = a.patch;
  std::vector<Image8> tiles;
  const Context context;
  Result<LoadedScene> scene = make_work(a.work, context);
  if (!scene.ok()) return fail(scene.status());
  Staged staged(a.work, std::move(*scene), context);
  staged.settings.pages = a.pages;
  staged.settings.page_size = a.page;
  // Not part of the first texel size's cost.
  if (const Status s = staged.need_charts(); !s.ok()) return fail(s);
  Results results;
  results.machine = describe_machine(argc, argv);
  for (const double millimetres : a.texels) {
    a.leak.texel = millimetres / 1000;
    Row row;
    Leak leak;
    measure(1, row, [&]() -> Status {
      Result<Leak> made = measure_leak(staged, a.leak);
      if (made.ok()) leak = *made;
      return made.status();
    });
    if (!row.failure.empty()) return fail({ErrorCode::bad_input, row.failure});
    Row full = row_of(staged, millimetres, leak);
    full.cpu_seconds = row.cpu_seconds;
    full.wall_seconds = row.wall_seconds;
    full.memory_mib = row.memory_mib;
    full.input_mib = row.input_mib;
    fmt::print("{}\n", line(full));
    results.rows.push_back(std::move(full));
    if (a.picture.empty()) continue;
    if (tiles.empty()) tiles.push_back(std::move(leak.picture.input));
    tiles.push_back(std::move(leak.picture.baked));
  }
  if (!a.picture.empty())
    if (const Status s = write_png(a.picture, side_by_side(tiles), {}); !s.ok()) return fail(s);
  if (a.out.empty()) return 0;
  if (const Status s = save(results, a.out); !s.ok()) return fail(s);
  return 0;
}

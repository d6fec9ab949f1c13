// atlas-bench-first-look: the table and the pictures of docs/texture.md, of scenes whose white is
// the 99th percentile of what is visible ("before"), and of those whose white is measured.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/options.h"
#include "apps/common/program.h"
#include "apps/common/terminal.h"
#include "benchmarks/tone/first_look.h"
#include "benchmarks/tone/light_scenes.h"
#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/support/shared_data.h"

namespace {

using namespace atlas;

struct Arguments {
  std::string folder, picture;
};

// One scene, exported with both rules.
struct Row {
  std::string name;
  double white[2];
  bench::FirstLook look[2];
};

Result<ExportReport> export_scene(const bench::LightScene& scene, double white,
                                  const std::filesystem::path& world, const Context& context) {
  ReadOptions reading;
  reading.srgb_colours = scene.quantity == Quantity::colour;
  const Result<LoadedScene> loaded = read_scene(scene.file, reading, context);
  if (!loaded.ok()) return loaded.status();
  ExportOptions options;
  options.target = world;
  options.quantity = scene.quantity;
  options.tone.white = white;
  options.up = Up::z;
  options.atlases = 1;
  options.simplify = options.measure_error = false;
  return export_world(*loaded, options, {}, context);
}

Result<Row> compare(const bench::LightScene& scene, const std::filesystem::path& world,
                    const Context& context) {
  Row row{scene.name, {}, {}};
  double before = 0;
  for (const int rule : {1, 0}) {
    const Result<ExportReport> report = export_scene(scene, rule == 1 ? 0 : before, world, context);
    if (!report.ok()) return report.status();
    before = scene.quantity == Quantity::colour ? 0 : report->luminance.percentile99;
    row.white[rule] = report->exposure_white;
    Result<bench::FirstLook> look = bench::look_at(world, scene, context);
    if (!look.ok()) return look.status();
    row.look[rule] = std::move(*look);
  }
  return row;
}

// Pairs of pictures, before and after, two pairs side by side.
Image8 contact_sheet(const std::vector<Row>& rows) {
  constexpr int kGap = 4, kPairs = 2;
  const int w = bench::kLookWidth, h = bench::kLookHeight;
  const int lines = (int(rows.size()) + kPairs - 1) / kPairs;
  Image8 sheet(kPairs * 2 * (w + kGap) + kGap, lines * (h + kGap) - kGap, 3, 255);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const int rule : {0, 1}) {
      const Image8& picture = rows[i].look[rule].picture;
      const int column = 2 * (int(i) % kPairs) + rule;
      const int x = column * w + (column + column / 2) * kGap - (rule ? kGap : 0);
      const int y = (lines - 1 - int(i) / kPairs) * (h + kGap);
      for (int r = 0; r < h; ++r)
        std::copy_n(picture.at(0, r), 3 * std::size_t(w), sheet.at(x, y + r));
    }
  return sheet;
}

Status run(const Arguments& a, app::Terminal& terminal) {
  Context context = terminal.context(0);
  context.warn = {};  // advice on each export is of no interest here
  std::error_code error;
  std::filesystem::create_directories(a.folder, error);
  Result<std::vector<bench::LightScene>> scenes = bench::make_light_scenes(a.folder, context);
  if (!scenes.ok()) return scenes.status();
  if (const auto room = test::shared_data("room"))
    scenes->push_back({.name = "path-traced room", .file = *room / "scene.obj"});
  else
    terminal.line("The path-traced room is left out: " + test::lacks("room"));
  std::vector<Row> rows;
  terminal.line("| scene | lit | white before | median | burnt | white | median | burnt |");
  terminal.line("|---|---|---|---|---|---|---|---|");
  for (const bench::LightScene& scene : *scenes) {
    Result<Row> row = compare(scene, a.folder + "/world.glb", context);
    if (!row.ok()) return row.status();
    const auto& [before, after] = row->look;
    terminal.line(
        fmt::format("| {} | {:.0f} % | {:.3g} | {:.0f} | {:.1f} % | {:.3g} | {:.0f} | {:.1f} % |",
                    row->name, 100 * after.lit, row->white[0], before.median, 100 * before.burnt,
                    row->white[1], after.median, 100 * after.burnt));
    rows.push_back(std::move(*row));
  }
  if (a.picture.empty()) return {};
  return write_png(a.picture, contact_sheet(rows), {9});
}

int main_of(int argc, char** argv) {
  CLI::App app("Shows scenes as viewers first see them, before and after the rule for white.",
               "atlas-bench-first-look");
  Arguments arguments;
  app.add_option("folder", arguments.folder, "where to write the scenes")->required();
  app.add_option("picture", arguments.picture, "a picture of all of them, .png");
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  app::Terminal terminal("atlas-bench-first-look", false);
  const Status status = run(arguments, terminal);
  if (!status.ok()) terminal.error(status.message());
  return app::exit_code(status);
}

}  // namespace

int main(int argc, char** argv) {
  return app::run_program("atlas-bench-first-look", argc, argv, main_of);
}

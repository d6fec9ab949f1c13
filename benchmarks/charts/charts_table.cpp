#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "benchmarks/charts/charts_bench.h"
#include "benchmarks/charts/charts_picture.h"
#include "benchmarks/shapes/figures.h"
#include "benchmarks/support/work.h"
#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/support/atlas_measure.h"

namespace atlas::bench {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("atlas_charts_{}", ::getpid());
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

// Names the counts that must be zero but are not.
std::string faults(const test::AtlasMeasures& m, std::size_t triangles) {
  std::string text;
  const std::pair<const char*, std::uint64_t> counts[] = {
      {"flipped", m.flipped},
      {"mirrored", m.mirrored},
      {"degenerate", m.degenerate},
      {"outside", m.outside},
      {"overlap", m.overlap},
      {"bleed", m.bleed},
      {"without uv", triangles - std::min<std::uint64_t>(triangles, m.triangles)}};
  for (const auto& [name, count] : counts)
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text.empty() ? "none" : text;
}

}  // namespace

Result<LoadedScene> charts_work(const std::string& name, const Context& context) {
  if (name.find(':') == std::string::npos) return read_scene(name, {}, context);
  Result<test::Shape> shape = make_figure(name);
  if (!shape.ok()) return shape.status();
  return lit(std::move(*shape));
}

std::string charts_table_head() {
  return "| mesh | triangles | charts | L2 | 99.9 % | seam | CPU s | used | faults |\n"
         "|---|---|---|---|---|---|---|---|---|";
}

Result<std::string> charts_table_row(const std::string& name, const LoadedScene& loaded,
                                     const Context& context) {
  const Folder folder;
  ExportOptions options;
  options.target = folder.path / "out.obj";
  options.charts_only = true;
  const Result<ExportReport> report = export_world(loaded, options, {}, context);
  if (!report.ok()) return report.status();
  double cpu = 0;
  for (const StageReport& stage : report->stages)
    if (stage.stage == "charts") cpu += stage.cpu_seconds;
  const Result<test::UvMesh> mesh = test::read_uv_obj(options.target);
  if (!mesh.ok()) return mesh.status();
  const auto& page = report->pages.front();
  const test::AtlasMeasures m = test::measure_atlas(*mesh, page.width, page.height);
  return fmt::format("| {} | {} | {} | {:.4f} | {:.3f} | {:.2f} | {:.3f} | {:.3f} | {} |", name,
                     loaded.scene.triangle_count(), m.charts, m.stretch_l2, m.stretch_999, m.seam,
                     cpu, m.utilization, faults(m, loaded.scene.triangle_count()));
}

Status draw_charts(const std::vector<LoadedScene>& meshes, const std::filesystem::path& png,
                   const Context& context) {
  const Folder folder;
  std::vector<UnwrappedMesh> unwrapped;
  for (const LoadedScene& loaded : meshes) {
    ExportOptions options;
    options.target = folder.path / "out.obj";
    options.charts_only = true;
    options.square_plain_page = true;  // narrow pages would be small in the picture
    const Result<ExportReport> report = export_world(loaded, options, {}, context);
    if (!report.ok()) return report.status();
    Result<test::UvMesh> mesh = test::read_uv_obj(options.target);
    if (!mesh.ok()) return mesh.status();
    const auto& page = report->pages.front();
    unwrapped.push_back({std::move(*mesh), double(page.width) / page.height});
  }
  return write_png(png, charts_picture(unwrapped, 420), {9});
}

}  // namespace atlas::bench

// Measures the whole export with files written to a temporary folder. Its stages become separate
// rows named "export/STAGE", so that the page shows how the time is distributed.
#include <fmt/format.h>

#include <unistd.h>

#include <filesystem>

#include "benchmarks/support/staged.h"
#include "libatlas/pipeline/export_world.h"

namespace atlas::bench {
namespace {

namespace fs = std::filesystem;

struct Setting {
  std::string name;
  bool preset;
  ExportOptions options;
};

std::vector<Setting> settings(const StageRun& run) {
  ExportOptions base;
  base.atlases = run.staged.settings.pages;
  base.atlas_size = run.staged.settings.page_size;
  std::vector<Setting> list{{"standard", true, base}};
  if (!run.sweep) return list;
  for (const double millimetres : {2.5, 5.0, 10.0, 20.0}) {
    ExportOptions options = base;
    options.texel_metres = millimetres / 1000;
    list.push_back({fmt::format("texel {} mm", millimetres), false, options});
  }
  ExportOptions options = base;
  options.charts.preset = ChartPreset::fast;
  options.packing = PackPreset::fast;
  options.bake_method = BakeMethod::average;
  options.shifts = 1;  // with more shifts, averaging takes longer than the default
  list.push_back({"fast", true, options});
  return list;
}

void stage_rows(const Staged& staged, const Setting& setting, const ExportReport& report,
                const TakeRow& take) {
  for (const StageReport& stage : report.stages) {
    Row row = staged.row("export/" + stage.stage, setting.name, setting.preset);
    row.size_in = stage.size_in;
    row.size_out = stage.size_out;
    row.unit = stage.unit;
    row.cpu_seconds = stage.cpu_seconds;
    row.wall_seconds = stage.wall_seconds;
    row.memory_mib = double(stage.peak_memory) / (1 << 20);
    take(row);
  }
}

// Measures the row and, for standard settings, those of its stages.
void measure_export(const StageRun& run, const Setting& setting, Row row, const TakeRow& take) {
  ExportReport report;
  measure(run.repeats, row, [&]() -> Status {
    Result<ExportReport> made =
        export_world(run.staged.loaded, setting.options, {}, run.staged.context);
    if (!made.ok()) return made.status();
    report = std::move(*made);
    row.size_out = report.triangles_out;
    row.values = {{"rms", report.fidelity.rmse_display},  {"psnr", report.fidelity.psnr},
                  {"p95", report.fidelity.p95},           {"scale", report.scale},
                  {"pages", double(report.pages.size())}, {"charts", double(report.charts.size())}};
    return {};
  });
  take(row);
  if (row.failure.empty() && setting.name == "standard")
    stage_rows(run.staged, setting, report, take);
}

}  // namespace

void bench_export(const StageRun& run) {
  Staged& staged = run.staged;
  if (!staged.scene().lit())
    return report_failure(run, "export", {ErrorCode::bad_input, staged.name + ": has no light"});
  const fs::path folder = fs::temp_directory_path() / fmt::format("atlas_bench_{}", ::getpid());
  for (Setting& setting : settings(run)) {
    fs::create_directories(folder);
    setting.options.target = folder / "world.wrl";
    Row row = staged.row("export", setting.name, setting.preset);
    row.unit = "triangles -> triangles";
    in_own_process(row, run.done,
                   [&](const TakeRow& take) { measure_export(run, setting, row, take); });
    fs::remove_all(folder);
  }
}

}  // namespace atlas::bench

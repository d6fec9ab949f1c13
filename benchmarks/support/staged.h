// A scene on its way through the stages with default settings. Each stage runs once, when it is
// first needed. Benchmarks of stages start from it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "benchmarks/support/measure.h"
#include "benchmarks/support/own_process.h"
#include "benchmarks/support/work.h"
#include "libatlas/charts/charts.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas::bench {

struct StageSettings {
  std::uint32_t pages = 8;
  std::int32_t page_size = 2048;
  double texel = 0;  // scene units; 0: as the whole export would choose
  double threshold = 2.0 / 255;
};

class Staged {
 public:
  Staged(std::string name, LoadedScene loaded, const Context& context);

  // Each function runs the stages that it needs. Errors: those of the stages.
  Status need_charts();
  Status need_light();     // sampler and tone curve
  Status need_textures();  // sizes after downsizing
  Status need_layout();

  const Scene& scene() const { return loaded.scene; }
  MeshView view() const;
  ChartLight light() const { return {*sampler, *charts, *tone}; }
  double texel() const;                  // settings.texel, or the value that 0 stands for
  std::vector<Vec2d> densities() const;  // one per chart, from textures
  // Returns a row of this scene with everything except the results.
  Row row(const std::string& stage, const std::string& setting, bool preset = false) const;

  const std::string name;
  LoadedScene loaded;
  const Context& context;
  StageSettings settings;
  int threads = 0;  // as in Row::threads
  std::optional<ChartSet> charts;
  std::optional<LuminanceSampler> sampler;
  std::optional<ToneMapping> tone;
  std::optional<TextureResult> textures;
  std::optional<PageLayout> layout;
};

// The input of a stage's benchmark.
struct StageRun {
  Staged& staged;
  int repeats = 1;
  bool sweep = true;  // all settings; otherwise only the standard one
  TakeRow done;

  // Measures `work`, which fills in the row's values, in a separate process, and passes on the row.
  // Other effects of `work` are lost.
  void measured(Row& row, const std::function<Status()>& work) const;
};

// There is one per file of stages/. If preparation fails, there is a row that says so.
void bench_baseline(const StageRun& run);    // parse an OBJ of the mesh, compute its normals
void bench_charts(const StageRun& run);      // error: seam length / sqrt(area)
void bench_downsizing(const StageRun& run);  // error: rms of display values
void bench_grouping(const StageRun& run);    // error: imbalance of the groups
void bench_packing(const StageRun& run);     // error: share of the pages left empty
void bench_baking(const StageRun& run);      // error: rms of display values
void bench_simplify(const StageRun& run);    // error: largest slip, texels
void bench_export(const StageRun& run);      // error: rms of display values

// Reports `status` as the row of a stage that could not be prepared.
void report_failure(const StageRun& run, const std::string& stage, const Status& status);

}  // namespace atlas::bench

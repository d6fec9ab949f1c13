#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "benchmarks/support/staged.h"

namespace atlas::bench {
namespace {

struct Setting {
  std::string name;
  bool preset;
  ChartOptions options;
};

std::vector<Setting> settings(bool sweep) {
  std::vector<Setting> list{{"standard", true, {}}};
  if (!sweep) return list;
  for (const double stretch : {1.05, 1.1, 1.5, 2.0}) {
    ChartOptions options;
    options.max_stretch = stretch;
    list.push_back({fmt::format("stretch {}", stretch), false, options});
  }
  for (const double cone : {30.0, 60.0}) {
    ChartOptions options;
    options.cone_degrees = cone;
    list.push_back({fmt::format("cone {}", cone), false, options});
  }
  ChartOptions options;
  options.preset = ChartPreset::fast;
  list.push_back({"fast", true, options});
  options.preset = ChartPreset::best;
  list.push_back({"best", true, options});
  return list;
}

}  // namespace

void bench_charts(const StageRun& run) {
  Staged& staged = run.staged;
  for (const Setting& setting : settings(run.sweep)) {
    Row row = staged.row("charts", setting.name, setting.preset);
    row.unit = "triangles -> charts";
    measure(run.repeats, row, [&]() -> Status {
      Result<ChartSet> made = make_charts(staged.view(), setting.options, staged.context);
      if (!made.ok()) return made.status();
      row.size_out = made->charts.size();
      const double area = std::max(made->surface_area, 1e-300);
      row.values = {{"seam", made->seam_length / std::sqrt(area)},
                    {"l2", made->distortion.stretch_l2},
                    {"p999", made->distortion.stretch_999},
                    {"flips", double(made->distortion.flips)},
                    {"param_cpu", made->timing.parameterization_cpu}};
      if (setting.name == "standard") staged.charts = std::move(*made);
      return {};
    });
    run.done(row);
  }
}

}  // namespace atlas::bench

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "benchmarks/support/chart_setting.h"
#include "benchmarks/support/staged.h"

namespace atlas::bench {
namespace {

// The standard setting comes first.
std::vector<ChartSetting> settings(bool sweep) {
  const std::vector<ChartSetting> presets = chart_presets();
  std::vector<ChartSetting> list{presets[1]};
  if (!sweep) return list;
  for (const double stretch : {1.05, 1.1, 1.5, 2.0}) {
    list.push_back(with_stretch(stretch, "stretch "));
  }
  for (const double cone : {30.0, 60.0}) {
    list.push_back({fmt::format("cone {}", cone), false, {}});
    list.back().options.cone_degrees = cone;
  }
  list.push_back(presets[0]);
  list.push_back(presets[2]);
  return list;
}

// Adds the CPU seconds of the parts of segmentation, then those of parameterisation.
void add_parts(const ChartSet::Timing& t, Row& row) {
  for (const auto& [name, seconds] :
       std::initializer_list<std::pair<const char*, double>>{{"topology_cpu", t.topology_cpu},
                                                             {"noise_cpu", t.noise_cpu},
                                                             {"cells_cpu", t.cells_cpu},
                                                             {"coarse_cpu", t.coarse_cpu},
                                                             {"merging_cpu", t.merging_cpu},
                                                             {"borders_cpu", t.borders_cpu},
                                                             {"cuts_cpu", t.cuts_cpu},
                                                             {"solve_cpu", t.solve_cpu},
                                                             {"flips_cpu", t.flips_cpu},
                                                             {"overlaps_cpu", t.overlaps_cpu},
                                                             {"absorb_cpu", t.absorb_cpu},
                                                             {"limbs_cpu", t.limbs_cpu}}) {
    row.values.emplace_back(name, seconds);
  }
}

}  // namespace

void bench_charts(const StageRun& run) {
  Staged& staged = run.staged;
  for (const ChartSetting& setting : settings(run.sweep)) {
    Row row = staged.row("charts", setting.name, setting.preset);
    row.unit = "triangles -> charts";
    run.measured(row, [&]() -> Status {
      Result<ChartSet> made = make_charts(staged.view(), setting.options, staged.context);
      if (!made.ok()) return made.status();
      row.size_out = made->charts.size();
      const double area = std::max(made->surface_area, 1e-300);
      row.values = {{"seam", made->seam_length / std::sqrt(area)},
                    {"l2", made->distortion.stretch_l2},
                    {"p999", made->distortion.stretch_999},
                    {"flips", double(made->distortion.flips)},
                    {"param_cpu", made->timing.parameterization_cpu}};
      add_parts(made->timing, row);
      return {};
    });
  }
}

}  // namespace atlas::bench

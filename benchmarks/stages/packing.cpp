#include <fmt/format.h>

#include <cmath>

#include "benchmarks/support/staged.h"
#include "libatlas/uvs/placement.h"

namespace atlas::bench {

void bench_packing(const StageRun& run) {
  Staged& staged = run.staged;
  if (const Status s = staged.need_textures(); !s.ok()) return report_failure(run, "packing", s);
  struct Setting {
    std::string name;
    bool outlines;
    PackPreset preset;
  };
  std::vector<Setting> settings{{"standard", true, PackPreset::standard}};
  if (run.sweep) {
    settings.push_back({"outlines, fast", true, PackPreset::fast});
    settings.push_back({"outlines, best", true, PackPreset::best});
    settings.push_back({"boxes, fast", false, PackPreset::fast});
    settings.push_back({"boxes, standard", false, PackPreset::standard});
    settings.push_back({"boxes, best", false, PackPreset::best});
  }
  // Settings are compared on one page. On several pages, the largest chart alone may determine the
  // scale.
  const std::uint32_t pages = run.sweep ? 1 : std::uint32_t(staged.settings.pages);
  // The density is so high that every budget is full. The scale that fits then shows the quality of
  // the packing.
  double area = 0;
  for (const Chart& chart : staged.charts->charts) area += chart.distortion.uv_area;
  const double room = double(pages) * staged.settings.page_size * staged.settings.page_size;
  const double density = std::sqrt(room / area);
  const std::vector<Vec2d> densities(staged.charts->charts.size(), Vec2d{density, density});
  for (const Setting& setting : settings) {
    Row row = staged.row("packing", setting.name, true);
    row.size_in = densities.size();
    row.unit = "charts -> pages";
    LayoutOptions options;
    options.alignment = 4;
    options.pages = pages;
    options.page_size = staged.settings.page_size;
    options.padding = gutter_pad(2);
    options.outlines = setting.outlines;
    options.preset = setting.preset;
    run.measured(row, [&]() -> Status {
      const Result<PageLayout> made =
          lay_out_pages(*staged.charts, densities, options, staged.context);
      if (!made.ok()) return made.status();
      row.size_out = made->pages.size();
      row.values = {{"empty", 1 - made->uv_utilization}, {"scale", made->scale}};
      return {};
    });
  }
}

}  // namespace atlas::bench

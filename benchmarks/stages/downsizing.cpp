#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/support/staged.h"
#include "libatlas/uvs/placement.h"

namespace atlas::bench {

void bench_downsizing(const StageRun& run) {
  Staged& staged = run.staged;
  for (const Status& status : {staged.need_charts(), staged.need_light()})
    if (!status.ok()) return report_failure(run, "downsizing", status);
  std::vector<double> thresholds{2};
  if (run.sweep) thresholds.insert(thresholds.end(), {0.0, 0.5, 1.0, 4.0, 8.0, 16.0});
  for (const double threshold : thresholds) {
    const bool standard = threshold == 2;
    Row row = staged.row(
        "downsizing", standard ? "standard" : fmt::format("threshold {}/255", threshold), standard);
    row.unit = "texels -> texels";
    TextureOptions options;
    options.texel = staged.texel();
    options.threshold = threshold / 255;
    options.max_side = staged.settings.page_size - 2 * gutter_pad(2);
    run.measured(row, [&]() -> Status {
      Result<TextureResult> made = size_chart_textures(staged.light(), options, staged.context);
      if (!made.ok()) return made.status();
      row.size_in = std::uint64_t(made->full_texels);
      row.size_out = std::uint64_t(made->final_texels);
      row.values = {{"rms", made->rms_error},
                    {"max", made->max_error},
                    {"kept", double(made->final_texels) /
                                 double(std::max<std::int64_t>(1, made->full_texels))}};
      return {};
    });
  }
}

}  // namespace atlas::bench

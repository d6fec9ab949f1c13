#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/support/staged.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/simplify/simplify.h"

namespace atlas::bench {

void bench_simplify(const StageRun& run) {
  Staged& staged = run.staged;
  if (const Status s = staged.need_charts(); !s.ok()) return report_failure(run, "simplify", s);
  const std::vector<double> density(staged.charts->charts.size(), 1 / staged.texel());
  const double standard_slip = ExportOptions().simplify_slip;
  std::vector<double> slips{standard_slip};
  if (run.sweep) slips.insert(slips.end(), {0.05, 0.1, 0.5, 1.0});
  for (const double slip : slips) {
    const bool standard = slip == standard_slip;
    Row row =
        staged.row("simplify", standard ? "standard" : fmt::format("slip {}", slip), standard);
    row.unit = "triangles -> triangles";
    SimplifyOptions options;
    options.max_slip_texels = slip;
    run.measured(row, [&]() -> Status {
      const Result<SimplifiedMesh> made =
          simplify_charts({staged.view(), *staged.charts, density}, options, staged.context);
      if (!made.ok()) return made.status();
      row.size_out = made->triangles_out;
      row.values = {{"slip", made->max_slip_texels},
                    {"turn", made->max_turn_degrees},
                    {"kept", double(made->triangles_out) / double(made->triangles_in)}};
      return {};
    });
  }
}

}  // namespace atlas::bench

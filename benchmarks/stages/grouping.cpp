#include "libatlas/pack/grouping.h"
#include "benchmarks/support/staged.h"

namespace atlas::bench {

void bench_grouping(const StageRun& run) {
  Staged& staged = run.staged;
  if (const Status s = staged.need_textures(); !s.ok()) return report_failure(run, "grouping", s);
  std::vector<std::uint64_t> sizes;
  for (const ChartTexture& t : staged.textures->charts)
    sizes.push_back(std::uint64_t(t.width) * std::uint64_t(t.height));
  struct Setting {
    std::string name;
    std::uint32_t groups;
    std::uint64_t work;
  };
  const GroupingOptions defaults;
  std::vector<Setting> settings{{"standard", staged.settings.pages, defaults.refine_work}};
  if (run.sweep) {
    for (const std::uint64_t work : {std::uint64_t(0), std::uint64_t(1) << 26})
      settings.push_back({work ? "refine 2^26" : "refine 0", staged.settings.pages, work});
  }
  for (const Setting& setting : settings) {
    Row row = staged.row("grouping", setting.name, setting.name == "standard");
    row.size_in = sizes.size();
    row.unit = "charts -> groups";
    GroupingOptions options;
    options.groups = setting.groups;
    options.refine_work = setting.work;
    run.measured(row, [&]() -> Status {
      const Result<GroupingResult> made = group_sizes(sizes, options, staged.context);
      if (!made.ok()) return made.status();
      row.size_out = made->group_count;
      row.values = {{"imbalance", made->imbalance},
                    {"evaluations", double(made->trace.size())},
                    {"proved", double(made->proved_smallest)}};
      return {};
    });
  }
}

}  // namespace atlas::bench

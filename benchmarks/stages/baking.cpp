#include <fmt/format.h>

#include "benchmarks/support/staged.h"
#include "libatlas/bake/fidelity.h"

namespace atlas::bench {
namespace {

struct Setting {
  std::string name;
  BakeMethod method;
  int shifts;
};

// The time of the meter is not part of the measured work, so pages are kept (as 8 bits) in between.
Status bake_all(Staged& staged, const Setting& setting, std::vector<Image8>& pages, Row& row) {
  std::vector<std::vector<ChartPlacement>> by_page(staged.layout->pages.size());
  for (const ChartPlacement& p : staged.layout->placements)
    by_page[std::size_t(p.page)].push_back(p);
  pages.clear();
  row.size_out = 0;
  for (std::size_t p = 0; p < by_page.size(); ++p) {
    BakeOptions options;
    options.page_width = staged.layout->pages[p].width;
    options.page_height = staged.layout->pages[p].height;
    options.shifts = setting.shifts;
    options.method = setting.method;
    Result<BakedPage> baked = bake_page(staged.light(), by_page[p], options, staged.context);
    if (!baked.ok()) return baked.status();
    row.size_out += baked->covered_texels;
    pages.push_back(std::move(baked->display));
  }
  return {};
}

void judge(const Staged& staged, const std::vector<Image8>& pages, Row& row) {
  Result<FidelityMeter> meter =
      FidelityMeter::make(staged.light(), staged.layout->placements, {}, {});
  if (!meter.ok()) {
    row.failure = meter.status().message();
    return;
  }
  for (std::size_t p = 0; p < pages.size(); ++p) meter->add_page(std::int32_t(p), pages[p]);
  const Fidelity f = meter->result();
  row.values = {{"rms", f.rmse_display}, {"psnr", f.psnr}, {"p95", f.p95}, {"p999", f.p999}};
}

}  // namespace

void bench_baking(const StageRun& run) {
  Staged& staged = run.staged;
  if (const Status s = staged.need_layout(); !s.ok()) return report_failure(run, "baking", s);
  std::vector<Setting> settings{{"standard", BakeMethod::least_squares, 4}};
  if (run.sweep) {
    for (const int shifts : {1, 9, 16})
      settings.push_back(
          {fmt::format("least squares, {}", shifts), BakeMethod::least_squares, shifts});
    for (const int shifts : {1, 4, 16})
      settings.push_back({fmt::format("average, {}", shifts), BakeMethod::average, shifts});
  }
  for (const Setting& setting : settings) {
    Row row = staged.row("baking", setting.name, setting.name == "standard");
    row.unit = "triangles -> texels";
    in_own_process(row, run.done, [&](const TakeRow& take) {
      std::vector<Image8> pages;
      measure(run.repeats, row, [&] { return bake_all(staged, setting, pages, row); });
      if (row.failure.empty()) judge(staged, pages, row);
      take(row);
    });
  }
}

}  // namespace atlas::bench

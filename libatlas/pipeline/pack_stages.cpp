#include "libatlas/pipeline/pack_stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "libatlas/core/progress.h"
#include "libatlas/pipeline/layout_options.h"
#include "libatlas/pipeline/longest_sides.h"
#include "libatlas/pipeline/more_mip_levels.h"
#include "libatlas/unwrap/fill_pages.h"
#include "libatlas/unwrap/own_scales.h"
#include "libatlas/unwrap/part_gaps.h"

namespace atlas {
namespace {

constexpr double kFirstLayout = 0.7;  // share of packing's progress and time

// Given charts keep their borders.
Result<PageLayout> lay_out_lit(ExportJob& job, const LayoutOptions& options, SizedCharts& sized,
                               const Context& context) {
  if (!job.options.charts.keep_uv_charts) {
    const Result<std::size_t> cut =
        suit_pages({view_of(job.scene), job.options.charts.max_stretch}, options, sized, context);
    if (!cut.ok()) return cut.status();
    report_charts(sized.charts, job.report);
  }
  const double first = job.options.more_mip_levels ? kFirstLayout : 1;
  LayoutOptions narrow = options, wider = options;
  narrow.time_budget *= first;
  wider.time_budget *= (1 - kFirstLayout) / kMostMipLevels;
  Result<PageLayout> layout = lay_out_pages(sized.charts, sized.densities, narrow,
                                            part_of_stage(context, "packing", 0, first));
  if (!layout.ok() || !job.options.more_mip_levels) return layout;
  Result<GuardedLayout> guarded = guard_more_levels({sized.charts, sized.densities}, wider,
                                                    {std::move(*layout), job.options.mip_levels},
                                                    part_of_stage(context, "packing", first, 1));
  if (!guarded.ok()) return guarded.status();
  job.report.mip_levels = guarded->mip_levels;
  return std::move(guarded->layout);
}

// Refuses plain uvs of less than the density asked for: pages have no image whose texels could
// become coarser, and the texture that comes on them would be.
Status check_density(const ExportJob& job, const PlainUvs& uvs, const PageLayout& layout) {
  constexpr double kRounding = 1e-6;
  const double asked = job.options.texel_metres;
  if (asked == 0) return {};
  const double texel = job.scene.metres_per_unit / (uvs.density * layout.scale);
  if (texel <= asked * (1 + kRounding)) return {};
  return {ErrorCode::no_solution,
          fmt::format("ExportOptions::texel_metres: {:g} m needs more room than the pages have, "
                      "whose texels are {:.3g} m (give {}, or longer texels)",
                      asked, texel, more_room(job.options, false))};
}

Result<PageLayout> fill_plain(ExportJob& job, const PlainUvs& uvs, const LayoutOptions& options,
                              ChartSet& charts, const Context& context) {
  if (!job.options.keep_scene && !job.options.plain_part_gaps)
    return fill_pages(uvs, options, charts, context);
  // These uvs are for a lightmap.
  Result<PagesOfParts> apart = fill_pages_apart(uvs, options, charts, context);
  if (!apart.ok()) return apart.status();
  job.report.opened_charts = apart->opened;
  job.report.gaps = apart->left;
  return std::move(apart->layout);
}

// Puts charts that stay where they lay, and the others beside them.
Result<PageLayout> lay_out_like(ExportJob& job, const LayoutOptions& options, ChartSet& charts,
                                const Context& context) {
  const bool apart = job.options.keep_scene || job.options.plain_part_gaps;
  Result<PagesOfParts> pages = job.like->mesh->lay_out(options, apart, charts, context);
  if (!pages.ok()) return pages.status();
  ExportReport& report = job.report;
  report.opened_charts = pages->opened;
  report.gaps = pages->left;
  report_charts(charts, report);
  report.origins = pages->layout.origins;
  return std::move(pages->layout);
}

// Without light, pages are filled as well as packing can, unless a texel density is asked for.
// One above what full pages hold is lowered to that, which also keeps sizes in texels finite.
Result<PageLayout> lay_out_plain(ExportJob& job, const LayoutOptions& options, ChartSet& charts,
                                 const Context& context) {
  if (job.like) return lay_out_like(job, options, charts, context);
  const double asked = job.options.texel_metres;
  const double texels = double(options.pages) * options.page_size * options.page_size;
  double density = filling_density(charts, texels);
  if (asked > 0) density = std::min(density, job.scene.metres_per_unit / asked);
  const PlainUvs uvs{view_of(job.scene), job.options.charts, density, asked > 0};
  Result<PageLayout> layout = fill_plain(job, uvs, options, charts, context);
  if (!layout.ok()) return layout;
  report_charts(charts, job.report);
  job.report.own_scales = layout->own_scales;
  if (!layout->own_scales.empty()) job.report.advice.push_back(own_scales_text(charts, *layout));
  if (Status s = check_density(job, uvs, *layout); !s.ok()) return s;
  if (asked > 0) job.report.texel = job.report.packed_texel = asked / job.scene.metres_per_unit;
  return layout;
}

// Reports the layout and finishes the stage. `uncut`: the number of charts before it.
void report_layout(ExportJob& job, const ChartSet& charts, const PageLayout& layout,
                   std::size_t uncut) {
  ExportReport& report = job.report;
  report.grouping = layout.grouping;
  report.uv_utilization = layout.uv_utilization;
  report.outlines = layout.outlines;
  report_placements(layout.placements, report);
  std::string quality = fmt::format("scale {:.3f}, {:.0f} % used by charts", report.scale,
                                    100 * layout.uv_utilization);
  if (charts.charts.size() > uncut) quality += fmt::format(", cut into {}", charts.charts.size());
  const auto count = [&](ChartOrigin origin) {
    return std::count(layout.origins.begin(), layout.origins.end(), origin);
  };
  if (!layout.origins.empty())
    quality += fmt::format(", {} kept, {} repaired, {} new", count(ChartOrigin::kept),
                           count(ChartOrigin::repaired), count(ChartOrigin::made));
  job.record.finish({uncut, layout.pages.size(), "pages", quality});
}

}  // namespace

Result<PackedCharts> pack_lit(ExportJob& job, SizedCharts sized) {
  const Context& context = job.record.begin("packing");
  ExportReport& report = job.report;
  const std::size_t uncut = sized.charts.charts.size();
  report.mip_levels = job.options.mip_levels;
  Result<PageLayout> layout =
      lay_out_lit(job, layout_options(sized.charts, job.options, true), sized, context);
  if (!layout.ok()) return layout.status();
  report.gaps = left_part_gaps(view_of(job.scene), sized.charts, layout->placements, context);
  report.scale = sized.sizing * layout->scale;
  report.packed_texel =
      packed_texel(sized.charts, sized.full_densities, layout->scale, report.texel / sized.sizing);
  report.least_side_share = least_side_share(sized.charts, sized.densities, *layout);
  report_layout(job, sized.charts, *layout, uncut);
  return PackedCharts{std::move(sized.charts), std::move(sized.full_densities), std::move(*layout)};
}

Result<PackedCharts> pack_plain(ExportJob& job, ChartSet charts) {
  const Context& context = job.record.begin("packing");
  ExportReport& report = job.report;
  const std::size_t uncut = charts.charts.size();
  report.mip_levels = job.options.plain_mip_levels;
  Result<PageLayout> layout =
      lay_out_plain(job, layout_options(charts, job.options, false), charts, context);
  if (!layout.ok()) return layout.status();
  report.scale = layout->scale;
  report_plain_pages(layout->pages, layout->placements, report);
  report_layout(job, charts, *layout, uncut);
  return PackedCharts{std::move(charts), {}, std::move(*layout)};
}

}  // namespace atlas

#include "libatlas/pipeline/more_mip_levels.h"

#include <algorithm>
#include <utility>

#include "libatlas/core/progress.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/unwrap/least_room.h"
#include "libatlas/uvs/placement.h"

namespace atlas {
namespace {

double texels_of(const PageLayout& layout) {
  double texels = 0;
  for (const Extent& page : layout.pages) texels += double(page.area());
  return texels;
}

// Returns the options for as many pages as the layout has, with gutters for `mip_levels`.
LayoutEffort effort_for(int mip_levels, const LayoutOptions& options, const PageLayout& layout) {
  // Whether everything fits at full size shows in the first packings.
  constexpr std::uint32_t kPackings = 4;
  LayoutEffort effort{options};
  effort.padding = gutter_pad(mip_levels);
  effort.alignment = 1 << mip_levels;
  effort.pages = std::uint32_t(layout.pages.size());
  effort.max_packings = kPackings;
  return effort;
}

}  // namespace

Result<GuardedLayout> guard_more_levels(const WantedCharts& wanted, const LayoutOptions& options,
                                        GuardedLayout guarded, const Context& context) {
  const PageLayout& narrow = guarded.layout;
  if (narrow.scale < 1) return guarded;
  const double texels = texels_of(narrow);
  for (int levels = kMostMipLevels; levels > guarded.mip_levels; --levels) {
    const LayoutEffort effort = effort_for(levels, options, narrow);
    if (texels_with_gutters(wanted, effort.padding) > texels) continue;
    const double done = double(kMostMipLevels - levels) / kMostMipLevels;
    const Context part = part_of_stage(context, "packing", done, done + 1.0 / kMostMipLevels);
    Result<WorkedLayout> wide = lay_out_charts(wanted, effort, part);
    if (!wide.ok() && wide.status().code() != ErrorCode::no_solution) return wide.status();
    if (!wide.ok() || wide->scale < 1 || texels_of(*wide) > texels) continue;
    return GuardedLayout{PageLayout(std::move(*wide)), levels};
  }
  return guarded;
}

}  // namespace atlas

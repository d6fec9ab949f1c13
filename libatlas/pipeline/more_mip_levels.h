// Internal: guards more mip levels than were asked for where the pages have room for the gutters.
#pragma once

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/layout_effort.h"

namespace atlas {

struct GuardedLayout {
  PageLayout layout;
  int mip_levels = 0;  // lookups at levels 0..mip_levels read only the chart's texels
};

// If all charts of a layout have their full size, the texels that are left over may as well keep
// coarser mip levels of neighbours apart, which viewers that build every level look up from afar.
// So charts are laid out again for more levels, the most that ExportOptions allows first, until a
// layout is found that also has full size, on no more pages and no more texels. Returns `guarded`
// if there is none. `options` are those it was laid out with; the padding and alignment are
// replaced. Errors: cancelled.
Result<GuardedLayout> guard_more_levels(const WantedCharts& wanted, const LayoutOptions& options,
                                        GuardedLayout guarded, const Context& context);

}  // namespace atlas

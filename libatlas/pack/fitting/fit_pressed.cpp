#include "libatlas/pack/fitting/fit_bounds.h"
#include "libatlas/pack/fitting/fit_factors.h"
#include "libatlas/pack/fitting/fit_pages.h"
#include "libatlas/pack/fitting/fit_result.h"
#include "libatlas/pack/outlines/outline_mask.h"
#include "libatlas/pack/pressing/press.h"
#include "libatlas/pack/pressing/specks.h"
#include "libatlas/pack/pressing/straight_page.h"

namespace atlas::pack {

bool may_be_pressed(std::span<const ChartOutline> outlines, const FitSearchOptions& options) {
  if (!worth_pressing(outlines, options)) return false;
  const bool straight = outlines.size() > 1 && is_straight(outlines);
  if (!straight) return !are_slivers(outlines, options);
  // On a page of given shape, the search over cells fills more with straight charts than pressing
  // does.
  return !has_specks(outlines, options) &&
         (options.free_aspect || options.preset == PackPreset::best);
}

std::optional<FitResult> fit_pressed(const FitCharts& charts, const FitSearchOptions& options,
                                     const Context& context) {
  const auto items = charts.items;
  const auto outlines = charts.outlines;
  if (!may_be_pressed(outlines, options)) return std::nullopt;
  const bool straight = outlines.size() > 1 && is_straight(outlines);
  PressedPage pressed = straight && options.free_aspect
                            ? pack_straight(outlines, options, context)
                            : press_outlines(outlines, options, context);
  if (pressed.scale == 0 || pressed.scale > options.max_scale) return std::nullopt;
  if (below_minimum_side(items, options, pressed.scale)) return std::nullopt;
  return result_of(pressed, outlines, options);
}

}  // namespace atlas::pack

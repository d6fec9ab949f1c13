#include <algorithm>
#include <cmath>

#include "libatlas/pack/fit_bounds.h"
#include "libatlas/pack/fit_pages.h"
#include "libatlas/pack/fit_result.h"
#include "libatlas/pack/outline_mask.h"
#include "libatlas/pack/press.h"
#include "libatlas/pack/specks.h"
#include "libatlas/pack/straight_page.h"

namespace atlas::pack {

std::optional<FitResult> fit_pressed(const FitCharts& charts, const FitSearchOptions& options,
                                     const Context& context) {
  const auto [items, outlines] = charts;
  if (!worth_pressing(outlines, options)) return std::nullopt;
  const bool straight = outlines.size() > 1 && is_straight(outlines);
  // On a page of given shape, the search over cells fills more with straight charts than pressing
  // does.
  if (straight && !options.free_aspect && options.preset != PackPreset::best) return std::nullopt;
  if (straight && has_specks(outlines, options)) return std::nullopt;
  if (!straight && are_slivers(outlines, options)) return std::nullopt;
  PressedPage pressed = straight && options.free_aspect
                            ? pack_straight(outlines, options, context)
                            : press_outlines(outlines, options, context);
  if (pressed.scale == 0 || pressed.scale > options.max_scale) return std::nullopt;
  for (const FitItem& item : items) {
    const double side = std::max(item.width, item.height);
    if (side * pressed.scale < std::min<double>(options.minimum_side, std::ceil(side)))
      return std::nullopt;
  }
  FitResult result;
  result.scale = pressed.scale;
  result.packings = 1;
  result.layouts = pressed.layouts;
  Extent page{options.page_size, options.page_size};
  if (options.free_aspect) {
    page = pressed.page;
  } else if (!options.power_of_two) {
    page = squared(pressed.page, options);
  }
  result.pages = {page};
  result.placements.resize(items.size());
  double shapes = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    FitPlacement& out = result.placements[i];
    out.scale = pressed.scale;
    const PressedPlace& at = pressed.places[i];
    if (!at.placed) {
      write_at_corner(outlines[i], out);
      continue;
    }
    write_outline({at.box, at.angle, at.offset}, options, out);
    shapes += outlines[i].area * out.scale * out.scale;
  }
  result.utilization = share_of_pages(shapes, result);
  return result;
}

}  // namespace atlas::pack

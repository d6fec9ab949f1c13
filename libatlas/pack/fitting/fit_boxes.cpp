#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libatlas/pack/fitting/box_fit.h"
#include "libatlas/pack/fitting/fit_pages.h"
#include "libatlas/pack/fitting/fit_result.h"

namespace atlas::pack {
namespace {

// Finds by bisection the largest scale that was seen to fit, and its layout. Each packing halves
// the interval on average. With 12 packings the scale is within 0.1 % of the threshold.
bool search_scale(BoxFit& fit, FitResult& result, BoxLayout& best) {
  const FitOptions& options = fit.options();
  const Context& context = fit.context();
  const auto attempt = [&](double scale) {
    BoxLayout layout;
    ++result.packings;
    const bool ok = fit.pack_at(scale, options.pages, layout);
    if (ok) {
      best = std::move(layout);
      result.scale = scale;
    }
    context.report("packing", std::min(1.0, double(result.packings) / options.max_packings));
    return ok;
  };
  if (fit.may_fit(options.max_scale) && attempt(options.max_scale)) return true;
  if (!fit.may_fit(fit.least_scale())) return false;
  double high = options.max_scale, low = 0;
  while (high - low > 1e-4 * high) {  // by area and single boxes only, which is cheap
    const double middle = (low + high) / 2;
    (fit.may_fit(middle) ? low : high) = middle;
  }
  // Packings fill 90 to 98 % of the area, so a scale slightly below the area bound is likely to
  // fit.
  bool found = false;
  const double first = low * 0.97;
  double step = first;
  low = 0;
  while (result.packings + 1 < options.max_packings && high > 0) {
    if (context.cancelled()) return false;
    const bool ok = attempt(step);
    (ok ? low : high) = step;
    found = found || ok;
    if (found && high - low < 5e-4 * high) break;
    if (!found && step < 1e-9 * first) break;
    step = found ? (low + high) / 2 : step * 0.85;
  }
  return found || attempt(fit.least_scale());
}

void finish(const BoxFit& fit, const FitOptions& options, BoxLayout& layout, FitResult& result) {
  const std::int32_t a = options.alignment;
  result.pages.assign(layout.pages, {options.page_size, options.page_size});
  for (std::uint32_t p = 0; p < layout.pages; ++p) {
    if (options.power_of_two) {
      const Extent cells = fit.shrink_page(p, layout);
      if (!(cells == fit.page())) result.pages[p] = {cells.width * a, cells.height * a};
    } else {
      result.pages[p] = {0, 0};
    }
  }
  result.placements.resize(layout.placements.size());
  double content = 0;
  for (std::size_t i = 0; i < result.placements.size(); ++i) {
    const Placement& at = layout.placements[i];
    Extent box = fit.boxes()[i];
    if (at.rotated) std::swap(box.width, box.height);
    FitPlacement& out = result.placements[i];
    out.page = at.page;
    out.box = {at.x * a, at.y * a, box.width * a, box.height * a};
    out.content_width = fit.contents()[i].width;
    out.content_height = fit.contents()[i].height;
    out.rotated = at.rotated;
    out.angle = at.rotated ? std::numbers::pi / 2 : 0;
    out.scale = result.scale;
    content += static_cast<double>(fit.contents()[i].area());
    if (!options.power_of_two) enclose(out.box, options, result.pages[at.page]);
  }
  drop_empty_pages(result);
  result.utilization = share_of_pages(content, result);
  result.grouping = in_texels(std::move(layout.grouping), a);
}

}  // namespace

Result<FitResult> fit_boxes(std::span<const FitItem> items, const FitOptions& options,
                            const Context& context) {
  FitResult result;
  result.scale = options.max_scale;
  BoxFit fit(items, options, context);
  BoxLayout best;
  const bool found = search_scale(fit, result, best);
  if (context.cancelled()) return Status::cancelled();
  if (!found) return no_room(items.size(), options);
  // If everything has its largest scale, fewer pages may be enough.
  if (result.scale == options.max_scale) {
    const double pages = fit.box_area(result.scale) / static_cast<double>(fit.page().area());
    for (auto n = static_cast<std::uint32_t>(std::max(1.0, std::ceil(pages)));
         n < best.pages && result.packings < options.max_packings; ++n) {
      BoxLayout fewer;
      ++result.packings;
      if (!fit.pack_at(result.scale, n, fewer)) continue;
      best = std::move(fewer);
      break;
    }
  }
  fit.make_boxes(result.scale);
  finish(fit, options, best, result);
  if (context.cancelled()) return Status::cancelled();  // pages may be larger than necessary
  return result;
}

}  // namespace atlas::pack

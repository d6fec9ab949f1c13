#include "libatlas/pack/fitting/fit_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace atlas::pack {
namespace {

// Returns the longer side of the chart's box, in the direction in which that side is shortest.
double least_side(const ChartOutline& outline, std::uint32_t directions) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < std::max(1u, directions / 4); ++k) {
    const Vec2d box = box_of(outline, 2 * std::numbers::pi * k / directions);
    least = std::min(least, std::max(box.x, box.y));
  }
  return least;
}

}  // namespace

FitBounds fit_bounds(std::span<const ChartOutline> outlines, const FitOptions& options,
                     std::int32_t side, std::uint32_t directions) {
  // A connected chart with gutters of p around it covers its area, 2 p in every column and row that
  // it meets, and 4 p^2 at the corners. At scale s this is a s^2 + b s + c square texels.
  const double pages = double(side) * side * options.pages, p = options.padding;
  double a = 0, b = 0, c = 0, longest = 0;
  for (const ChartOutline& o : outlines) {
    if (o.empty()) continue;
    const Vec2d box = box_of(o, 0);
    a += o.area;
    b += 2 * p * (box.x + box.y);
    c += 4 * p * p;
    if (std::max(box.x, box.y) > longest) longest = std::max(longest, least_side(o, directions));
  }
  constexpr double kAny = std::numeric_limits<double>::infinity();
  FitBounds bounds;
  bounds.gutters_exceed_pages = c >= pages;
  bounds.alone = longest > 0 ? std::max(0.0, side - 2 * p) * (1 - 1e-9) / longest : kAny;
  // This is the positive root, in the form that stays exact if a is small.
  const double room = std::max(0.0, pages - c);
  bounds.with_gutters = a + b > 0 ? 2 * room / (b + std::sqrt(b * b + 4 * a * room)) : kAny;
  if (const double s = std::min(bounds.alone, bounds.with_gutters); s < kAny)
    bounds.area_share = a * s * s / (a * s * s + b * s + c);
  return bounds;
}

bool are_slivers(std::span<const ChartOutline> outlines, const FitOptions& options) {
  // Share of the page that charts must take, compared with their gutters.
  constexpr double kLeastShare = 0.25;
  return outlines.size() > 1 &&
         !(fit_bounds(outlines, options, options.page_size, 4).area_share > kLeastShare);
}

}  // namespace atlas::pack

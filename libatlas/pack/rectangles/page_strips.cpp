#include "libatlas/pack/rectangles/page_strips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "libatlas/core/portable_math.h"
#include "libatlas/pack/rectangles/cells.h"

namespace atlas::pack {
namespace {

Extent turned(Extent e) {
  return {e.height, e.width};
}

// Strips in one direction. `least` and `most` are the widths between which a page can be.
struct Direction {
  bool lying = false;
  std::int32_t least = 1, most = 1;
  double row = 0;  // the width of all items side by side
};

// Returns both directions, upright first. If items may be turned, the longest one stands, unless
// the largest page is too low for that.
std::array<Direction, 2> directions(const Problem& problem) {
  Extent least{1, 1};
  double row = 0, column = 0;
  for (Extent e : problem.items) {
    if (problem.allow_rotation && e.width > e.height) e = turned(e);
    least = {std::max(least.width, e.width), std::max(least.height, e.height)};
    row += e.width;
    column += e.height;
  }
  if (problem.allow_rotation && least.height > problem.page.height) least = turned(least);
  return {{{false, least.width, problem.page.width, row},
           {true, least.height, problem.page.height, column}}};
}

void add_within(const Direction& direction, double width, std::vector<Strip>& strips) {
  const double wished = std::min<double>(width, direction.most);
  add_strip({std::max(direction.least, static_cast<std::int32_t>(wished)), direction.lying},
            strips);
}

double area_wanted(const Problem& problem) {
  double area = 0;
  for (const Extent& e : problem.items) area += static_cast<double>(e.area());
  return area / 0.95;
}

// Adds the upright strips of which the pages' width is a power of two, if that is not far from the
// widths between `narrow` and `wide`. Returns whether there are any.
bool add_powers(const Direction& direction, std::pair<double, double> range,
                const AlignedCells& cells, std::vector<Strip>& strips) {
  bool any = false;
  for (std::int32_t texels = 1; texels <= (1 << 29); texels *= 2) {
    const std::int32_t width = cells.page(texels);
    if (width < direction.least || width > direction.most || width <= 0.35 * range.first ||
        width >= 4.2 * range.second)
      continue;
    add_strip({width, false}, strips);
    any = true;
  }
  return any;
}

}  // namespace

StripProblem::StripProblem(const Problem& problem, Strip strip, std::int32_t length)
    : problem_(problem), lying_(strip.lying) {
  problem_.page = {strip.width, length};
  problem_.max_pages = 1;
  if (!lying_) return;
  for (const Extent& e : problem.items) items_.push_back(turned(e));
  problem_.items = items_;
}

void StripProblem::turn_back(Layout& layout) const {
  layout.unplaced = 0;
  for (Placement& p : layout.placements) {
    if (lying_) std::swap(p.x, p.y);
    layout.unplaced += !p.placed();
  }
}

void add_strip(Strip strip, std::vector<Strip>& strips) {
  if (std::find(strips.begin(), strips.end(), strip) == strips.end()) strips.push_back(strip);
}

void add_usual_strips(const Problem& problem, const PackOptions& options,
                      std::vector<Strip>& strips) {
  constexpr std::array kAround{0.97, 1.0, 1.03, 0.94, 1.06};
  const double area = area_wanted(problem), side = std::ceil(std::sqrt(area));
  const auto both = directions(problem);
  const Direction &upright = both[0], &lying = both[1];
  const double width = std::max<double>(upright.least, std::min(side, area / lying.least));
  if (options.power_of_two &&
      add_powers(upright, {width, std::max(side, width)}, AlignedCells(options), strips))
    return;
  if (upright.least <= side && lying.least <= side) {
    const std::size_t count = strips.empty() ? 5 : 3;
    for (const double factor : std::span(kAround).first(count))
      add_within(upright, side * factor, strips);
    return;
  }
  for (const Direction& direction : both) {
    const double other = direction.lying ? upright.least : lying.least;
    if (direction.least > side)
      add_within(direction, direction.least, strips);
    else
      for (const double factor : std::span(kAround).first(3))
        add_within(direction, std::min(side, area / other) * factor, strips);
  }
}

std::vector<Strip> strips_of_all_widths(const Problem& problem, std::size_t count) {
  std::vector<Strip> strips;
  const std::size_t steps = count / 2;
  for (const Direction& direction : directions(problem)) {
    const double widest = std::min<double>(direction.row, direction.most);
    const double ratio = std::max(1.0, widest / direction.least);
    for (std::size_t k = 0; k < steps; ++k)
      add_within(
          direction,
          std::ceil(direction.least *
                    portable::pow(ratio, static_cast<double>(k) / static_cast<double>(steps - 1))),
          strips);
  }
  return strips;
}

}  // namespace atlas::pack

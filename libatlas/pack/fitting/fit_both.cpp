#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libatlas/core/progress.h"
#include "libatlas/pack/fitting/fit_result.h"
#include "libatlas/pack/fitting/fit_search.h"
#include "libatlas/pack/outlines/shape_check.h"

namespace atlas {
namespace {

// If boxes or pages are filled to a larger share than this, outlines have nothing to win.
constexpr double kFullBoxes = 0.88;

// What both ways of fitting are compared by.
class Comparison {
 public:
  Comparison(std::span<const FitItem> items, const FitOptions& options)
      : items_(items), options_(options), areas_(items.size()), lows_(items.size()) {
    for (std::size_t i = 0; i < items.size(); ++i) measure(i);
    for (const double a : areas_) whole_ += a;
    if (options.shapes_area > 0 && whole_ > 0) {
      for (double& a : areas_) a *= options.shapes_area / whole_;
      whole_ = options.shapes_area;
    }
  }

  // Gives the boxes the angles and offsets of outlines, and notes how full the pages are.
  void complete(FitResult& boxed) const {
    boxed.boxes = true;
    double shapes = 0;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      FitPlacement& p = boxed.placements[i];
      const double s = p.scale, x = p.box.x + options_.padding, y = p.box.y + options_.padding;
      const Vec2d low = lows_[i];
      p.offset = p.rotated ? Vec2d{x + p.content_height + s * low.y, y - s * low.x}
                           : Vec2d{x - s * low.x, y - s * low.y};
      shapes += areas_[i] * axis_scale(items_[i].width, s) * axis_scale(items_[i].height, s);
    }
    boxed.filled = pack::share_of_pages(shapes, boxed);
  }

  void complete_outlined(FitResult& outlined) const {
    double shapes = 0;
    for (std::size_t i = 0; i < items_.size(); ++i)
      shapes += areas_[i] * outlined.placements[i].scale * outlined.placements[i].scale;
    outlined.filled = pack::share_of_pages(shapes, outlined);
  }

  // Returns whether packing by outlines may win. It does not if boxes fill the pages, and one page
  // more would not make all charts larger. (Where charts have to be as large as they can be, and
  // pages end where charts do, full pages say nothing about the scale.) Neither does it if there
  // are many charts that nearly fill their boxes, because packing by boxes then leaves less of a
  // page empty.
  bool may_beat(const FitResult& boxed) const {
    constexpr std::size_t kMany = 1000;
    const bool large = boxed.pages.size() >= options_.pages || boxed.scale >= options_.max_scale;
    const bool given = options_.power_of_two || options_.free_aspect;
    if (boxed.filled > kFullBoxes && large && given) return false;
    if (items_.size() < kMany) return true;
    double box_area = 0;
    for (const FitItem& item : items_) box_area += item.width * item.height;
    return whole_ < kFullBoxes * box_area;
  }

  // Returns whether fit a is better than b. A larger scale is better, and for the same scale,
  // smaller pages are. With free_aspect, the fuller page is better.
  bool better(const FitResult& a, const FitResult& b) const {
    if (options_.free_aspect) return a.filled > b.filled;
    if (a.scale != b.scale) return a.scale > b.scale;
    return texels(a) < texels(b);
  }

 private:
  void measure(std::size_t i) {
    const ChartShape& shape = options_.shapes[i];
    const bool indexed = !shape.triangles.empty();
    const std::size_t n = indexed ? shape.triangles.size() : shape.corners.size();
    const auto corner = [&](std::size_t k) {
      return shape.corners[indexed ? shape.triangles[k] : k];
    };
    if (n > 0) lows_[i] = corner(0);
    for (std::size_t k = 0; k + 2 < n; k += 3) {
      const Vec2d a = corner(k), b = corner(k + 1), c = corner(k + 2);
      areas_[i] += 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
      lows_[i] = {std::min({lows_[i].x, a.x, b.x, c.x}), std::min({lows_[i].y, a.y, b.y, c.y})};
    }
  }

  // Sides stop shrinking at the smallest length that is allowed.
  double axis_scale(double side, double scale) const {
    return side > 0 ? std::max(scale, std::min<double>(options_.minimum_side, side) / side) : scale;
  }

  static std::int64_t texels(const FitResult& fit) {
    std::int64_t sum = 0;
    for (const Extent& page : fit.pages) sum += page.area();
    return sum;
  }

  std::span<const FitItem> items_;
  const FitOptions& options_;
  std::vector<double> areas_;  // one per shape, in square texels at scale 1
  std::vector<Vec2d> lows_;    // lower left corners of the shapes' boxes
  double whole_ = 0;           // the sum of areas_
};

}  // namespace

namespace pack {

Result<FitResult> search_boxes_or_outlines(std::span<const FitItem> items,
                                           const FitSearchOptions& options,
                                           const Context& context) {
  FitSearchOptions by_boxes = options;
  by_boxes.shapes = {};
  // Boxes are turned by quarter turns, which few directions do not include.
  by_boxes.allow_rotation = options.allow_rotation && options.rotations >= 4;
  if (options.shapes.size() != items.size() || items.empty())
    return search_fit(items, options, context);
  if (Status s = check_shapes(options.shapes); !s.ok()) return s;
  FitSearchOptions by_outlines = options;  // whose time begins now
  by_outlines.deadline = ending(options);
  constexpr double kBoxes = 1.0 / 3;  // share of the progress
  Result<FitResult> boxed =
      search_fit(items, by_boxes, part_of_stage(context, "packing", 0, kBoxes));
  if (!boxed.ok() && boxed.status().code() != ErrorCode::no_solution) return boxed;
  const Comparison comparison(items, options);
  if (boxed.ok()) {
    comparison.complete(*boxed);
    if (!comparison.may_beat(*boxed)) return boxed;
  }
  Result<FitResult> best =
      search_fit(items, by_outlines, part_of_stage(context, "packing", kBoxes, 1));
  if (!best.ok()) return boxed.ok() && !context.cancelled() ? std::move(boxed) : std::move(best);
  comparison.complete_outlined(*best);
  if (!boxed.ok() || comparison.better(*best, *boxed)) return best;
  boxed->lost_area = best->lost_area;
  boxed->layouts = best->layouts;
  return boxed;
}

}  // namespace pack

Result<FitResult> fit_boxes_or_outlines(std::span<const FitItem> items, const FitOptions& options,
                                        const Context& context) {
  return pack::search_boxes_or_outlines(items, {options}, context);
}

}  // namespace atlas

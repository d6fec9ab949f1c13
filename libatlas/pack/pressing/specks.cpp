#include "libatlas/pack/pressing/specks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace atlas::pack {
namespace {

// Pressing more charts takes seconds.
constexpr std::size_t kMostPressed = 128;
// The share of a page that charts fill, from which the scale of specks is estimated.
constexpr double kLikelyFill = 0.7;
// Relative to the page: the side of the longest speck, and what all specks take with their gutters.
// A pressed page leaves a quarter of its area between the charts, in gaps of all sizes.
constexpr double kLongestSpeck = 1.0 / 12, kMostSpecks = 0.06;

struct Sized {
  std::uint32_t chart;
  double longest, taken;  // in texels, and their square, gutters included
};

std::vector<Sized> sizes_at(double scale, std::span<const ChartOutline> outlines,
                            const FitOptions& options) {
  const double gutter = 2 * options.padding + options.alignment;
  std::vector<Sized> sizes;
  for (std::uint32_t i = 0; i < outlines.size(); ++i) {
    const Vec2d box = box_of(outlines[i], 0);
    const Vec2d side{scale * box.x + gutter, scale * box.y + gutter};
    sizes.push_back({i, std::max(side.x, side.y), side.x * side.y});
  }
  return sizes;
}

}  // namespace

std::vector<std::uint32_t> charts_to_press(std::span<const ChartOutline> outlines,
                                           const FitOptions& options) {
  std::vector<std::uint32_t> pressed(outlines.size());
  std::iota(pressed.begin(), pressed.end(), 0u);
  if (outlines.size() <= kMostPressed) return pressed;
  if (outlines.size() >= kManyItems) return {};
  double area = 0;
  for (const ChartOutline& o : outlines) area += o.area;
  if (!(area > 0)) return {};
  const double side = options.page_size, page = side * side;
  const double scale = std::min(options.max_scale, std::sqrt(kLikelyFill * page / area));
  std::vector<Sized> sizes = sizes_at(scale, outlines, options);
  std::stable_sort(sizes.begin(), sizes.end(),
                   [](const Sized& a, const Sized& b) { return a.taken < b.taken; });
  pressed.clear();
  double taken = 0;
  for (const Sized& s : sizes) {
    taken += s.taken;
    if (s.longest > kLongestSpeck * side || taken > kMostSpecks * page) pressed.push_back(s.chart);
  }
  if (pressed.empty() || pressed.size() > kMostPressed) return {};
  std::sort(pressed.begin(), pressed.end());
  return pressed;
}

bool has_specks(std::span<const ChartOutline> outlines, const FitOptions& options) {
  const std::size_t pressed = charts_to_press(outlines, options).size();
  return pressed > 0 && pressed < outlines.size();
}

}  // namespace atlas::pack

// Independent checks of layouts: brute force where the packers are clever.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/outline.h"
#include "libatlas/pack/pack.h"

namespace atlas::test {

// SplitMix64, written anew.
struct Noise {
  std::uint64_t state;
  std::uint64_t next();
  int in(int low, int high);  // inclusive
  double unit();
};

// Rectangles with log-normal sides, as the generator of the shared instances draws them.
std::vector<Extent> log_normal_rects(std::size_t count, std::uint64_t seed);

// "" if no item leaves its page (border kept), none comes closer than the padding to another or to
// a pinned rectangle, all begin at multiples of the alignment, and only allowed ones are turned;
// otherwise what is wrong. Compares all pairs.
std::string check_layout(std::span<const Extent> items, std::span<const Placement> placements,
                         std::span<const Extent> pages, const PackOptions& options);

// "" if no texel lies within the padding (maximum norm, less a thousandth) of two charts and none
// within the padding of a chart is outside the page. Every triangle is tried on every texel near
// it.
struct PlacedShape {
  ChartShape shape;
  std::uint32_t page = 0;
  double scale = 1, angle = 0;
  Vec2d offset;
};
std::string check_outlines(std::span<const PlacedShape> placed, std::span<const Extent> pages,
                           int padding);

// Charts for fit_pages, 3 corners a triangle, and their boxes. Moved, not copied: shapes point at
// corners.
struct ChartItems {
  std::vector<std::vector<Vec2d>> corners;
  std::vector<ChartShape> shapes;
  std::vector<FitItem> items;

  explicit ChartItems(std::vector<std::vector<Vec2d>> charts);
  ChartItems(ChartItems&&) = default;
};

// The same charts where the result has put them.
std::vector<PlacedShape> placed_shapes(const ChartItems& charts, const FitResult& fit);

// A blob with `corners` corners around the origin, as a fan of triangles (3 corners each).
std::vector<Vec2d> blob(Noise& noise, double radius, int corners);

}  // namespace atlas::test

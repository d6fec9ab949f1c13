// Independent checks of layouts, by brute force where the packers use clever methods.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/outline.h"
#include "libatlas/pack/pack.h"

namespace atlas::test {

// The SplitMix64 generator, written independently of the library's.
struct Noise {
  std::uint64_t state;
  std::uint64_t next();
  int in(int low, int high);  // both bounds inclusive
  double unit();
};

// Returns rectangles with log-normal sides, drawn as the generator of the shared instances does.
std::vector<Extent> log_normal_rects(std::size_t count, std::uint64_t seed);

// Checks that no item leaves its page (less the border), that none comes closer than the padding to
// another one or to a pinned rectangle, that all begin at multiples of the alignment, and that only
// allowed ones are rotated. Compares all pairs. Returns "" or what is wrong.
std::string check_layout(std::span<const Extent> items, std::span<const Placement> placements,
                         std::span<const Extent> pages, const PackOptions& options);

// Checks that no texel lies within the padding (maximum norm, less a thousandth) of two charts, and
// that no texel within the padding of a chart is outside the page. Tests every triangle against
// every texel near it. Returns "" or what is wrong.
struct PlacedShape {
  ChartShape shape;
  std::uint32_t page = 0;
  double scale = 1, angle = 0;
  Vec2d offset;
};
std::string check_outlines(std::span<const PlacedShape> placed, std::span<const Extent> pages,
                           int padding);

// Charts for fit_pages (three corners per triangle) and their boxes. It can be moved but not
// copied, because the shapes point at the corners.
struct ChartItems {
  std::vector<std::vector<Vec2d>> corners;
  std::vector<ChartShape> shapes;
  std::vector<FitItem> items;

  explicit ChartItems(std::vector<std::vector<Vec2d>> charts);
  ChartItems(ChartItems&&) = default;
};

// Returns the same charts at the places that the result gives them.
std::vector<PlacedShape> placed_shapes(const ChartItems& charts, const FitResult& fit);

// Returns a blob with `corners` corners around the origin, as a fan of triangles (3 corners each).
std::vector<Vec2d> blob(Noise& noise, double radius, int corners);

}  // namespace atlas::test

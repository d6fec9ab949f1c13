// Internal: the edges and triangles of a chart that decide which cells it touches.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "libatlas/pack/outline.h"

namespace atlas::pack {

// A point is in the chart if the edges wind around it or if it lies in a loose triangle. Inner
// edges of the mesh cancel, so a chart of n triangles has about sqrt(n) edges.
struct ChartOutline {
  struct Edge {
    Vec2d from, to;
  };
  std::vector<Edge> edges = {};  // loop after loop, with the chart to their left
  // Degenerate triangles and those of the opposite orientation.
  std::vector<std::array<Vec2d, 3>> loose = {};
  double area = 0;  // the area that it covers (covered_area.h)

  bool empty() const { return edges.empty() && loose.empty(); }
};

// Makes a shape's outline. It takes O(n) for shapes with indices and O(n log n) for others.
ChartOutline outline_of(const ChartShape& shape);
std::vector<ChartOutline> outlines_of(std::span<const ChartShape> shapes, const Context& context);

// Returns width and height of the chart's box after turning it by this angle in radians; 0 for an
// empty chart.
Vec2d box_of(const ChartOutline& outline, double angle);

// Returns the lower left corner of the box of the chart as it is; 0 for an empty chart.
Vec2d low_corner_of(const ChartOutline& outline);

// Returns the outline with simplified loops, whose corners are at least about `spacing` apart. It
// deviates by no more than that.
ChartOutline thinned(const ChartOutline& outline, double spacing);

}  // namespace atlas::pack

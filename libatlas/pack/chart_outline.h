// Internal: what of a chart's triangles decides which cells it touches.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "libatlas/pack/outline.h"

namespace atlas::pack {

// A point is in the chart if the edges wind around it or if it lies in a loose triangle. Inner
// edges of the mesh cancel: a chart of n triangles has some sqrt(n) edges.
struct ChartOutline {
  struct Edge {
    Vec2d from, to;
  };
  std::vector<Edge> edges;                  // loop after loop, the chart to their left
  std::vector<std::array<Vec2d, 3>> loose;  // triangles without area or against the others' sense
  double area = 0;                          // that it covers (covered_area.h)

  bool empty() const { return edges.empty() && loose.empty(); }
};

// O(n) for shapes with indices, O(n log n) for others.
ChartOutline outline_of(const ChartShape& shape);
std::vector<ChartOutline> outlines_of(std::span<const ChartShape> shapes, const Context& context);

// Width and height of the chart's box when it is turned by so many radians; 0 for an empty one.
Vec2d box_of(const ChartOutline& outline, double angle);

// The lower left corner of its box as it is; 0 for an empty one.
Vec2d low_corner_of(const ChartOutline& outline);

// With loops whose corners are about `spacing` apart at least: off by no more than that.
ChartOutline thinned(const ChartOutline& outline, double spacing);

}  // namespace atlas::pack

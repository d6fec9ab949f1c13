// Internal: flat charts laid side by side along their common border.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/flattening/outline.h"
#include "libatlas/charts/geometry/rigid_fit.h"

namespace atlas {

// An edge of a chart's border with another chart.
struct BorderEdge {
  std::uint32_t other, half_edge;  // other: the chart across; half_edge: the own one
  double length;
};

// Lengths of borders are compared in parts of the whole: where a mesh is symmetric many are equal
// but for rounding.
constexpr double kBorderParts = 1024;

struct ChartNeighbour {
  std::uint32_t chart;
  double border;  // length, in such parts of the border with all
  std::span<const BorderEdge> edges;
};

double length_of(std::span<const BorderEdge> edges);

// `chart`: its label in `partition`. Sorted by the chart across.
std::vector<BorderEdge> find_border(const Topology& topology, const Partition& partition,
                                    std::span<const std::uint32_t> triangles, std::uint32_t chart);

// Of the chart whose border it is; the longest common border first. The edges point into `border`.
std::vector<ChartNeighbour> find_neighbours(std::span<const BorderEdge> border);

struct ChartPair {
  const FlatChart &a, &b;
};

// The half-edge's two ends in the uvs of its chart: from, to.
std::array<std::uint32_t, 2> ends_of(const FlatChart& chart, std::uint32_t half_edge);

// Two charts that become one: `a` is moved to where `b` continues best across `edges`, the border
// of `a` with it or a part of that.
class Joint {
 public:
  Joint(const Topology& topology, const ChartPair& pair, std::span<const BorderEdge> edges);

  const Motion& motion() const { return motion_; }
  std::size_t triangle_count() const { return a_.triangles.size() + b_.triangles.size(); }
  // Ascending.
  std::vector<std::uint32_t> triangles() const;
  // 3 a triangle in that order, those of `a` moved.
  std::vector<Vec2d> uvs() const;
  // The smallest rectangle around both as they are, side by side: its area. The outlines are those
  // of `a` and `b`, as they are.
  double box(const Outline& a, const Outline& b) const;
  // How much of `a` lies on `b` where they do not go together: how many sides of triangles of `a`
  // cross the border of `b`, inner ones twice; counts no further than `most`.
  std::size_t overlap(const Outline& a, const Outline& b, std::size_t most) const;

 private:
  const Topology& topology_;
  const FlatChart& a_;
  const FlatChart& b_;
  std::span<const BorderEdge> edges_;
  Motion motion_;  // misfit: by the length of the edges
};

}  // namespace atlas

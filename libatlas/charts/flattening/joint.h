// Internal: places two flat charts side by side along their common border.
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
  std::uint32_t other, half_edge;  // other: the chart across; half_edge: on this chart's side
  double length;
};

// Border lengths are compared as multiples of 1 / kBorderParts of the whole border. In symmetric
// meshes many are equal but for rounding.
constexpr double kBorderParts = 1024;

struct ChartNeighbour {
  std::uint32_t chart;
  double border;  // length, in such parts of the whole border with other charts
  std::span<const BorderEdge> edges;
};

double length_of(std::span<const BorderEdge> edges);

// Returns the edges of a chart's border with other charts, sorted by the chart across. `chart` is
// its label in `partition`.
std::vector<BorderEdge> find_border(const Topology& topology, const Partition& partition,
                                    std::span<const std::uint32_t> triangles, std::uint32_t chart);

// Returns the neighbours of the chart with that border, the one with the longest common border
// first. Their edges point into `border`.
std::vector<ChartNeighbour> find_neighbours(std::span<const BorderEdge> border);

struct ChartPair {
  const FlatChart &a, &b;
};

// Returns the two ends of a half-edge as indices into its chart's uvs: from, to.
std::array<std::uint32_t, 2> ends_of(const FlatChart& chart, std::uint32_t half_edge);

// Two charts that are to become one. `a` is moved to where it best continues `b` across `edges`,
// which are the border of `a` with `b` or a part of it.
class Joint {
 public:
  Joint(const Topology& topology, const ChartPair& pair, std::span<const BorderEdge> edges);

  const Motion& motion() const { return motion_; }
  std::size_t triangle_count() const { return a_.triangles.size() + b_.triangles.size(); }
  // The triangles of both charts, ascending.
  std::vector<std::uint32_t> triangles() const;
  // Three uvs per triangle in that order; those of `a` are moved.
  std::vector<Vec2d> uvs() const;
  // Returns the area of the smallest rectangle around both charts, side by side. The outlines are
  // those of `a` and `b`, not moved.
  double box(const Outline& a, const Outline& b) const;
  // Measures how much of `a` would lie on `b`: returns how many sides of triangles of `a` cross the
  // border of `b`, where inner sides count twice. Stops counting at `most`.
  std::size_t overlap(const Outline& a, const Outline& b, std::size_t most) const;

 private:
  const Topology& topology_;
  const FlatChart& a_;
  const FlatChart& b_;
  std::span<const BorderEdge> edges_;
  Motion motion_;  // misfit relative to the length of the edges
};

}  // namespace atlas

// Internal: flat charts laid side by side along their common border.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flatten.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {

// An edge of a chart's border with another chart.
struct BorderEdge {
  std::uint32_t other, half_edge;  // other: the chart across; half_edge: the own one
  double length;
};

struct ChartNeighbour {
  std::uint32_t chart;
  double border;  // length, in 1024ths of the border with all
  std::span<const BorderEdge> edges;
};

// `chart`: its label in `partition`. Sorted by the chart across.
std::vector<BorderEdge> find_border(const Topology& topology, const Partition& partition,
                                    std::span<const std::uint32_t> triangles, std::uint32_t chart);

// Of the chart whose border it is; the longest common border first. The edges point into `border`.
std::vector<ChartNeighbour> find_neighbours(std::span<const BorderEdge> border);

// A turn and a shift; applied to complex numbers.
struct Motion {
  glm::dvec2 turn{1, 0}, shift{0};
  double misfit = 0;  // root mean square distance of what should meet, by the border's length
  std::size_t edges = 0;

  Vec2d operator()(Vec2d p) const {
    return {turn.x * p.x - turn.y * p.y + shift.x, turn.y * p.x + turn.x * p.y + shift.y};
  }
};

// Two charts that become one: `a` is moved to where `b` continues best across `edges`, the border
// of `a` with it (Procrustes).
class Joint {
 public:
  Joint(const Topology& topology, const FlatChart& a, const FlatChart& b,
        std::span<const BorderEdge> edges);

  const Motion& motion() const { return motion_; }
  std::size_t triangle_count() const { return a_.triangles.size() + b_.triangles.size(); }
  // Ascending.
  std::vector<std::uint32_t> triangles() const;
  // 3 a triangle in that order, those of `a` moved.
  std::vector<Vec2d> uvs() const;
  // The smallest rectangle around both as they are, side by side: its area.
  double box() const;

 private:
  const FlatChart& a_;
  const FlatChart& b_;
  Motion motion_;
};

}  // namespace atlas

// Internal: finds shortest paths along edges, within a chart and near a given path or vertex.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/charts/mesh/chart_fans.h"

namespace atlas {

// Paths only pass vertices inside the chart (ChartFans::Place). A vertex is given by any half-edge
// that leaves it. The object keeps its memory for all vertices between calls.
class BandPaths {
 public:
  using Path = std::vector<std::uint32_t>;  // consecutive half-edges
  using Ends = std::vector<std::uint32_t>;

  // An edge costs border_weight(), with this `crease_angle`.
  BandPaths(const Topology& topology, const Partition& partition, double crease_angle);

  struct Band {
    // How many edges the new path may lie away from the given one.
    int rings;
    // The share of its length that an edge costs more for each of these.
    double stiffness;
  };
  // Returns the cheapest path near `path` from one of the first ends to one of the second; empty if
  // there is none.
  Path beside(const Path& path, const std::pair<Ends, Ends>& ends, const Band& band);

  // Returns the path from the start of h, inside the chart, to the nearest border, if that is
  // within `rings` edges; else an empty path.
  Path to_border(std::uint32_t h, int rings);

 private:
  void add(std::uint32_t h, int level);
  void choose_unit(const Path& edges);
  void spread(int rings);
  Path find(const Ends& starts, const Ends& goals, double stiffness);
  Path trace(std::uint32_t v) const;
  void clear();

  const Topology& topology_;
  ChartFans fans_;
  double crease_angle_, unit_ = 1;
  // One per vertex of the current band.
  std::vector<double> distance_;
  std::vector<std::uint32_t> through_, out_;  // half-edges: by which a path arrives; one that
                                              // leaves
  std::vector<int> level_;                    // edges from the given path; -1: not in the band
  std::vector<std::uint32_t> band_;           // vertices
};

}  // namespace atlas

// Internal: shortest paths along edges, within a chart and near some place.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/charts/mesh/chart_fans.h"

namespace atlas {

// Paths pass vertices inside the chart only (ChartFans::Place); vertices are named by half-edges
// that leave them. Keeps memory for all vertices from call to call.
class BandPaths {
 public:
  using Path = std::vector<std::uint32_t>;  // half-edges, one after the other
  using Ends = std::vector<std::uint32_t>;

  // `crease_cosine` as for border_weight(), which is what an edge costs.
  BandPaths(const Topology& topology, const Partition& partition, double crease_cosine);

  struct Band {
    int rings;         // edges that the path may lie away from the one given
    double stiffness;  // by which share of its length an edge costs more for each of them
  };
  // The cheapest one beside `path` from one of the first ends to one of the second. Empty if there
  // is none.
  Path beside(const Path& path, const std::pair<Ends, Ends>& ends, const Band& band);

  // From the start of h, inside the chart, to its nearest border, within `rings` edges; empty if
  // that is farther.
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
  double crease_cosine_, unit_ = 1;
  // 1 a vertex, of the band at hand.
  std::vector<double> distance_;
  std::vector<std::uint32_t> through_, out_;  // half-edges: how a path comes; one that leaves
  std::vector<int> level_;                    // edges from the path; -1: not in the band
  std::vector<std::uint32_t> band_;           // vertices
};

}  // namespace atlas

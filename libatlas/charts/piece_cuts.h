// Internal: the ways in which pieces can be cut into cells and charts, and what they cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/cells/regions.h"
#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/merge.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// A mesh whose cells are merged into charts.
struct Cut {
  const Topology& topology;
  Cells cells;
  CoarseMesh coarse;
  MergeResult merged;
  std::vector<std::uint8_t> left_out;  // one per piece

  bool takes(std::uint32_t t) const {
    return cells.of_triangle[t] != kNoIndex && !left_out[topology.component[t]];
  }
};

// Whether any piece is taken, of which each is left out or not.
bool takes_any(std::span<const std::uint8_t> left_out);

// Returns the piece that each cell lies in; kNoIndex if that is left out.
std::vector<std::uint32_t> pieces_of(const Cut& cut);

// Returns the mean fan_error() in each piece, weighted by the cells' areas; 0 if it is left out.
// The cells need not be merged.
std::vector<double> fan_errors(const Cut& cut);

// Returns, for each piece, how many edges within its cells bend by more than 55 degrees, divided by
// the number of its triangles; 0 if it is left out. The cells need not be merged.
std::vector<double> folds_in_cells(const Cut& cut);

// Returns, for each piece, the share of the edges between its regions that lie within cells.
std::vector<double> crossed_borders(const Cut& cut, const Regions& regions);

// The cost of a piece's charts; less is better.
struct PieceCost {
  std::size_t charts = 0;
  double seams = 0;  // length times weight

  bool operator<(const PieceCost& other) const {
    return charts < other.charts || (charts == other.charts && seams < kShorter * other.seams);
  }
  static constexpr double kShorter = 1 - 1e-3;  // keeps rounding from deciding
};

// Returns the costs of the pieces over all cuts, each of which leaves out what another one takes.
std::vector<PieceCost> chosen_costs(std::span<const Cut> cuts);

// Leaves out the worse result of pieces that both cuts take. That of the second one is better if it
// has at most this share of the first one's charts, or, with `or_shorter`, as many charts and
// shorter seams.
void choose(Cut& a, Cut& b, double share, bool or_shorter);

}  // namespace atlas

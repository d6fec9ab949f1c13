// Internal: divides a flat piece along edges near a straight line.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/seams/min_cut.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas {

struct LineCut {
  struct Part {
    std::vector<std::uint32_t> triangles;  // ascending, connected
    bool beyond;                           // on the far side of the line
  };
  std::vector<Part> parts;  // at least two, or none
  double length = 0;        // of the edges between them
};

// Divides the same triangles near any number of lines.
class LineCutter {
 public:
  // `triangles` are connected, as indices into chart.triangles. `polygons` has one number for each
  // triangle that chart.triangles names, or is empty: triangles with equal numbers stay together.
  // The chart and the lists must outlive the cutter.
  LineCutter(const FlatChart& chart, const param::HalfEdges& half_edges,
             std::span<const std::uint32_t> triangles, std::span<const std::uint32_t> polygons);

  // Sets the direction that lines are perpendicular to (radians from u). A triangle's position is
  // that of its centroid; a polygon's, the mean of those of its triangles.
  void face(double angle);
  double low() const { return low_; }
  double high() const { return high_; }

  // Returns the shortest cut between the triangles at least `band` before the line and those as far
  // beyond it; among equally short ones, the straightest. Where the band holds many triangles, the
  // cut is made near the line in it that crosses the least edge length. Parts of less than `crumb`
  // area stay with a neighbour.
  LineCut cut(double line, double band, double crumb);

 private:
  bool together(std::uint32_t i, std::uint32_t j) const {
    return !polygon_.empty() && polygon_[i] == polygon_[j];
  }
  void number_polygons(std::span<const std::uint32_t> polygons);
  void gather_polygons();
  void narrow(double& line, double& band) const;
  void find_sides(double line, double band);
  std::vector<LineCut::Part> parts() const;
  bool move_crumbs(const std::vector<LineCut::Part>& parts, double crumb);

  const FlatChart& chart_;
  std::span<const std::uint32_t> triangles_;
  std::uint32_t polygon_count_ = 0;
  double longest_ = 0, low_ = 0, high_ = 0;
  // Three per triangle of the piece: the opposite side in the piece, or kNoIndex; and the length.
  std::vector<std::uint32_t> joined_;
  std::vector<float> length_;
  // One per triangle of the piece: its position, its side of the cut, and its node in the minimum
  // cut.
  std::vector<double> along_;
  std::vector<std::uint32_t> polygon_;  // numbered from 0; empty: none
  std::vector<std::uint8_t> side_;
  std::vector<std::uint32_t> node_;
  MinCut min_cut_;
};

}  // namespace atlas

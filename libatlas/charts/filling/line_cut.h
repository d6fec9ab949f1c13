// Internal: a flat piece divided along edges near a straight line.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/seams/min_cut.h"
#include "libatlas/param/halfedges.h"

namespace atlas {

struct LineCut {
  struct Part {
    std::vector<std::uint32_t> triangles;  // ascending, in one piece
    bool beyond;                           // the line
  };
  std::vector<Part> parts;  // two at least, or none
  double length = 0;        // of the edges between them
};

// Divides the same triangles near any number of lines.
class LineCutter {
 public:
  // `triangles`: places in chart.triangles, in one piece; chart and list must outlive the cutter.
  LineCutter(const FlatChart& chart, const param::HalfEdges& half_edges,
             std::span<const std::uint32_t> triangles);

  // Lines are across this direction from now on (radians from u on). A triangle lies where its
  // middle does.
  void face(double angle);
  double low() const { return low_; }
  double high() const { return high_; }

  // The shortest way between what lies `band` before the line and what lies as far beyond, of equal
  // ones the straightest; where the band holds many triangles, near the line in it that crosses the
  // least. Parts of less than `crumb` area stay with a neighbour.
  LineCut cut(double line, double band, double crumb);

 private:
  void narrow(double& line, double& band) const;
  void find_sides(double line, double band);
  std::vector<LineCut::Part> parts() const;
  bool move_crumbs(const std::vector<LineCut::Part>& parts, double crumb);

  const FlatChart& chart_;
  std::span<const std::uint32_t> triangles_;
  double longest_ = 0, low_ = 0, high_ = 0;
  // 3 a triangle of the piece: the side of another one that it is joined to, or kNoIndex; lengths.
  std::vector<std::uint32_t> joined_;
  std::vector<float> length_;
  // 1 a triangle of the piece: where its middle lies, its side, its place among those of the band.
  std::vector<double> along_;
  std::vector<std::uint8_t> side_;
  std::vector<std::uint32_t> node_;
  MinCut min_cut_;
};

}  // namespace atlas

#include "libatlas/charts/cells/rows.h"

#include <span>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// A triangle is a needle if its height over its shortest edge exceeds this many of that edge. The
// value is not round, so that needles of equal shape do not lie at the limit. With 5.1, rows would
// go on across the widest side of some mouldings.
constexpr double kRowNeedle = 3.63;
// The least share of a piece's area in needles.
constexpr double kLeastShare = 0.5;

class RowFinder {
 public:
  RowFinder(const Topology& topology, const CellPlan& plan) : topology_(topology), plan_(plan) {}

  Regions run() {
    rows_.of_triangle.assign(topology_.triangle_count(), kNoIndex);
    for (std::uint32_t k = 0; k < plan_.pieces.count(); ++k) {
      rows_.share.push_back(find_in(plan_.pieces.of(k), plan_.cells[k]));
    }
    return std::move(rows_);
  }

 private:
  double squared_length(std::uint32_t h) const {
    const auto at = [&](std::uint32_t g) {
      return to_dvec(topology_.points[topology_.corner_vertex[g]]);
    };
    const glm::dvec3 edge = at(next_half_edge(h)) - at(h);
    return glm::dot(edge, edge);
  }

  // Whether h is the short edge of a needle.
  bool end(std::uint32_t h) const {
    return 2.0 * topology_.areas[h / 3] > kRowNeedle * squared_length(h);
  }

  // Returns the share of the area in needles.
  double needles(std::span<const std::uint32_t> piece) const {
    double area = 0, needles = 0;
    for (const std::uint32_t t : piece) {
      area += topology_.areas[t];
      if (end(3 * t) || end(3 * t + 1) || end(3 * t + 2)) needles += topology_.areas[t];
    }
    return area > 0 ? needles / area : 0;
  }

  // Returns the share of the piece's area in rows: all of it, or none.
  double find_in(std::span<const std::uint32_t> piece, std::uint32_t cells) {
    if (cells == 0) return 0;
    if (needles(piece) < kLeastShare) return 0;
    std::uint32_t rows = 0;
    for (const std::uint32_t t : piece) {
      if (rows_.of_triangle[t] == kNoIndex) flood(t, rows++);
      if (rows > cells) break;
    }
    if (rows > 1 && rows <= cells) return 1;
    for (const std::uint32_t t : piece) rows_.of_triangle[t] = kNoIndex;
    return 0;
  }

  // Marks what can be reached from the seed without crossing from one needle's end to another's.
  void flood(std::uint32_t seed, std::uint32_t row) {
    rows_.of_triangle[seed] = row;
    queue_.assign(1, seed);
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      for (std::uint32_t h = 3 * queue_[i]; h < 3 * queue_[i] + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || rows_.of_triangle[o / 3] != kNoIndex || (end(h) && end(o))) continue;
        rows_.of_triangle[o / 3] = row;
        queue_.push_back(o / 3);
      }
    }
  }

  const Topology& topology_;
  const CellPlan& plan_;
  Regions rows_;
  std::vector<std::uint32_t> queue_;
};

}  // namespace

Regions find_rows(const Topology& topology, const CellPlan& plan) {
  return RowFinder(topology, plan).run();
}

}  // namespace atlas

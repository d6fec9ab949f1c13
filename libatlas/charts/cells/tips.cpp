#include "libatlas/charts/cells/tips.h"

#include <cmath>
#include <unordered_set>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

// Angle defects in radians. A tip has at least kTip. All other vertices of its piece together have
// at most kOthers, plus kRounding each for the rounding of coordinates.
constexpr double kTip = 5e-3, kOthers = 0.02, kRounding = 1e-5;
// A piece of n triangles has at most kFewTips + n / kTrianglesATip tips.
constexpr std::size_t kFewTips = 2, kTrianglesATip = 200;

struct Piece {
  std::size_t triangles = 0, tips = 0, others = 0;
  double rest = 0;  // the sum over all other vertices

  // Counts a vertex in. Returns whether it is a tip.
  bool take(double defect) {
    if (defect > kTip) {
      ++tips;
      return true;
    }
    rest += defect;
    ++others;
    return false;
  }

  bool curved() const {
    return tips > kFewTips + triangles / kTrianglesATip ||
           rest > kOthers + kRounding * double(others);
  }
};

// Divides the cells around tips one after the other, each by breadth-first search from the two
// halves of the triangles around its tip.
class TipDivider {
 public:
  TipDivider(const Topology& topology, Cells& cells) : topology_(topology), cells_(cells) {}

  void divide(std::uint32_t tip) {
    const std::uint32_t cell = cells_.of_triangle[tip / 3];
    queue_.clear();
    std::uint32_t h = tip;
    do {
      if (h == kNoIndex || cells_.of_triangle[h / 3] != cell) return;
      queue_.push_back(h / 3);
      h = topology_.opposite[previous_half_edge(h)];
    } while (h != tip);
    const std::uint32_t halves[2] = {cells_.count, cells_.count + 1};
    const std::size_t around = queue_.size();
    for (std::size_t i = 0; i < around; ++i) {
      cells_.of_triangle[queue_[i]] = halves[2 * i / around];
    }
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      for (std::uint32_t g = 3 * queue_[i]; g < 3 * queue_[i] + 3; ++g) {
        const std::uint32_t o = topology_.opposite[g];
        if (o == kNoIndex || cells_.of_triangle[o / 3] != cell) continue;
        cells_.of_triangle[o / 3] = cells_.of_triangle[queue_[i]];
        queue_.push_back(o / 3);
      }
    }
    for (const std::uint32_t t : queue_) {
      if (cells_.of_triangle[t] == halves[1]) cells_.of_triangle[t] = cell;
    }
    ++cells_.count;
  }

 private:
  const Topology& topology_;
  Cells& cells_;
  std::vector<std::uint32_t> queue_;  // triangles
};

}  // namespace

// Angles are added as products of complex numbers.
double angle_defect(const Topology& topology, std::uint32_t start) {
  const auto point = [&](std::uint32_t h) {
    return to_dvec(topology.points[topology.corner_vertex[h]]);
  };
  glm::dvec2 turn(1, 0);
  std::uint32_t h = start;
  do {
    const glm::dvec3 at = point(h), a = point(next_half_edge(h)) - at,
                     b = point(previous_half_edge(h)) - at;
    const double c = glm::dot(a, b), s = glm::length(glm::cross(a, b));
    const double length = std::sqrt(c * c + s * s);
    turn = glm::dvec2(turn.x * c - turn.y * s, turn.x * s + turn.y * c) / length;
    h = topology.opposite[previous_half_edge(h)];
  } while (h != kNoIndex && h != start);
  return h == kNoIndex ? 0 : -portable::atan2(turn.y, turn.x);
}

std::vector<std::uint32_t> find_tips(const Topology& topology) {
  std::vector<Piece> pieces(topology.component_count);
  for (const std::uint32_t k : topology.component) {
    if (k != kNoIndex) ++pieces[k].triangles;
  }
  std::vector<std::uint8_t> seen(topology.points.size(), 0);
  std::vector<std::uint32_t> tips;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    if (topology.component[t] == kNoIndex) continue;
    Piece& piece = pieces[topology.component[t]];
    for (std::uint32_t h = 3 * t; h < 3 * t + 3 && !piece.curved(); ++h) {
      if (seen[topology.corner_vertex[h]]) continue;
      seen[topology.corner_vertex[h]] = 1;
      if (piece.take(std::abs(angle_defect(topology, h)))) tips.push_back(h);
    }
  }
  std::erase_if(tips, [&](std::uint32_t h) { return pieces[topology.component[h / 3]].curved(); });
  return tips;
}

bool developable(const Topology& topology, std::span<const std::uint32_t> triangles) {
  Piece piece{triangles.size()};
  std::unordered_set<std::uint32_t> seen;
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (!seen.insert(topology.corner_vertex[h]).second) continue;
      piece.take(std::abs(angle_defect(topology, h)));
      if (piece.curved()) return false;
    }
  }
  return true;
}

void divide_at_tips(const Topology& topology, const std::vector<std::uint32_t>& tips,
                    Cells& cells) {
  TipDivider divider(topology, cells);
  for (const std::uint32_t h : tips) divider.divide(h);
}

}  // namespace atlas

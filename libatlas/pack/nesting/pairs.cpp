#include "libatlas/pack/nesting/pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libatlas/core/hull.h"
#include "libatlas/core/portable_math.h"

namespace atlas::pack {
namespace {

// A chart whose smallest box is fuller than this, or which fills less of its convex hull than the
// second value, is not paired, nor is one whose hull has more corners.
constexpr double kFullBox = 0.8, kConvex = 0.9;
constexpr std::size_t kMostCorners = 12;
// The number of longest edges that are tried, and the least ratio of their lengths.
constexpr std::size_t kEdges = 3;
constexpr double kAlike = 0.9;
// The number of charts that are compared with each one: the next ones by length.
constexpr std::size_t kCandidates = 24;
// A pair must fill its box by this factor more than the fuller of the two charts. A pair that fills
// its box by kPerfect is taken at once.
constexpr double kGain = 1.15, kPerfect = 0.97;

Vec2d minus(Vec2d a, Vec2d b) {
  return {a.x - b.x, a.y - b.y};
}
Vec2d plus(Vec2d a, Vec2d b) {
  return {a.x + b.x, a.y + b.y};
}

using Points = std::vector<Vec2d>;

struct Edge {
  std::uint32_t from = 0;  // corner of the hull
  double length = 0;
};

// A chart that may be paired.
struct Hull {
  std::uint32_t chart = 0;
  Points corners;
  std::vector<Edge> edges;  // the longest, longest first
  double area = 0, fill = 0;
};

// Returns whether the chart may be paired.
bool make_hull(const ChartOutline& outline, Hull& hull, Points& scratch) {
  if (!outline.loose.empty() || outline.edges.empty() || !(outline.area > 0)) return false;
  scratch.clear();
  for (const ChartOutline::Edge& e : outline.edges) scratch.push_back(e.from);
  const double convex = hull_area(scratch, hull.corners);
  const std::size_t n = hull.corners.size();
  if (n < 3 || n > kMostCorners) return false;
  hull.edges.clear();
  for (std::uint32_t i = 0; i < n; ++i) {
    hull.edges.push_back({i, distance(hull.corners[i], hull.corners[(i + 1) % n])});
  }
  hull.area = outline.area;
  hull.fill = outline.area / box_area(hull.corners);
  if (!(hull.fill < kFullBox) || outline.area < kConvex * convex) return false;
  std::stable_sort(hull.edges.begin(), hull.edges.end(),
                   [](const Edge& a, const Edge& b) { return a.length > b.length; });
  hull.edges.resize(std::min(n, kEdges));
  return true;
}

// Finds the best way to join two charts.
class Joiner {
 public:
  // Returns how full the pair's smallest box is, 0 if no edges match.
  double join(const Hull& a, const Hull& b, ChartPair& best) {
    double fullest = 0;
    for (const Edge& ea : a.edges)
      for (const Edge& eb : b.edges) {
        const double ratio = ea.length / eb.length;
        if (ratio < kAlike || ratio > 1 / kAlike) continue;
        for (int end = 0; end < (std::abs(ratio - 1) < 1e-6 ? 1 : 2); ++end) {
          ChartPair pair = along(a, ea, b, eb, end);
          const double fill = (a.area + b.area) / box_of_pair(a, b, pair);
          // Of equal ways the first is taken, whatever the rounding.
          if (fill <= fullest * (1 + 1e-9)) continue;
          fullest = fill;
          best = pair;
        }
      }
    return fullest;
  }

 private:
  // Lays edge eb of b along ea of a, so that the start (end 0) or the end of ea meets the other end
  // of eb.
  static ChartPair along(const Hull& a, const Edge& ea, const Hull& b, const Edge& eb, int end) {
    const auto corner = [](const Hull& h, std::uint32_t i) {
      return h.corners[i % h.corners.size()];
    };
    const Vec2d a0 = corner(a, ea.from), a1 = corner(a, ea.from + 1);
    const Vec2d b0 = corner(b, eb.from), b1 = corner(b, eb.from + 1);
    const Vec2d da = minus(a1, a0), db = minus(b1, b0);
    ChartPair pair;
    pair.first = a.chart;
    pair.second = b.chart;
    pair.turn = portable::atan2(-da.y, -da.x) - portable::atan2(db.y, db.x);
    pair.end_of_first = end == 0 ? a0 : a1;
    pair.end_of_second = end == 0 ? b1 : b0;
    pair.normal = {da.y / ea.length, -da.x / ea.length};
    return pair;
  }

  double box_of_pair(const Hull& a, const Hull& b, const ChartPair& pair) {
    points_.assign(a.corners.begin(), a.corners.end());
    const double c = portable::cos(pair.turn), s = portable::sin(pair.turn);
    for (const Vec2d p : b.corners) {
      const Vec2d d = minus(p, pair.end_of_second);
      points_.push_back(plus(pair.end_of_first, {c * d.x - s * d.y, s * d.x + c * d.y}));
    }
    hull_area(points_, hull_);
    return box_area(hull_);
  }

  Points points_, hull_;
};

Vec2d rotated(Vec2d p, double angle) {
  const double c = portable::cos(angle), s = portable::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

ChartOutline turned(const ChartOutline& outline, double angle) {
  ChartOutline result = outline;
  const double c = portable::cos(angle), s = portable::sin(angle);
  const auto turn = [&](Vec2d& p) { p = {c * p.x - s * p.y, s * p.x + c * p.y}; };
  for (ChartOutline::Edge& e : result.edges) {
    turn(e.from);
    turn(e.to);
  }
  return result;
}

struct MaskPair {
  const Mask &first, &second;
};

// Returns the place of the second mask relative to the first, in cells, at which they do not
// overlap. It lies along the normal from the place at which the charts touch, which is given in
// texels.
BitPage::Place closest_place(const MaskPair& masks, Vec2d touching, Vec2d normal,
                             const PieceOptions& options) {
  // Beyond this distance along the normal, masks cannot overlap.
  const double cell = options.cell, farthest = std::sqrt(2.0) * (2 * options.padding + 3 * cell);
  BitPage::Place at;
  for (double gap = 0; gap < farthest; gap += 0.5 * cell) {
    at = {static_cast<std::int32_t>(std::lround((touching.x + gap * normal.x) / cell)),
          static_cast<std::int32_t>(std::lround((touching.y + gap * normal.y) / cell))};
    if (!overlap(masks.first, masks.second, at.x, at.y)) break;
  }
  return at;
}

}  // namespace

std::vector<ChartPair> find_pairs(std::span<const ChartOutline> outlines, const Context& context) {
  std::vector<Hull> hulls;
  Hull hull;
  Points scratch;
  for (std::uint32_t i = 0; i < outlines.size(); ++i) {
    hull.chart = i;
    if (make_hull(outlines[i], hull, scratch)) hulls.push_back(hull);
  }
  std::stable_sort(hulls.begin(), hulls.end(), [](const Hull& a, const Hull& b) {
    return a.edges[0].length > b.edges[0].length;
  });
  std::vector<ChartPair> pairs;
  std::vector<bool> taken(hulls.size());
  Joiner joiner;
  for (std::size_t i = 0; i < hulls.size() && !context.cancelled(); ++i) {
    if (taken[i]) continue;
    double fullest = 0;
    std::size_t with = i;
    ChartPair best;
    for (std::size_t j = i + 1, seen = 0; j < hulls.size() && seen < kCandidates; ++j) {
      if (taken[j]) continue;
      if (hulls[j].edges[0].length < kAlike * hulls[i].edges[0].length) break;
      ++seen;
      ChartPair pair;
      const double fill = joiner.join(hulls[i], hulls[j], pair);
      if (fill <= fullest * (1 + 1e-9) || fill < kGain * std::max(hulls[i].fill, hulls[j].fill))
        continue;
      fullest = fill;
      best = pair;
      with = j;
      if (fill >= kPerfect) break;
    }
    if (with == i) continue;
    taken[i] = taken[with] = true;
    pairs.push_back(best);
  }
  return pairs;
}

JoinedPiece make_pair_piece(const ScaledCharts& charts, const ChartPair& pair,
                            const PieceOptions& options) {
  const std::array outlines{charts.outlines[pair.first],
                            turned(charts.outlines[pair.second], pair.turn)};
  const std::array factors{charts.factors[pair.first], charts.factors[pair.second]};
  PieceOptions own = options;
  own.factors = factors;
  own.masks_only = true;
  // One thread: the caller makes many pairs at once.
  const std::vector<Piece> pieces = make_pieces(outlines, own, Context{.threads = 1});
  JoinedPiece joined;
  const std::size_t directions = pieces[0].masks.size();
  joined.piece.masks.resize(directions);
  joined.parts.resize(directions);
  const Vec2d end_of_second = rotated(pair.end_of_second, pair.turn);
  for (std::size_t k = 0; k < directions; ++k) {
    const Mask &a = pieces[0].masks[k], &b = pieces[1].masks[k];
    if (a.cells == 0 || b.cells == 0) continue;
    const double angle = 2 * std::numbers::pi * double(k) / double(directions);
    const Vec2d p = rotated(pair.end_of_first, angle), q = rotated(end_of_second, angle);
    const Vec2d in_a = pieces[0].origins[k], in_b = pieces[1].origins[k];
    const Vec2d touching{in_a.x + factors[0] * p.x - factors[1] * q.x - in_b.x,
                         in_a.y + factors[0] * p.y - factors[1] * q.y - in_b.y};
    const auto [dx, dy] = closest_place({a, b}, touching, rotated(pair.normal, angle), options);
    joined.piece.masks[k] = join(std::array{MaskAt{a}, MaskAt{b, dx, dy}});
    const std::int32_t x = std::max(0, -dx), y = std::max(0, -dy);
    joined.parts[k] = {{pair.first, 0, {x, y, a.width, a.height}, in_a},
                       {pair.second, pair.turn, {x + dx, y + dy, b.width, b.height}, in_b}};
  }
  complete(joined.piece, options.keep_tests);
  return joined;
}

}  // namespace atlas::pack

#include "libatlas/pack/nesting/rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "libatlas/core/hull.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/portable_math.h"

namespace atlas::pack {
namespace {

// Fewer copies are not laid in rows. Of larger numbers of groups, those with the largest area are.
constexpr std::size_t kFewest = 24, kMostGroups = 16;
// The directions that are tried in half a turn, and the number of edges of the hull besides.
constexpr int kDirections = 24;
constexpr std::size_t kRowEdges = 6;
// Cells along a chart's largest extent while a plan is made.
constexpr double kCells = 48;

// Returns the least distance at which mask b, dy cells above a, lies free of a when it is pushed in
// from the right; nothing if they share no row.
std::optional<std::int32_t> push_in(const Mask& a, const Mask& b, std::int32_t dy) {
  std::optional<std::int32_t> least;
  const std::int32_t end = std::min(a.height, b.height + dy);
  for (std::int32_t r = std::max(0, dy); r < end; ++r) {
    const auto left = a.row(r), right = b.row(r - dy);
    if (left.empty() || right.empty()) continue;
    const std::int32_t dx = left.back().end - right.front().begin;
    least = std::max(dx, least.value_or(dx));
  }
  return least;
}

// The lowest and the highest cell of each column of a mask.
struct Profile {
  std::vector<std::int32_t> bottom, top;

  explicit Profile(const Mask& mask)
      : bottom(std::size_t(mask.width), mask.height), top(std::size_t(mask.width), 0) {
    for (std::int32_t r = 0; r < mask.height; ++r)
      for (const Run& run : mask.row(r))
        for (auto x = std::size_t(run.begin); x < std::size_t(run.end); ++x) {
          bottom[x] = std::min(bottom[x], r);
          top[x] = r + 1;
        }
  }
};

// An endless row of one or two charts per period.
class EndlessRow {
 public:
  explicit EndlessRow(std::int32_t period)
      : bottom_(std::size_t(period), std::numeric_limits<std::int32_t>::max() / 4),
        top_(std::size_t(period), std::numeric_limits<std::int32_t>::min() / 4) {}

  void add(const Profile& profile, std::int32_t x, std::int32_t y) {
    const auto period = std::int32_t(top_.size());
    for (std::size_t c = 0; c < profile.top.size(); ++c) {
      const auto at = std::size_t(((x + std::int32_t(c)) % period + period) % period);
      bottom_[at] = std::min(bottom_[at], y + profile.bottom[c]);
      top_[at] = std::max(top_[at], y + profile.top[c]);
    }
  }

  // Returns how far apart such rows lie above each other at least, over all shifts along them; at
  // most `least`.
  std::int32_t distance(std::int32_t least) const {
    for (std::size_t shift = 0; shift < top_.size(); ++shift) {
      std::int32_t apart = 1;
      for (std::size_t c = 0, d = shift; c < top_.size() && apart < least; ++c) {
        apart = std::max(apart, top_[c] - bottom_[d]);
        if (++d == top_.size()) d = 0;
      }
      least = std::min(least, apart);
    }
    return least;
  }

 private:
  std::vector<std::int32_t> bottom_, top_;
};

struct RowChoice {
  double density = 0;
  bool alternate = false;
  std::int32_t rise = 0;  // in cells
};

// Returns the densest rows of this mask.
RowChoice densest_rows(const Mask& mask) {
  const Mask other = half_turn(mask);
  const Profile upright(mask), turned(other);
  const std::int32_t alone = std::max(1, *push_in(mask, mask, 0));
  EndlessRow single(alone);
  single.add(upright, 0, 0);
  constexpr auto kAny = std::numeric_limits<std::int32_t>::max();
  RowChoice best{double(mask.cells) / (double(alone) * single.distance(kAny)), false, 0};
  for (std::int32_t rise = 1 - mask.height; rise < mask.height; ++rise) {
    const auto there = push_in(mask, other, rise), back = push_in(other, mask, -rise);
    if (!there || !back) continue;
    const std::int32_t period = std::max({alone, *there + *back, 1});
    EndlessRow row(period);
    row.add(upright, 0, 0);
    row.add(turned, *there, rise);
    // Rows that lie farther apart are not denser than the best ones.
    const double cells = 2 * double(mask.cells) / period;
    const auto farthest = std::int32_t(std::ceil(cells / best.density));
    const double density = cells / row.distance(farthest);
    // Of equal rows, those that alternate least are taken.
    if (density > best.density * (1 + 1e-9)) best = {density, true, rise};
  }
  return best;
}

// Returns the angles that are tried, each below half a turn.
std::vector<double> angles_for(const ChartOutline& outline, double& extent) {
  std::vector<double> angles;
  for (int k = 0; k < kDirections; ++k) angles.push_back(std::numbers::pi * k / kDirections);
  std::vector<Vec2d> points, hull;
  for (const ChartOutline::Edge& e : outline.edges) points.push_back(e.from);
  hull_area(points, hull);
  std::vector<Vec2d> edges;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d a = hull[i], b = hull[(i + 1) % hull.size()];
    edges.push_back({b.x - a.x, b.y - a.y});
    for (const Vec2d& p : hull) extent = std::max(extent, distance(a, p));
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Vec2d& a, const Vec2d& b) {
    return portable::hypot(a.x, a.y) > portable::hypot(b.x, b.y);
  });
  edges.resize(std::min(edges.size(), kRowEdges));
  for (const Vec2d& e : edges) {
    const double angle = -portable::atan2(e.y, e.x);
    angles.push_back(angle < 0 ? angle + std::numbers::pi : angle);
  }
  return angles;
}

RowPlan plan_rows(const ChartOutline& outline) {
  RowPlan plan;
  double extent = 0;
  for (const double angle : angles_for(outline, extent)) {
    if (!(extent > 0)) break;
    const double factor = kCells / extent;
    Vec2d origin;
    const Mask mask = rasterize(outline, {factor, angle, 0, 1}, origin);
    const RowChoice rows = densest_rows(mask);
    // The mask is larger than the chart, by another share in each direction.
    const double density = rows.density * outline.area * factor * factor / double(mask.cells);
    if (density <= plan.density * (1 + 1e-9)) continue;
    plan.density = density;
    plan.angle = angle;
    plan.alternate = rows.alternate;
    plan.rise = rows.rise / factor;
  }
  return plan;
}

struct Member {
  JoinedPart part;
  Mask mask;
};

JoinedPiece join_row(std::span<const Member> members, const PieceOptions& options) {
  std::int32_t left = members[0].part.cells.x, bottom = members[0].part.cells.y;
  for (const Member& m : members) {
    left = std::min(left, m.part.cells.x);
    bottom = std::min(bottom, m.part.cells.y);
  }
  JoinedPiece row;
  row.piece.masks.resize(options.directions);
  row.parts.resize(options.directions);
  std::vector<MaskAt> masks;
  for (const Member& m : members) {
    JoinedPart part = m.part;
    part.cells.x -= left;
    part.cells.y -= bottom;
    masks.push_back({m.mask, part.cells.x, part.cells.y});
    row.parts[0].push_back(part);
  }
  row.piece.masks[0] = join(masks);
  complete(row.piece, options.keep_tests);
  return row;
}

}  // namespace

std::vector<RowPlan> find_rows(std::span<const ChartOutline> outlines, const Context& context) {
  std::vector<AlikeCharts> groups = find_alike(outlines, kFewest, context);
  groups.resize(std::min(groups.size(), kMostGroups));
  std::vector<RowPlan> plans(groups.size());
  parallel_for(context, groups.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      plans[k] = plan_rows(outlines[groups[k].charts[0]]);
      plans[k].alike = std::move(groups[k]);
    }
  });
  std::erase_if(plans, [](const RowPlan& p) { return p.alike.charts.empty(); });  // cancelled
  return plans;
}

std::vector<JoinedPiece> make_row_pieces(const ScaledCharts& charts, const RowPlan& plan,
                                         const PieceOptions& options, std::int32_t length) {
  std::vector<JoinedPiece> rows;
  std::vector<Member> members;
  for (std::size_t k = 0; k < plan.alike.charts.size(); ++k) {
    const bool odd = plan.alternate && k % 2 == 1;
    Member m;
    m.part.chart = plan.alike.charts[k];
    m.part.turn = plan.angle + plan.alike.turns[k] + (odd ? std::numbers::pi : 0);
    const double factor = charts.factors[m.part.chart];
    m.mask = rasterize(charts.outlines[m.part.chart],
                       {factor, m.part.turn, options.padding, options.cell}, m.part.origin);
    const auto rise =
        static_cast<std::int32_t>(std::lround(odd ? plan.rise * factor / options.cell : 0));
    m.part.cells = {0, rise, m.mask.width, m.mask.height};
    for (std::size_t i = members.size(); i-- > 0;) {
      const Rect& before = members[i].part.cells;
      if (before.right() <= m.part.cells.x) continue;
      const auto free = push_in(members[i].mask, m.mask, rise - before.y);
      if (free) m.part.cells.x = std::max(m.part.cells.x, before.x + *free);
    }
    if (!members.empty() && m.part.cells.right() > length) {
      rows.push_back(join_row(members, options));
      members.clear();
      m.part.cells.x = 0;
    }
    members.push_back(std::move(m));
  }
  if (!members.empty()) rows.push_back(join_row(members, options));
  return rows;
}

}  // namespace atlas::pack

#include "libatlas/charts/merging/crossing_finder.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/merging/fan_kernels.h"
#include "libatlas/core/hull.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

using Boxes = CrossingFinder::Boxes;
using Edges = std::span<const std::array<std::uint32_t, 2>>;

// Charts of cells have a few dozen border edges, and testing all pairs takes less time than sorting
// them. Borders of more than kLongBorder edges are first tested in groups of kGroup edges, which
// are mostly neighbours.
constexpr double kTouching = 1e-3;  // as a share of the depth that counts as deep
constexpr std::size_t kLongBorder = 256, kGroup = 32;

struct Segment {
  Vec2d from, to;
};

// Returns how far one of two crossing edges would have to move for them not to cross.
double crossing_depth(const Segment& e, const Segment& f) {
  const auto nearest = [](const Segment& line, const Segment& ends) {
    const double length = portable::hypot(line.to.x - line.from.x, line.to.y - line.from.y);
    return std::min(std::abs(cross(line.from, line.to, ends.from)),
                    std::abs(cross(line.from, line.to, ends.to))) /
           length;
  };
  return std::min(nearest(e, f), nearest(f, e));
}

// Whether an end of one segment is closer than `distance` to the other.
bool touch(const Segment& e, const Segment& f, double distance) {
  const auto near = [&](const Vec2d& p, const Segment& s) {
    const double x = s.to.x - s.from.x, y = s.to.y - s.from.y, squared = x * x + y * y;
    const double a = p.x - s.from.x, b = p.y - s.from.y;
    const double t = squared > 0 ? std::clamp((a * x + b * y) / squared, 0.0, 1.0) : 0;
    const double u = a - t * x, v = b - t * y;
    return u * u + v * v < distance * distance;
  };
  return near(e.from, f) || near(e.to, f) || near(f.from, e) || near(f.to, e);
}

struct Box {
  double left, right, low, high;
};

// Reserves four extra entries, since boxes are read four at a time, beyond the last one too.
void resize(std::size_t count, Boxes& boxes) {
  boxes.stride = count + 4;
  boxes.sides.assign(4 * boxes.stride, 0);
}

void put(const Box& box, std::size_t i, Boxes& boxes) {
  double* const at = boxes.sides.data() + i;
  at[0] = box.left;
  at[boxes.stride] = box.right;
  at[2 * boxes.stride] = box.low;
  at[3 * boxes.stride] = box.high;
}

Box get(const Boxes& boxes, std::size_t i) {
  const double* const at = boxes.sides.data() + i;
  return {at[0], at[boxes.stride], at[2 * boxes.stride], at[3 * boxes.stride]};
}

void fill_edges(Edges border, std::span<const Vec2d> uvs, Boxes& boxes) {
  resize(border.size(), boxes);
  for (std::size_t i = 0; i < border.size(); ++i) {
    const Vec2d &a = uvs[border[i][0]], &b = uvs[border[i][1]];
    put({std::min(a.x, b.x), std::max(a.x, b.x), std::min(a.y, b.y), std::max(a.y, b.y)}, i, boxes);
  }
}

void fill_groups(const Boxes& edges, std::size_t count, Boxes& groups) {
  resize((count + kGroup - 1) / kGroup, groups);
  for (std::size_t begin = 0; begin < count; begin += kGroup) {
    Box all = get(edges, begin);
    for (std::size_t i = begin + 1; i < std::min(begin + kGroup, count); ++i) {
      const Box one = get(edges, i);
      all = {std::min(all.left, one.left), std::max(all.right, one.right),
             std::min(all.low, one.low), std::max(all.high, one.high)};
    }
    put(all, begin / kGroup, groups);
  }
}

// Returns the index of the first box from `next` on that meets `box`. If there is none, returns
// `count` or up to three more. Four boxes are tested at a time.
ATLAS_INLINE std::size_t find_near(const Boxes& boxes, const Box& box, std::size_t next,
                                   std::size_t count) {
  const double *const left = boxes.sides.data(), *const right = left + boxes.stride,
                      *const low = right + boxes.stride, *const high = low + boxes.stride;
  for (; next < count; next += 4) {
    const auto met = (QuadAt(left + next).quad <= box.right) &
                     (QuadAt(right + next).quad >= box.left) &
                     (QuadAt(low + next).quad <= box.high) & (QuadAt(high + next).quad >= box.low);
    if (!(met[0] | met[1] | met[2] | met[3])) continue;
    return next + (met[0] ? 0 : met[1] ? 1 : met[2] ? 2 : 3);
  }
  return count;
}
ATLAS_WIDE std::size_t find_near_wide(const Boxes& boxes, const Box& box, std::size_t next,
                                      std::size_t count) {
  return find_near(boxes, box, next, count);
}
std::size_t find_near_narrow(const Boxes& boxes, const Box& box, std::size_t next,
                             std::size_t count) {
  return find_near(boxes, box, next, count);
}

struct Range {
  std::size_t begin, end;
};

// Calls visit(i) for the boxes in the range that meet `box`, until it returns false. Returns
// whether it never did.
template <class Visit>
bool visit_near(const Boxes& boxes, const Box& box, Range range, const Visit& visit) {
  const auto near = has_wide_vectors ? find_near_wide : find_near_narrow;
  for (std::size_t i = near(boxes, box, range.begin, range.end); i < range.end;
       i = near(boxes, box, i + 1, range.end)) {
    if (!visit(i)) return false;
  }
  return true;
}

}  // namespace

Crossing CrossingFinder::find(Edges border, std::span<const Vec2d> uvs, double deep) {
  const std::size_t n = border.size();
  fill_edges(border, uvs, edges_);
  const bool grouped = n > kLongBorder;
  if (grouped) fill_groups(edges_, n, groups_);
  Crossing crossing = Crossing::none;
  for (std::size_t i = 0; i < n && crossing != Crossing::deep; ++i) {
    const std::uint32_t a = border[i][0], b = border[i][1];
    const auto test = [&](std::size_t j) {
      const auto [c, d] = border[j];
      if (a == c || a == d || b == c || b == d) return true;
      const Segment e{uvs[a], uvs[b]}, f{uvs[c], uvs[d]};
      const bool crosses = cross_each_other(e.from, e.to, f.from, f.to);
      if (!crosses && !touch(e, f, kTouching * deep)) return true;
      const double depth = crosses ? crossing_depth(e, f) : 0;
      crossing = depth > deep ? Crossing::deep : Crossing::shallow;
      return depth <= deep;
    };
    Box box = get(edges_, i);
    const double t = kTouching * deep;
    box = {box.left - t, box.right + t, box.low - t, box.high + t};
    if (!grouped) {
      visit_near(edges_, box, {i + 1, n}, test);
      continue;
    }
    visit_near(groups_, box, {(i + 1) / kGroup, (n + kGroup - 1) / kGroup}, [&](std::size_t group) {
      return visit_near(edges_, box,
                        {std::max(i + 1, group * kGroup), std::min((group + 1) * kGroup, n)}, test);
    });
  }
  return crossing;
}

}  // namespace atlas

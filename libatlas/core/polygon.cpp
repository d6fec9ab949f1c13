#include "libatlas/core/polygon.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/half_edge.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/predicates.h"

namespace atlas {
namespace {

constexpr std::size_t kMaxConcave = std::size_t{1} << 20;  // no useful surface has more

// Limit on the tests whether a point lies in a triangle, for each corner, of some 10 ns each.
// Outlines of surfaces need less than a hundred.
constexpr std::uint64_t kMostTests = 2000;

// Drops the coordinate along which the polygon's normal is largest, and keeps the polygon
// counter-clockwise.
std::vector<Vec2d> project(std::span<const Vec3d> corners) {
  glm::dvec3 normal(0);
  const glm::dvec3 base = to_glm(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = to_glm(corners[i]) - base;
    const glm::dvec3 b = to_glm(corners[(i + 1) % corners.size()]) - base;
    normal += glm::cross(a, b);
  }
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<Vec2d> flat;
  flat.reserve(corners.size());
  for (const Vec3d& corner : corners) {
    const glm::dvec3 p = to_glm(corner) - base;
    Vec2d q{p[(axis + 1) % 3], p[(axis + 2) % 3]};
    if (normal[axis] < 0) std::swap(q.x, q.y);
    flat.push_back(q);
  }
  return flat;
}

// How far a corner may lie from a straight side and still be a hanging one, relative to the largest
// coordinate. Rounding to floats moves each of three corners by up to a sixteen-millionth of it.
constexpr double kStraightness = 1.0 / (1 << 22);

// Returns twice the area that a triangle needs to be higher than `height` over its longest edge.
double least_area(const Vec2d& a, const Vec2d& b, const Vec2d& c, double height) {
  const auto length = [](const Vec2d& p, const Vec2d& q) {
    return portable::hypot(q.x - p.x, q.y - p.y);
  };
  return height * std::max({length(a, b), length(b, c), length(c, a)});
}

double twice_area(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Returns whether the polygon turns right nowhere, but for hanging corners, and winds once.
bool convex(const std::vector<Vec2d>& p, double height) {
  int sign_changes = 0;
  double last = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec2d &a = p[i], &b = p[(i + 1) % p.size()], &c = p[(i + 2) % p.size()];
    if (orientation(a, b, c) < 0 && -twice_area(a, b, c) > least_area(a, b, c, height))
      return false;
    const double step = b.x - a.x;
    if (step == 0) continue;
    if (last != 0 && (step > 0) != (last > 0)) ++sign_changes;
    last = step;
  }
  return sign_changes <= 2;  // a polygon that winds twice changes direction more often
}

// Whether every triangle of the fan from corner 0 is counter-clockwise and not mere rounding.
bool fans_out(const std::vector<Vec2d>& p, double height) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    if (orientation(p[0], p[i], p[i + 1]) <= 0) return false;
    if (twice_area(p[0], p[i], p[i + 1]) <= least_area(p[0], p[i], p[i + 1], height)) return false;
  }
  return true;
}

// Sweeps a convex polygon from left to right, as monotone polygons are triangulated (Garey et al.
// 1978). Corners of a straight side wait until a corner of another side comes, so hanging corners
// get triangles with area whichever corner is the first. Takes linear time.
class Sweep {
 public:
  Sweep(const std::vector<Vec2d>& points, double height,
        std::vector<std::array<std::uint32_t, 3>>& triangles)
      : points_(points), height_(height), triangles_(triangles) {}

  // Returns false, with unusable triangles, if the polygon is not monotone or a triangle would be
  // turned over.
  bool run() {
    if (!sort()) return false;
    waiting_ = {order_[0].corner, order_[1].corner};
    forward_ = order_[1].forward;
    for (std::size_t i = 2; i < order_.size(); ++i) {
      const bool last = i + 1 == order_.size();
      if (!last && order_[i].forward == forward_) {
        add_to_chain(order_[i].corner);
      } else {
        add_across(order_[i]);
      }
    }
    return std::all_of(triangles_.begin(), triangles_.end(), [&](const auto& t) {
      return orientation(points_[t[0]], points_[t[1]], points_[t[2]]) >= 0;
    });
  }

 private:
  struct Place {
    std::uint32_t corner;
    bool forward;  // whether it lies on the chain that runs from left to right
  };

  bool before(std::uint32_t a, std::uint32_t b) const {
    const Vec2d &p = points_[a], &q = points_[b];
    return p.x != q.x ? p.x < q.x : p.y < q.y;
  }

  // Fills order_ by merging the two chains. Returns false if one of them goes back.
  bool sort() {
    const auto n = std::uint32_t(points_.size());
    std::uint32_t left = 0, right = 0;
    for (std::uint32_t i = 1; i < n; ++i) {
      if (before(i, left)) left = i;
      if (before(right, i)) right = i;
    }
    order_.push_back({left, true});
    std::uint32_t f = (left + 1) % n, b = (left + n - 1) % n;
    while (f != right || b != right) {
      const bool forward = f != right && (b == right || before(f, b));
      const std::uint32_t next = forward ? (f + 1) % n : (b + n - 1) % n;
      if (before(next, forward ? f : b)) return false;
      order_.push_back({forward ? f : b, forward});
      (forward ? f : b) = next;
    }
    order_.push_back({right, true});
    return order_.size() == n;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.push_back(forward_ ? std::array{a, b, c} : std::array{b, a, c});
  }

  // Cuts off the corners of the chain that the new one sees.
  void add_to_chain(std::uint32_t corner) {
    while (waiting_.size() > 1) {
      const std::uint32_t a = waiting_[waiting_.size() - 2], b = waiting_.back();
      const Vec2d &p = points_[a], &q = points_[b], &r = points_[corner];
      const int turn = orientation(p, q, r);
      if ((forward_ ? turn : -turn) <= 0) break;
      if (std::abs(twice_area(p, q, r)) <= least_area(p, q, r, height_)) break;
      add(a, b, corner);
      waiting_.pop_back();
    }
    waiting_.push_back(corner);
  }

  // Joins all that wait with a corner of the other chain.
  void add_across(const Place& place) {
    for (std::size_t k = 1; k < waiting_.size(); ++k)
      add(waiting_[k - 1], waiting_[k], place.corner);
    waiting_ = {waiting_.back(), place.corner};
    forward_ = place.forward;
  }

  const std::vector<Vec2d>& points_;
  double height_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::vector<Place> order_;
  std::vector<std::uint32_t> waiting_;  // corners of one chain, whose triangles are not known yet
  bool forward_ = true;                 // the chain of waiting_
};

bool inside(Vec2d a, Vec2d b, Vec2d c, Vec2d p) {
  return orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0;
}

// Sorts points into square cells, about one point in each, so that a triangle meets few of them.
class PointGrid {
 public:
  // Takes the points that `members` lists.
  PointGrid(const std::vector<Vec2d>& points, const std::vector<std::uint32_t>& members) {
    low_ = points[members[0]];
    Vec2d high = low_;
    for (const std::uint32_t i : members) {
      low_ = {std::min(low_.x, points[i].x), std::min(low_.y, points[i].y)};
      high = {std::max(high.x, points[i].x), std::max(high.y, points[i].y)};
    }
    const double width = high.x - low_.x, height = high.y - low_.y;
    side_ = std::max(std::sqrt(width * height / double(members.size())),
                     std::max(width, height) / double(members.size()));
    columns_ = cell(width) + 1;
    members_.resize(members.size());
    first_ = counting_sort(
        members.size(), columns_ * (cell(height) + 1),
        [&](std::size_t i) { return at(points[members[i]]); },
        [&](std::size_t i, std::uint32_t at) { members_[at] = members[i]; });
  }

  // Returns whether `blocks(i)` holds for a point i in the cells that the triangle's bounding box
  // meets, except the cells left and right of the triangle in each row.
  template <class Blocks>
  bool any(const std::array<Vec2d, 3>& t, Blocks&& blocks) const {
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (std::size_t row = cell(low - low_.y); row <= cell(high - low_.y); ++row) {
      const auto [from, to] = columns_in(row, t);
      const std::uint32_t end = first_[row * columns_ + to + 1];
      for (std::uint32_t k = first_[row * columns_ + from]; k < end; ++k)
        if (blocks(members_[k])) return true;
    }
    return false;
  }

 private:
  std::size_t cell(double distance) const {
    const double c = distance / side_;
    return c > 0 ? std::size_t(std::min(c, double(kMaxConcave))) : 0;  // 0 / 0 gives 0, too
  }
  std::size_t at(Vec2d p) const { return cell(p.y - low_.y) * columns_ + cell(p.x - low_.x); }

  // Returns the columns that the triangle meets in a row of cells, with a small margin for
  // rounding.
  std::pair<std::size_t, std::size_t> columns_in(std::size_t row,
                                                 const std::array<Vec2d, 3>& t) const {
    const double bottom = low_.y + (double(row) - 0.01) * side_, top = bottom + 1.02 * side_;
    double from = HUGE_VAL, to = -HUGE_VAL;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d p = t[k], q = t[(k + 1) % 3];
      if (std::max(p.y, q.y) < bottom || std::min(p.y, q.y) > top) continue;
      for (const Vec2d end : {p, q}) {
        const double y = std::clamp(end.y, bottom, top);
        const double x = y == end.y ? end.x : p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x);
        from = std::min(from, x);
        to = std::max(to, x);
      }
    }
    if (!(from <= to)) return {0, columns_ - 1};
    const std::size_t left = cell(from - low_.x), right = cell(to - low_.x) + 1;
    return {left > 0 ? left - 1 : 0, std::min(right, columns_ - 1)};
  }

  Vec2d low_;
  double side_ = 0;
  std::size_t columns_ = 1;
  std::vector<std::uint32_t> first_, members_;  // cell c has members_[first_[c]..first_[c + 1])
};

// Clips ears: corners of a ring whose triangle contains no other corner. A corner that is no ear
// stays one as long as its neighbours stay, except in outlines that cross themselves. Therefore all
// corners are tried again when no candidate is left.
class EarClipper {
 public:
  EarClipper(const std::vector<Vec2d>& points, std::vector<std::array<std::uint32_t, 3>>& triangles,
             std::uint64_t tests)
      : points_(points), triangles_(triangles), size_(std::uint32_t(points.size())), tests_(tests) {
    for (std::uint32_t i = 0; i < size_; ++i) {
      before_.push_back((i + size_ - 1) % size_);
      after_.push_back((i + 1) % size_);
    }
    alive_.assign(size_, true);
    look_over();
    index();
  }

  // Returns false, with unusable triangles, if that takes more tests of points than allowed.
  bool run() {
    std::uint32_t start = 1;  // continuing after the last ear avoids long slivers at one corner
    while (size_ > 3) {
      if (tests_ == 0) return false;
      std::uint32_t ear = find_ear(start);
      if (ear == kNoIndex && clipped_ && again_ > 0) {
        --again_;
        look_over();
        ear = find_ear(start);
      }
      start = clip(ear == kNoIndex ? start : ear);
      if (2 * size_ < indexed_) index();
    }
    const std::uint32_t first =
        std::uint32_t(std::find(alive_.begin(), alive_.end(), true) - alive_.begin());
    triangles_.push_back({first, after_[first], after_[after_[first]]});
    return true;
  }

 private:
  // Returns the first ear around the ring from `start` on, or kNoIndex.
  std::uint32_t find_ear(std::uint32_t start) {
    for (const auto& [from, to] : {std::pair(start, std::uint32_t(points_.size())), {0u, start}}) {
      for (std::uint32_t i = next_candidate(from, to); i < to && tests_ > 0;
           i = next_candidate(i, to)) {
        candidate_[i / 64] &= ~(std::uint64_t{1} << i % 64);
        if (is_ear(i)) return i;
      }
    }
    return kNoIndex;
  }

  std::uint32_t next_candidate(std::uint32_t from, std::uint32_t to) const {
    while (from < to) {
      const std::uint64_t rest = candidate_[from / 64] >> from % 64;
      if (rest != 0) return std::min(to, from + std::uint32_t(std::countr_zero(rest)));
      from = (from / 64 + 1) * 64;
    }
    return to;
  }

  bool is_ear(std::uint32_t i) {
    const Vec2d a = points_[before_[i]], b = points_[i], c = points_[after_[i]];
    tests_ -= tests_ > 0;
    if (orientation(a, b, c) <= 0) return false;
    const auto blocks = [&](std::uint32_t k) {
      const Vec2d p = points_[k];
      tests_ -= tests_ > 0;
      return alive_[k] && p != a && p != b && p != c && inside(a, b, c, p);
    };
    if (grid_) return !grid_->any({a, b, c}, blocks);
    for (std::uint32_t k = after_[after_[i]]; k != before_[i]; k = after_[k])
      if (blocks(k)) return false;
    return true;
  }

  // Returns where to look for the next ear.
  std::uint32_t clip(std::uint32_t i) {
    const std::uint32_t a = before_[i], c = after_[i];
    triangles_.push_back({a, i, c});
    after_[a] = c;
    before_[c] = a;
    alive_[i] = false;
    candidate_[i / 64] &= ~(std::uint64_t{1} << i % 64);
    for (const std::uint32_t k : {a, c}) candidate_[k / 64] |= std::uint64_t{1} << k % 64;
    --size_;
    clipped_ = true;
    return after_[c];
  }

  void look_over() {
    candidate_.assign(points_.size() / 64 + 1, 0);
    for (std::uint32_t i = 0; i < points_.size(); ++i)
      if (alive_[i]) candidate_[i / 64] |= std::uint64_t{1} << i % 64;
    clipped_ = false;
  }

  // Puts the remaining corners into a grid; a few corners are tested faster one by one.
  void index() {
    constexpr std::uint32_t kFew = 32;
    indexed_ = size_;
    grid_.reset();
    if (size_ <= kFew) return;
    std::vector<std::uint32_t> ring;
    for (std::uint32_t i = 0; i < points_.size(); ++i)
      if (alive_[i]) ring.push_back(i);
    grid_.emplace(points_, ring);
  }

  const std::vector<Vec2d>& points_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
  std::uint32_t size_, indexed_ = 0;
  std::uint64_t tests_;  // of points that are left
  std::vector<std::uint32_t> before_, after_;
  std::vector<bool> alive_;
  std::vector<std::uint64_t> candidate_;  // 1 bit per corner: whether it may be an ear
  std::optional<PointGrid> grid_;
  bool clipped_ = false;  // since the last look_over()
  int again_ = 200;  // further calls of look_over(): enough for outlines of hundreds of corners
};

}  // namespace

bool triangulate(std::span<const Vec3d> corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles, bool limited) {
  triangles.clear();
  const auto n = static_cast<std::uint32_t>(corners.size());
  if (n == 3) {
    triangles.push_back({0, 1, 2});
    return true;
  }
  const std::vector<Vec2d> flat = project(corners);
  double largest = 0;
  for (const Vec3d& p : corners)
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double height = kStraightness * largest;
  const bool round = convex(flat, height);
  if (!round || !fans_out(flat, height)) {
    if (round && Sweep(flat, height, triangles).run()) return true;
    triangles.clear();
    const std::uint64_t tests =
        limited ? kMostTests * n : std::numeric_limits<std::uint64_t>::max();
    if ((n <= kMaxConcave || !limited) && EarClipper(flat, triangles, tests).run()) return true;
    triangles.clear();
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
  return round;
}

void PolygonCorners::add(std::size_t corners, std::span<const std::array<std::uint32_t, 3>> added) {
  if (first.empty()) first.push_back(0);
  const std::uint32_t begin = first.back();
  for (const auto& t : added) {
    polygon.push_back(std::uint32_t(count()));
    for (const std::uint32_t c : t) triangles.push_back(begin + c);
  }
  first.push_back(begin + std::uint32_t(corners));
}

std::uint32_t side_of(const PolygonCorners& polygons, std::uint32_t h) {
  const std::uint32_t from = polygons.triangles[h], to = polygons.triangles[next_half_edge(h)],
                      polygon = polygons.polygon[h / 3];
  const std::uint32_t first = polygons.first[polygon], end = polygons.first[polygon + 1];
  return to == (from + 1 == end ? first : from + 1) ? from : kNoIndex;
}

bool goes_round_and_round(std::span<const std::int64_t> vertices) {
  constexpr std::size_t kFew = 64, kMostPasses = 6;
  if (vertices.size() <= kFew) return false;
  std::vector<std::int64_t> sorted(vertices.begin(), vertices.end());
  std::sort(sorted.begin(), sorted.end());
  const auto different = std::unique(sorted.begin(), sorted.end()) - sorted.begin();
  return vertices.size() > kMostPasses * std::size_t(different);
}

}  // namespace atlas

#include "libatlas/charts/filling/chords.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "libatlas/core/hull.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

constexpr std::size_t kMostCorners = 100;  // of the simplified outline
// Further chord ends are 1 / kSpacing of the perimeter apart.
constexpr int kSpacing = 96;
// Simplification moves the outline by at most this share of its width.
constexpr double kFineness = 0.006;
// Edges from a corner that are considered as chords.
constexpr std::ptrdiff_t kMostEdges = 3;
// Share of the width that is added to the lengths of cuts in their scores.
constexpr double kShortSeam = 0.05;

// Chooses corners of the outline, then chords between them.
class ChordFinder {
 public:
  ChordFinder(std::span<const Vec2d> outline, std::span<const std::array<std::uint32_t, 2>> edges)
      : outline_(outline) {
    double twice = 0;
    for (std::size_t i = 2; i < outline.size(); ++i) {
      twice += cross(outline[0], outline[i - 1], outline[i]);
    }
    width_ = std::sqrt(std::max(0.0, 0.5 * twice));
    for (const auto& [a, b] : edges) {
      const double length = distance(outline[a], outline[b]);
      edges_.push_back({a, b, length});
      edges_.push_back({b, a, length});
    }
    sort_total(edges_.begin(), edges_.end(), [](const Edge& e, const Edge& f) {
      return e.from != f.from       ? e.from < f.from
             : e.length != f.length ? e.length < f.length
                                    : e.to < f.to;
    });
  }

  std::vector<Chord> run(double least, const Context& context) {
    std::vector<Chord> chords;
    if (outline_.size() < 4 || !(width_ > 0)) return chords;
    choose_corners();
    sort_corners();
    const double hull = hull_of(0, std::uint32_t(corners_.size()), sides_[0]);
    whole_ = sprawl(hull, box_area(sides_[0].hull));
    for (std::uint32_t i = 0; i < corners_.size() && !context.cancelled(); ++i) {
      if (concave_[i]) add_chords(i, least, chords);
    }
    std::stable_sort(chords.begin(), chords.end(),
                     [](const Chord& a, const Chord& b) { return a.score > b.score; });
    return chords;
  }

 private:
  struct Edge {
    std::uint32_t from, to;  // indices into the outline
    double length;
  };

  const Vec2d& corner(std::uint32_t i) const { return outline_[corners_[i % corners_.size()]]; }

  struct Side {
    std::vector<Vec2d> points, hull;
  };

  // Computes the hull of the corners from `first` to `last`, both included. Returns its area.
  double hull_of(std::uint32_t first, std::uint32_t last, Side& side) const {
    const auto n = std::uint32_t(corners_.size());
    side.points.clear();
    for (const std::uint32_t k : by_x_) {
      const std::uint32_t since = k >= first ? k - first : k + n - first;
      if (since <= last - first) side.points.push_back(corner(k));
    }
    return sorted_hull_area(side.points, side.hull);
  }

  void sort_corners() {
    by_x_.resize(corners_.size());
    std::iota(by_x_.begin(), by_x_.end(), 0);
    sort_total(by_x_.begin(), by_x_.end(), [&](std::uint32_t i, std::uint32_t j) {
      const Vec2d &a = corner(i), &b = corner(j);
      return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : i < j;
    });
  }

  // Returns the shortest edges that start at a place of the outline.
  std::span<const Edge> edges_from(std::uint32_t place) const {
    const auto less = [](const Edge& e, std::uint32_t p) { return e.from < p; };
    const auto first = std::lower_bound(edges_.begin(), edges_.end(), place, less);
    auto last = first;
    while (last != edges_.end() && last->from == place && last - first < kMostEdges) ++last;
    return std::span(edges_).subspan(std::size_t(first - edges_.begin()),
                                     std::size_t(last - first));
  }

  // Chooses the corners of the simplified outline, and others between them, so that a chord can end
  // on a straight side or at the far end of an edge.
  void choose_corners() {
    const std::vector<std::uint32_t> simple = simplified();
    std::vector<std::uint8_t> at_edge(outline_.size(), 0);
    double perimeter = 0;
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      perimeter += distance(outline_[i], outline_[(i + 1) % outline_.size()]);
    }
    const double spacing = perimeter / kSpacing;
    const std::size_t n = simple.size();
    std::vector<std::uint8_t> concave(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2d &a = outline_[simple[(i + n - 1) % n]], &b = outline_[simple[i]],
                  &c = outline_[simple[(i + 1) % n]];
      concave[i] = cross(a, b, c) < 0;
      if (!concave[i]) continue;
      for (const Edge& edge : edges_from(simple[i])) at_edge[edge.to] = 1;
    }
    for (std::size_t i = 0; i < n; ++i) {
      corners_.push_back(simple[i]);
      concave_.push_back(concave[i]);
      const std::uint32_t end = i + 1 < n ? simple[i + 1] : std::uint32_t(outline_.size());
      double since = 0;
      for (std::uint32_t k = simple[i] + 1; k < end; ++k) {
        since += distance(outline_[k - 1], outline_[k]);
        if (since < spacing && !at_edge[k]) continue;
        since = 0;
        corners_.push_back(k);
        concave_.push_back(0);
      }
    }
  }

  // A part of the outline, and the index in it that is farthest from the line between its ends.
  struct Part {
    std::uint32_t first, last, worst = 0;
    double distance = 0;  // squared
    bool operator<(const Part& other) const {
      return distance != other.distance ? distance < other.distance : first > other.first;
    }
  };
  Part part(std::uint32_t first, std::uint32_t last) const {
    Part part{first, last};
    for (std::uint32_t i = first + 1; i < last; ++i) {
      const double d = squared_distance_to_segment(outline_[i], outline_[first],
                                                   outline_[last % outline_.size()]);
      if (d <= part.distance) continue;
      part.distance = d;
      part.worst = i;
    }
    return part;
  }

  // Returns the indices that Douglas and Peucker's method chooses, ascending, starting from two
  // indices far apart. Those that matter most are chosen first, since their number is limited.
  std::vector<std::uint32_t> simplified() const {
    const auto n = std::uint32_t(outline_.size());
    std::uint32_t far = 0;
    for (std::uint32_t i = 1; i < n; ++i) {
      if (distance(outline_[0], outline_[i]) > distance(outline_[0], outline_[far])) far = i;
    }
    std::vector<std::uint32_t> places{0, far};
    std::priority_queue<Part> open;
    open.push(part(0, far));
    open.push(part(far, n));
    const double least = kFineness * width_ * kFineness * width_;
    while (places.size() < kMostCorners && open.top().distance > least) {
      const Part cut = open.top();
      open.pop();
      places.push_back(cut.worst);
      open.push(part(cut.first, cut.worst));
      open.push(part(cut.worst, cut.last));
    }
    std::sort(places.begin(), places.end());
    return places;
  }

  void add_chords(std::uint32_t i, double least, std::vector<Chord>& chords) {
    const auto n = std::uint32_t(corners_.size());
    std::vector<double> length(n);
    for (std::uint32_t j = 0; j < n; ++j) length[j] = distance(corner(i), corner(j));
    for (std::uint32_t step = 2; step + 1 < n; ++step) {
      const std::uint32_t j = (i + step) % n;
      const bool nearest = length[j] <= length[(j + 1) % n] && length[j] <= length[(j + n - 1) % n];
      const bool wanted = nearest || concave_[j] || at_edge_of(i, j);
      if (!wanted || (concave_[j] && j < i) || !visible(i, j)) continue;
      const double one = hull_of(i, i + step, sides_[0]),
                   other = hull_of(j, j + n - step, sides_[1]);
      if (whole_ - one - other < least) continue;  // no rectangle is smaller than the hull
      const double fall =
          whole_ - sprawl(one, box_area(sides_[0].hull)) - sprawl(other, box_area(sides_[1].hull));
      if (fall < least) continue;
      chords.push_back({corners_[i], corners_[j], fall / (length[j] + kShortSeam * width_)});
    }
  }

  bool at_edge_of(std::uint32_t i, std::uint32_t j) const {
    const std::span<const Edge> edges = edges_from(corners_[i]);
    return std::any_of(edges.begin(), edges.end(),
                       [&](const Edge& edge) { return edge.to == corners_[j]; });
  }

  // Whether the chord lies inside the outline.
  bool visible(std::uint32_t i, std::uint32_t j) const {
    const auto n = std::uint32_t(corners_.size());
    const Vec2d &a = corner(i), &b = corner(j);
    const Vec2d &before = corner(i + n - 1), &after = corner(i + 1);
    // Corner i is concave, so b lies to the left of at least one of its sides.
    if (cross(before, a, b) <= 0 && cross(a, after, b) <= 0) return false;
    // Among teeth, the sides near an end are the ones that hide the other.
    for (std::uint32_t step = 1; step + 1 < n; ++step) {
      const std::uint32_t k = (i + (step % 2 ? step / 2 + 1 : n - step / 2 - 1)) % n;
      if (k == j || (k + 1) % n == j) continue;
      if (cross_each_other(a, b, corner(k), corner(k + 1))) return false;
    }
    const Vec2d middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
    bool inside = false;
    for (std::uint32_t k = 0; k < n; ++k) {
      const Vec2d &p = corner(k), &q = corner(k + 1);
      if ((p.y <= middle.y) != (q.y <= middle.y) && (cross(p, q, middle) > 0) == (q.y > p.y)) {
        inside = !inside;
      }
    }
    return inside;
  }

  std::span<const Vec2d> outline_;
  std::vector<Edge> edges_;  // sorted by start, then by length
  double width_ = 0, whole_ = 0;
  std::vector<std::uint32_t> corners_;  // indices into the outline, ascending
  std::vector<std::uint8_t> concave_;   // one per corner
  std::vector<std::uint32_t> by_x_;     // corners
  Side sides_[2];                       // of a chord
};

}  // namespace

std::vector<Chord> find_chords(std::span<const Vec2d> outline,
                               std::span<const std::array<std::uint32_t, 2>> edges, double least,
                               const Context& context) {
  return ChordFinder(outline, edges).run(least, context);
}

}  // namespace atlas

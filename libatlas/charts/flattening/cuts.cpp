#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <unordered_set>

#include "libatlas/charts/cells/tips.h"
#include "libatlas/charts/flattening/split.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

// A fully folded edge counts 1 / (1 + kCreaseDiscount) of its length as part of a cut.
constexpr double kCreaseDiscount = 4;
// Angle defects below this (radians) do not stretch a chart beyond its bound.
constexpr double kLeastDefect = 0.02;
// Defects are rounded to multiples of this (radians): the tips of symmetric charts are equal but
// for rounding, which must not choose between them.
constexpr double kSameDefect = 1e-4;
// Lengths are rounded to multiples of this share of a triangle's mean width, so that rounding does
// not choose between ways that mirror each other either.
constexpr double kLengthStep = 1e-3;
// The most edges of a dart: what a tip needs is room beside it.
constexpr std::size_t kLongestDart = 12;
// Edges that were cut in vain count this many times their length.
constexpr double kDetour = 4;
constexpr double kPolygonDetour = 1e4;  // so many times if they lie inside a polygon
constexpr double kFreeShare = 0.001;    // share of the area that the bound does not apply to
constexpr double kFar = std::numeric_limits<double>::max();

std::uint32_t whole_half_edge(const LocalChart& chart, std::uint32_t h) {
  return 3 * chart.triangles()[h / 3] + h % 3;
}

// Returns the edge's number in Darts.
std::uint32_t dart_edge(const LocalChart& chart, std::uint32_t h) {
  return std::min(whole_half_edge(chart, h), whole_half_edge(chart, chart.opposite[h]));
}

// Shortest paths along a chart's inner edges, between vertices.
class EdgePaths {
  using Visit = std::pair<double, std::uint32_t>;

 public:
  EdgePaths(const Topology& topology, const LocalChart& chart,
            const std::unordered_set<std::uint32_t>* avoid = nullptr)
      : topology_(topology),
        chart_(chart),
        avoid_(avoid && !avoid->empty() ? avoid : nullptr),
        out_(chart.positions.size(), kNoIndex) {
    double area = 0;
    for (const std::uint32_t t : chart.triangles()) area += topology.areas[t];
    step_ = kLengthStep * std::sqrt(area / static_cast<double>(chart.triangles().size()));
    for (std::uint32_t h = 0; h < chart.opposite.size(); ++h) {
      if (out_[from(h)] == kNoIndex || chart.opposite[h] == kNoIndex) out_[from(h)] = h;
    }
  }

  std::uint32_t from(std::uint32_t h) const { return chart_.corners[h / 3][h % 3]; }
  bool on_border(std::uint32_t v) const { return chart_.opposite[out_[v]] == kNoIndex; }

  // Returns the angle defect of an inner vertex: 2 pi minus the angles around it.
  double defect(std::uint32_t v) const {
    double sum = 2 * std::numbers::pi;
    std::uint32_t h = out_[v];
    do {
      const glm::dvec3 p = point(from(h)), a = point(from(next_half_edge(h))) - p,
                       b = point(from(previous_half_edge(h))) - p;
      sum -= portable::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
      h = chart_.opposite[previous_half_edge(h)];
    } while (h != kNoIndex && h != out_[v]);
    return sum;
  }

  template <class Body>
  void each_neighbour(std::uint32_t v, Body&& body) const {
    std::uint32_t h = out_[v];
    do {
      body(from(next_half_edge(h)));
      body(from(previous_half_edge(h)));
      h = chart_.opposite[previous_half_edge(h)];
    } while (h != kNoIndex && h != out_[v]);
  }

  // Discards all paths.
  void clear() {
    distance_.assign(chart_.positions.size(), kFar);
    through_.assign(chart_.positions.size(), kNoIndex);
    heap_ = {};
  }

  // Lets paths start at v.
  void start_at(std::uint32_t v) {
    distance_[v] = 0;
    through_[v] = kNoIndex;
    heap_.push({0, v});
  }

  // Spreads until it reaches a vertex that is wanted, and returns it; kNoIndex if there is none.
  // Each call continues where the last one ended. Paths do not pass through wanted vertices, unless
  // they start there.
  template <class Wanted>
  std::uint32_t spread_to(Wanted&& wanted) {
    while (!heap_.empty()) {
      const double so_far = heap_.top().first;
      const std::uint32_t v = heap_.top().second;
      heap_.pop();
      if (so_far > distance_[v]) continue;
      if (wanted(v)) return v;
      each_inner_edge(v, [&](std::uint32_t h) {
        const std::uint32_t to = from(next_half_edge(h));
        const double next = so_far + length(h);
        if (next >= distance_[to]) return;
        distance_[to] = next;
        through_[to] = h;
        heap_.push({next, to});
      });
    }
    return kNoIndex;
  }

  // Returns the half-edges from v back to the start of its path. Later paths may start anywhere on
  // it.
  std::vector<std::uint32_t> take_path(std::uint32_t v) {
    std::vector<std::uint32_t> path;
    for (std::uint32_t w = v; through_[w] != kNoIndex; w = from(through_[w])) {
      path.push_back(through_[w]);
    }
    start_at(v);
    for (const std::uint32_t h : path) start_at(from(h));
    return path;
  }

  // Computes distances to the border, for way_out().
  void spread_from_border() {
    clear();
    for (std::uint32_t v = 0; v < distance_.size(); ++v) {
      if (on_border(v)) start_at(v);
    }
    spread();
  }
  double distance(std::uint32_t v) const { return distance_[v]; }

  // Returns the half-edges from v to the nearest point of the border or of an earlier way out.
  // Later ways may end on this one.
  std::vector<std::uint32_t> way_out(std::uint32_t v) {
    if (distance_[v] == kFar) return {};
    std::vector<std::uint32_t> path = take_path(v);
    spread();
    return path;
  }

 private:
  void spread() {
    spread_to([](std::uint32_t) { return false; });
  }

  glm::dvec3 point(std::uint32_t v) const { return to_glm(chart_.positions[v]); }

  bool avoided(std::uint32_t h) const {
    if (!avoid_) return false;
    return avoid_->contains(dart_edge(chart_, h));
  }

  // In multiples of step_.
  double length(std::uint32_t h) const {
    const std::uint32_t s = chart_.triangles()[h / 3],
                        t = chart_.triangles()[chart_.opposite[h] / 3];
    const bool inner = topology_.inner(whole_half_edge(chart_, h));
    const double fold =
        0.5 * (1 - glm::dot(to_dvec(topology_.normals[s]), to_dvec(topology_.normals[t])));
    const double plain = glm::distance(point(from(h)), point(from(next_half_edge(h)))) /
                         (1 + kCreaseDiscount * fold);
    const double detour = topology_.seam_weight(whole_half_edge(chart_, h)) *
                          (inner ? kPolygonDetour : 1) * (avoided(h) ? kDetour : 1);
    return std::round(detour * plain / step_);
  }

  // Visits the inner edges at v. Starting from a border half-edge, the walk meets each of them
  // once.
  template <class Body>
  void each_inner_edge(std::uint32_t v, Body&& body) const {
    std::uint32_t h = out_[v];
    do {
      if (chart_.opposite[h] != kNoIndex) body(h);
      h = chart_.opposite[previous_half_edge(h)];
    } while (h != kNoIndex && h != out_[v]);
  }

  const Topology& topology_;
  const LocalChart& chart_;
  const std::unordered_set<std::uint32_t>* avoid_;
  double step_ = 0;                 // in scaled units
  std::vector<std::uint32_t> out_;  // a half-edge from each vertex, the boundary one if any
  std::vector<double> distance_;
  std::vector<std::uint32_t> through_;  // the half-edge by which a vertex is reached
  std::priority_queue<Visit, std::vector<Visit>, std::greater<>> heap_;
};

void mark_seams(const LocalChart& chart, const std::vector<std::uint32_t>& path,
                Partition& partition) {
  for (const std::uint32_t h : path) {
    partition.cut(whole_half_edge(chart, h));
    partition.cut(whole_half_edge(chart, chart.opposite[h]));
  }
}

}  // namespace

bool join_loops(const Topology& topology, const LocalChart& chart,
                std::span<const std::uint32_t> wanted, Partition& partition) {
  EdgePaths paths(topology, chart);
  paths.clear();
  std::vector<std::uint32_t> loop_at(chart.positions.size(), kNoIndex);  // the loop at a vertex, if
                                                                         // not joined yet
  const auto each_vertex = [&](std::uint32_t loop, auto&& body) {
    std::uint32_t h = loop;
    do {
      body(paths.from(h));
      h = chart.next_border(h);
    } while (h != loop);
  };
  for (const std::uint32_t loop : chart.loops) {
    each_vertex(loop, [&](std::uint32_t v) { loop_at[v] = loop; });
  }
  const std::unordered_set<std::uint32_t> wanted_loops(wanted.begin(), wanted.end());
  std::size_t missing = wanted.size();
  const auto join = [&](std::uint32_t loop) {
    missing -= wanted_loops.count(loop);
    each_vertex(loop, [&](std::uint32_t v) {
      loop_at[v] = kNoIndex;
      paths.start_at(v);
    });
  };
  if (!chart.loops.empty()) join(chart.loops[0]);
  for (bool any = false;; any = true) {
    if (any && missing == 0) return true;
    const std::uint32_t end =
        paths.spread_to([&](std::uint32_t v) { return loop_at[v] != kNoIndex; });
    if (end == kNoIndex) return any;
    mark_seams(chart, paths.take_path(end), partition);
    join(loop_at[end]);
  }
}

namespace {

// Chooses the vertices that cuts should lead to: the vertex of the offenders with the largest angle
// defect, and further sharp ones until the offenders around them make up for the excess area.
std::vector<std::uint32_t> choose_tips(const Topology& topology, const LocalChart& chart,
                                       std::span<const std::uint32_t> offenders,
                                       const EdgePaths& paths) {
  double excess = 0;
  for (const std::uint32_t t : chart.triangles()) excess -= kFreeShare * topology.areas[t];
  const auto area = [&](std::uint32_t t) { return topology.areas[chart.triangles()[t]]; };
  for (const std::uint32_t t : offenders) excess += area(t);
  struct Tip {
    double defect;  // rounded to a multiple of kSameDefect
    std::uint32_t vertex;
  };
  std::vector<Tip> tips;
  std::vector<double> around(chart.positions.size(), 0);  // area of the offenders at each vertex
  for (const std::uint32_t t : offenders) {
    for (const std::uint32_t v : chart.corners[t]) {
      if (paths.on_border(v)) continue;
      if (around[v] == 0) {
        tips.push_back({kSameDefect * std::round(paths.defect(v) / kSameDefect), v});
      }
      around[v] += area(t);
    }
  }
  sort_total(tips.begin(), tips.end(), [](const Tip& a, const Tip& b) {
    return a.defect != b.defect ? a.defect > b.defect : a.vertex < b.vertex;
  });
  std::vector<std::uint32_t> chosen;
  std::vector<std::uint8_t> taken(chart.positions.size(), 0);
  for (const Tip& tip : tips) {
    if (tip.defect < (chosen.empty() ? kLeastDefect : kSharpDefect) || excess <= 0) break;
    if (taken[tip.vertex]) continue;
    chosen.push_back(tip.vertex);
    excess -= around[tip.vertex];
    paths.each_neighbour(tip.vertex, [&](std::uint32_t v) { taken[v] = 1; });
  }
  return chosen;
}

}  // namespace

bool Darts::cut_to_border(const Topology& topology, const LocalChart& chart,
                          std::span<const std::uint32_t> offenders, Partition& partition) {
  EdgePaths paths(topology, chart, &closed);
  std::vector<std::uint32_t> tips = choose_tips(topology, chart, offenders, paths);
  if (tips.empty()) return false;
  paths.spread_from_border();
  bool any = false;
  // The nearest tip comes first; later cuts may end on its cut.
  while (!tips.empty()) {
    const auto nearest =
        std::min_element(tips.begin(), tips.end(), [&](std::uint32_t a, std::uint32_t b) {
          return paths.distance(a) != paths.distance(b) ? paths.distance(a) < paths.distance(b)
                                                        : a < b;
        });
    std::vector<std::uint32_t> path = paths.way_out(*nearest);
    tips.erase(nearest);
    if (path.size() > kLongestDart) path.resize(kLongestDart);
    for (const std::uint32_t h : path) cut.insert(dart_edge(chart, h));
    mark_seams(chart, path, partition);
    any = any || !path.empty();
  }
  return any;
}

}  // namespace atlas

#include "libatlas/charts/tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/distortion.h"

namespace atlas {
namespace {

using Triangles = std::vector<std::uint32_t>;

struct Span1 {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  double length() const { return high - low; }
};

// An edge between two uvs of the set, a < b, and what it belongs to.
struct UvEdge {
  std::uint32_t a, b, owner;
  bool same_place(const UvEdge& e) const { return a == e.a && b == e.b; }
  bool operator<(const UvEdge& e) const {
    return std::tie(a, b, owner) < std::tie(e.a, e.b, e.owner);
  }
};

void add_edges(const ChartSet& set, std::uint32_t t, std::uint32_t owner,
               std::vector<UvEdge>& edges) {
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t a = set.triangle_uv[3 * std::size_t(t) + k];
    const std::uint32_t b = set.triangle_uv[3 * std::size_t(t) + (k + 1) % 3];
    edges.push_back({std::min(a, b), std::max(a, b), owner});
  }
}

// Splits triangles into the sets that hang together by edges: in the order of their first triangle,
// each in the order given. A cut may leave islands on either side, which are charts of their own.
std::vector<Triangles> connected(const ChartSet& set, const Triangles& triangles) {
  DisjointSets joined(triangles.size());
  std::vector<UvEdge> edges;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) add_edges(set, triangles[i], i, edges);
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i - 1].same_place(edges[i])) joined.join(edges[i - 1].owner, edges[i].owner);
  }
  std::vector<Triangles> sets;
  std::vector<std::uint32_t> set_of(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (joined.find(i) == i) {
      set_of[i] = std::uint32_t(sets.size());
      sets.emplace_back();
    }
    sets[set_of[joined.find(i)]].push_back(triangles[i]);
  }
  return sets;
}

// The chart set being cut, seen along either axis of the uv plane.
class Cutter {
 public:
  explicit Cutter(const ChartSet& set) : set_(set) {}

  // Appends the pieces of `triangles` to `pieces`.
  void cut(Triangles triangles, double limit, std::vector<Triangles>& pieces) const {
    const Span1 u = extent(triangles, 0), v = extent(triangles, 1);
    const int axis = u.length() >= v.length() ? 0 : 1;
    const Span1 along = axis == 0 ? u : v;
    if (along.length() <= limit || triangles.size() < 2) {
      pieces.push_back(std::move(triangles));
      return;
    }
    const double at = best_cut(triangles, axis, along, limit);
    const auto middle =
        std::stable_partition(triangles.begin(), triangles.end(),
                              [&](std::uint32_t t) { return centroid(t, axis) < at; });
    if (middle == triangles.begin() || middle == triangles.end()) {
      pieces.push_back(std::move(triangles));  // no cut separates these triangles
      return;
    }
    for (const bool right : {false, true}) {
      const Triangles side(right ? middle : triangles.begin(), right ? triangles.end() : middle);
      for (Triangles& island : connected(set_, side)) cut(std::move(island), limit, pieces);
    }
  }

 private:
  double coordinate(std::uint32_t t, int corner, int axis) const {
    const Vec2d p = set_.uvs[set_.triangle_uv[3 * std::size_t(t) + corner]];
    return axis == 0 ? p.x : p.y;
  }
  Span1 extent(std::uint32_t t, int axis) const {
    Span1 span;
    for (int k = 0; k < 3; ++k) span.add(coordinate(t, k, axis));
    return span;
  }
  Span1 extent(const Triangles& triangles, int axis) const {
    Span1 span;
    for (const std::uint32_t t : triangles)
      for (int k = 0; k < 3; ++k) span.add(coordinate(t, k, axis));
    return span;
  }
  double centroid(std::uint32_t t, int axis) const {
    return (coordinate(t, 0, axis) + coordinate(t, 1, axis) + coordinate(t, 2, axis)) / 3;
  }

  // Of kBins positions around the even share, the one that crosses the least length of triangles;
  // of equal ones the nearest to it. Each bin stands for the corner in it nearest to its middle.
  double best_cut(const Triangles& triangles, int axis, Span1 along, double limit) const {
    constexpr int kBins = 256;
    constexpr double kFreedom = 0.25;  // of the piece's length, to either side
    const double parts = std::ceil(along.length() / limit);
    const double ideal = along.low + along.length() * std::ceil(parts / 2) / parts;
    const double reach = kFreedom * along.length() / parts;
    const double first = ideal - reach, width = 2 * reach / kBins;
    std::array<double, kBins> corner;
    corner.fill(std::numeric_limits<double>::quiet_NaN());
    const auto bin_of = [&](double v) { return int(std::floor((v - first) / width)); };
    for (const std::uint32_t t : triangles)
      for (int k = 0; k < 3; ++k) {
        const double v = coordinate(t, k, axis);
        const int bin = bin_of(v);
        if (bin >= 0 && bin < kBins && !(corner[bin] <= v)) corner[bin] = v;
      }
    std::array<std::uint64_t, kBins> crossed{};
    const double slack = 1e-9 * along.length();  // a triangle that only touches is not crossed
    for (const std::uint32_t t : triangles) {
      const Span1 span = extent(t, axis);
      const int last = std::min(kBins - 1, bin_of(span.high));
      for (int bin = std::max(0, bin_of(span.low)); bin <= last; ++bin)
        crossed[bin] += corner[bin] > span.low + slack && corner[bin] < span.high - slack;
    }
    double best = ideal;
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (int bin = 0; bin < kBins; ++bin) {
      if (std::isnan(corner[bin])) continue;
      const bool nearer = std::fabs(corner[bin] - ideal) < std::fabs(best - ideal);
      if (crossed[bin] < least || (crossed[bin] == least && nearer)) {
        least = crossed[bin];
        best = corner[bin];
      }
    }
    return best;
  }

  const ChartSet& set_;
};

// Builds the new set piece by piece.
class Rebuilder {
 public:
  Rebuilder(const MeshView& mesh, const ChartSet& old) : mesh_(mesh), old_(old), fresh_(old) {
    fresh_.charts.clear();
    fresh_.chart_triangles.clear();
    fresh_.uvs.clear();
    fresh_.uv_vertex.clear();
    local_.assign(old.uvs.size(), kNone);
    opposite_.assign(old.triangle_chart.size(), 0);
    for (const std::uint32_t t : old.flipped_triangles) opposite_[t] = 1;
  }

  void add(const Chart& parent, const Triangles& triangles, bool whole) {
    Chart chart = parent;
    chart.first_triangle = std::uint32_t(fresh_.chart_triangles.size());
    chart.triangle_count = std::uint32_t(triangles.size());
    chart.first_uv = std::uint32_t(fresh_.uvs.size());
    for (const std::uint32_t t : triangles) {
      fresh_.chart_triangles.push_back(t);
      fresh_.triangle_chart[t] = std::uint32_t(fresh_.charts.size());
      for (int k = 0; k < 3; ++k) {
        std::uint32_t& local = local_[old_.triangle_uv[3 * std::size_t(t) + k]];
        if (local == kNone || local < chart.first_uv) {
          local = std::uint32_t(fresh_.uvs.size());
          fresh_.uvs.push_back(old_.uvs[old_.triangle_uv[3 * std::size_t(t) + k]]);
          fresh_.uv_vertex.push_back(old_.uv_vertex[old_.triangle_uv[3 * std::size_t(t) + k]]);
        }
        fresh_.triangle_uv[3 * std::size_t(t) + k] = local;
      }
    }
    chart.uv_count = std::uint32_t(fresh_.uvs.size()) - chart.first_uv;
    if (!whole) {
      lay_along_u(chart);
      measure(chart);
    }
    fresh_.charts.push_back(chart);
  }

  ChartSet take() { return std::move(fresh_); }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  void lay_along_u(Chart& chart) {
    const std::span<Vec2d> uvs = std::span(fresh_.uvs).subspan(chart.first_uv, chart.uv_count);
    Span1 u, v;
    for (const Vec2d& p : uvs) {
      u.add(p.x);
      v.add(p.y);
    }
    const bool turn = v.length() > u.length();
    for (Vec2d& p : uvs) {
      p = turn ? Vec2d{v.high - p.y, p.x - u.low} : Vec2d{p.x - u.low, p.y - v.low};
    }
    chart.size = {std::max(u.length(), v.length()), std::min(u.length(), v.length())};
  }

  void measure(Chart& chart) const {
    std::vector<Vec3d> positions(chart.uv_count);
    for (std::uint32_t i = 0; i < chart.uv_count; ++i) {
      const Vec3f p = mesh_.positions[fresh_.uv_vertex[chart.first_uv + i]];
      positions[i] = {p.x, p.y, p.z};
    }
    std::vector<std::array<std::uint32_t, 3>> triangles(chart.triangle_count);
    std::vector<double> density;
    for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
      const std::size_t t = fresh_.chart_triangles[chart.first_triangle + i];
      for (int k = 0; k < 3; ++k) triangles[i][k] = fresh_.triangle_uv[3 * t + k] - chart.first_uv;
      if (opposite_[t]) std::swap(triangles[i][1], triangles[i][2]);
      if (!mesh_.density.empty()) density.push_back(mesh_.density[t]);
    }
    const std::span<const Vec2d> uvs =
        std::span(fresh_.uvs).subspan(chart.first_uv, chart.uv_count);
    chart.distortion = measure_distortion({positions, triangles, density}, uvs);
  }

  const MeshView& mesh_;
  const ChartSet& old_;
  ChartSet fresh_;
  std::vector<std::uint32_t> local_;    // old uv -> new uv of the piece being built
  std::vector<std::uint8_t> opposite_;  // 1 a triangle: its orientation is not its chart's
};

// Length on the surface of the edges along which a chart was cut: uv edges of the old set whose two
// triangles went to different pieces.
double cut_length(const MeshView& mesh, const ChartSet& old, const std::vector<Triangles>& pieces) {
  std::vector<UvEdge> edges;
  for (std::uint32_t piece = 0; piece < pieces.size(); ++piece)
    for (const std::uint32_t t : pieces[piece]) add_edges(old, t, piece, edges);
  std::sort(edges.begin(), edges.end());
  double length = 0;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const UvEdge &l = edges[i - 1], &r = edges[i];
    if (!l.same_place(r) || l.owner == r.owner) continue;
    length += glm::distance(to_dvec(mesh.positions[old.uv_vertex[l.a]]),
                            to_dvec(mesh.positions[old.uv_vertex[l.b]]));
  }
  return length;
}

}  // namespace

std::size_t cut_to_limits(const MeshView& mesh, std::span<const double> limits, ChartSet& charts) {
  std::size_t count = 0;
  for (std::size_t c = 0; c < charts.charts.size(); ++c)
    count += charts.charts[c].size.x > limits[c];
  if (count == 0) return 0;
  const Cutter cutter(charts);
  Rebuilder fresh(mesh, charts);
  double seam = charts.seam_length;
  for (std::size_t c = 0; c < charts.charts.size(); ++c) {
    const Chart& chart = charts.charts[c];
    const auto first = charts.chart_triangles.begin() + chart.first_triangle;
    std::vector<Triangles> pieces;
    cutter.cut(Triangles(first, first + chart.triangle_count), limits[c], pieces);
    if (pieces.size() > 1) seam += cut_length(mesh, charts, pieces);
    for (const Triangles& piece : pieces) fresh.add(chart, piece, pieces.size() == 1);
  }
  charts = fresh.take();
  charts.seam_length = seam;
  return count;
}

}  // namespace atlas

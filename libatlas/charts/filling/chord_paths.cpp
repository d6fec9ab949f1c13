#include "libatlas/charts/filling/chord_paths.h"

#include <cmath>
#include <functional>
#include <queue>

#include "libatlas/core/hull.h"

namespace atlas {
namespace {

// A path may be at most kLongestPath times as long as its chord. An edge at distance d from the
// chord, in chord lengths, counts 1 + kStrayWeight d² times its length: at a tenth it counts
// double.
constexpr double kLongestPath = 1.6, kStrayWeight = 100;
constexpr double kMostStray = 0.5;
constexpr std::uint32_t kUnseen = kNoIndex - 1;

// Returns the distance of p from the chord, in chord lengths.
double stray(const Vec2d& p, const Vec2d& from, const Vec2d& to) {
  const double dx = to.x - from.x, dy = to.y - from.y;
  return std::sqrt(squared_distance_to_segment(p, from, to) / (dx * dx + dy * dy));
}

struct Visit {
  double distance;
  std::uint32_t uv, by;
  bool operator>(const Visit& o) const {
    if (distance != o.distance) return distance > o.distance;
    return uv != o.uv ? uv > o.uv : by > o.by;
  }
};

}  // namespace

ChordPaths::ChordPaths(const FlatChart& chart, const param::HalfEdges& half_edges,
                       const std::vector<std::uint32_t>& piece_of,
                       std::span<const std::uint32_t> polygons, const Context& context)
    : chart_(chart),
      half_edges_(half_edges),
      piece_of_(piece_of),
      polygons_(polygons),
      context_(context),
      leaving_(sort_into_buckets(3 * chart.triangles.size(), chart.uvs.size(),
                                 [&](std::size_t h) { return chart.corners[h / 3][h % 3]; })),
      by_(chart.uvs.size(), kUnseen),
      on_rim_(chart.uvs.size(), 0) {}

std::vector<std::array<std::uint32_t, 2>> ChordPaths::edges_across(const Piece& piece) {
  std::vector<std::uint32_t>& place = by_;
  for (std::uint32_t i = 0; i < piece.outline.size(); ++i) place[piece.outline[i]] = i;
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const std::uint32_t t : piece.triangles) {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t a = place[half_edges_.from(h)], b = place[half_edges_.to(h)];
      if (a != kUnseen && b != kUnseen && a < b && open(h)) edges.push_back({a, b});
    }
  }
  for (const std::uint32_t i : piece.outline) place[i] = kUnseen;
  return edges;
}

std::vector<std::uint32_t> ChordPaths::find(const Piece& piece, std::uint32_t a, std::uint32_t b) {
  for (const std::uint32_t i : piece.outline) on_rim_[i] = 1;
  const std::vector<std::uint32_t> reached = search(piece_of_[piece.triangles[0]], a, b);
  std::vector<std::uint32_t> path = trace(a, b);
  for (const std::uint32_t i : piece.outline) on_rim_[i] = 0;
  for (const std::uint32_t i : reached) by_[i] = kUnseen;
  return path;
}

std::vector<std::uint32_t> ChordPaths::search(std::uint32_t piece, std::uint32_t a,
                                              std::uint32_t b) {
  const Vec2d from = chart_.uvs[a], to = chart_.uvs[b];
  std::priority_queue<Visit, std::vector<Visit>, std::greater<>> queue;
  std::vector<std::uint32_t> reached;
  queue.push({0, a, kNoIndex});
  while (!queue.empty() && !context_.cancelled()) {
    const Visit visit = queue.top();
    queue.pop();
    if (by_[visit.uv] != kUnseen) continue;
    by_[visit.uv] = visit.by;
    reached.push_back(visit.uv);
    if (visit.uv == b) break;
    const Vec2d& p = chart_.uvs[visit.uv];
    if (stray(p, from, to) > kMostStray) continue;
    for (const std::uint32_t h : leaving_[visit.uv]) {
      const std::uint32_t next = half_edges_.to(h);
      if (piece_of_[h / 3] != piece || !open(h) || by_[next] != kUnseen) continue;
      if (next != b && on_rim_[next]) continue;
      const Vec2d& q = chart_.uvs[next];
      const double off = stray({(p.x + q.x) / 2, (p.y + q.y) / 2}, from, to);
      queue.push({visit.distance + distance(p, q) * (1 + kStrayWeight * off * off), next, h});
    }
  }
  return reached;
}

std::vector<std::uint32_t> ChordPaths::trace(std::uint32_t a, std::uint32_t b) const {
  std::vector<std::uint32_t> path;
  double length = 0;
  for (std::uint32_t uv = by_[b] == kUnseen ? a : b; uv != a;) {
    const std::uint32_t h = by_[uv];
    path.push_back(h);
    length += distance(chart_.uvs[half_edges_.from(h)], chart_.uvs[uv]);
    uv = half_edges_.from(h);
  }
  if (length > kLongestPath * distance(chart_.uvs[a], chart_.uvs[b])) path.clear();
  return path;
}

}  // namespace atlas

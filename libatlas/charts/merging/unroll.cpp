#include "libatlas/charts/merging/unroll.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "libatlas/charts/cells/tips.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Limits on the angle defects of a cell's vertices in radians: on the magnitude of their sum, and
// on the sum of their magnitudes. A cell of 1 / 600 of a sphere has 0.02. Rounding of coordinates
// cancels in the former, but not in the latter.
constexpr double kCurvature = 2e-4, kRoughness = 5e-3;
// The largest gap where triangles meet again around a hole, relative to the cell's size.
constexpr double kClosing = 1e-3;
constexpr double kFlatSpread = 1e-6;  // of normals in one plane, as in merging

// A triangle in its plane, with corners at (0, 0), (length, 0) and (along, height).
struct Flat {
  Flat(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) : length(glm::length(b - a)) {
    along = glm::dot(c - a, b - a) / length;
    height = glm::length(glm::cross(b - a, c - a)) / length;
  }
  // Returns the vector from the first corner to the third, if the unit vector e points to the
  // second.
  glm::dvec2 rise(const glm::dvec2& e) const { return along * e + height * glm::dvec2(-e.y, e.x); }

  double length, along, height;
};

class Unroller {
 public:
  Unroller(const Topology& topology, const Cells& cells, std::span<const std::uint32_t> tips,
           CoarseMesh& mesh)
      : topology_(topology), cells_(cells), mesh_(mesh), curved_(topology.component_count, 0) {
    for (const std::uint32_t h : tips) tips_.insert(topology.corner_vertex[h]);
  }

  // Lays out bent cells first; cells in one plane only where they touch cells that unroll. Each
  // cell is tried once.
  void run() {
    tried_.assign(mesh_.cells.size(), 0);
    std::vector<std::uint32_t> found;
    for (std::uint32_t k = 0; k < mesh_.cells.size(); ++k) {
      if (mesh_.cells[k].slot_count == 0 || flat(k) || curved_[piece(k)]) continue;
      if (unroll(k)) {
        found.push_back(k);
      } else {
        curved_[piece(k)] = 1;
      }
    }
    std::erase_if(found, [&](std::uint32_t k) {
      if (curved_[piece(k)]) mesh_.cells[k].unrolls = false;
      return curved_[piece(k)] != 0;
    });
    for (std::size_t i = 0; i < found.size(); ++i) {
      const CoarseCell& cell = mesh_.cells[found[i]];
      for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
        for (const std::uint32_t k : mesh_.arcs[mesh_.slot_arc[s]].cell) {
          if (k != kNoIndex && !tried_[k] && flat(k) && unroll(k)) found.push_back(k);
        }
      }
    }
  }

 private:
  std::uint32_t piece(std::uint32_t k) const {
    return topology_.component[mesh_.slot_half_edge[mesh_.cells[k].first_slot] / 3];
  }

  glm::dvec3 point(std::uint32_t h) const {
    return to_dvec(topology_.points[topology_.corner_vertex[h]]);
  }

  bool flat(std::uint32_t k) const {
    const CoarseCell& cell = mesh_.cells[k];
    return 1 - glm::length(to_glm(cell.normal_sum)) / cell.area < kFlatSpread;
  }

  bool is_tip(std::uint32_t v) const { return !tips_.empty() && tips_.contains(v); }

  bool unroll(std::uint32_t k) {
    tried_[k] = 1;
    return mesh_.cells[k].unrolls = uncurved(k) && lay_flat(k);
  }

  // Lists the cell's triangles breadth-first in queue_, as long as angle defects stay small.
  // Returns whether the cell is developable.
  bool uncurved(std::uint32_t k) {
    if (seen_.empty()) {
      seen_.assign(topology_.points.size(), kNoIndex);
      place_.assign(topology_.triangle_count(), kNoIndex);
    }
    queue_.assign(1, mesh_.slot_half_edge[mesh_.cells[k].first_slot]);
    place_[queue_[0] / 3] = 0;
    double curvature = 0, roughness = 0;
    for (std::size_t i = 0; i < queue_.size() && roughness <= kRoughness; ++i) {
      const std::uint32_t t = queue_[i] / 3;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        std::uint32_t& seen = seen_[topology_.corner_vertex[h]];
        if (seen != k && !is_tip(topology_.corner_vertex[h])) {
          const double own = angle_defect(topology_, h);
          curvature += own;
          roughness += std::abs(own);
        }
        seen = k;
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || cells_.of_triangle[o / 3] != k || placed(o / 3)) continue;
        place_[o / 3] = static_cast<std::uint32_t>(queue_.size());
        queue_.push_back(o);
      }
    }
    return roughness <= kRoughness && std::abs(curvature) <= kCurvature;
  }

  bool placed(std::uint32_t t) const {
    return place_[t] < queue_.size() && queue_[place_[t]] / 3 == t;
  }

  // Lays the triangles out in the queue's order. Each entry is a half-edge, over whose opposite the
  // triangle was reached. Returns whether they fit each other.
  bool lay_flat(std::uint32_t k) {
    CoarseCell& cell = mesh_.cells[k];
    flat_.resize(queue_.size());
    const std::uint32_t first = queue_[0];
    glm::dvec2 middle(0);
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const std::uint32_t h = queue_[i];
      glm::dvec2 a(0), b(glm::distance(point(first), point(next_half_edge(first))), 0);
      if (i > 0) {
        a = at(next_half_edge(topology_.opposite[h]));
        b = at(topology_.opposite[h]);
      }
      put(i, h, a, b);
      for (const glm::dvec2& p : flat_[i]) middle += double(topology_.areas[h / 3]) / 3 * p;
    }
    const double error = kClosing * std::sqrt(cell.area);
    for (const std::uint32_t entry : queue_) {
      for (std::uint32_t h = 3 * (entry / 3); h < 3 * (entry / 3) + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || !placed(o / 3)) continue;
        if (glm::distance(at(h), at(next_half_edge(o))) > error) return false;
      }
    }
    if (mesh_.flat_slot.empty()) mesh_.flat_slot.resize(mesh_.slot_position.size());
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      mesh_.flat_slot[s] = from_glm(at(mesh_.slot_half_edge[s]));
    }
    cell.flat_centre = from_glm(middle / cell.area);
    return true;
  }

  // Returns where the start of h lies in the plane. Precondition: its triangle has been placed.
  glm::dvec2 at(std::uint32_t h) const { return flat_[place_[h / 3]][h % 3]; }

  // Places the triangle of h, with that edge running from a to b and the triangle to its left.
  void put(std::size_t i, std::uint32_t h, const glm::dvec2& a, const glm::dvec2& b) {
    flat_[i][h % 3] = a;
    flat_[i][next_half_edge(h) % 3] = b;
    const Flat flat(point(h), point(next_half_edge(h)), point(previous_half_edge(h)));
    flat_[i][previous_half_edge(h) % 3] = a + flat.rise((b - a) / flat.length);
  }

  const Topology& topology_;
  const Cells& cells_;
  CoarseMesh& mesh_;
  // One per piece: it is curved somewhere. Parts of it that unroll would be joined untried to
  // charts that the rest then depends on, and those had to be cut again, at three times the cost (a
  // cabin of a million triangles).
  std::vector<std::uint8_t> curved_;
  std::vector<std::uint8_t> tried_;  // one per cell
  std::unordered_set<std::uint32_t> tips_;
  std::vector<std::uint32_t> seen_;              // one per vertex: the last cell that visited it
  std::vector<std::uint32_t> place_;             // one per triangle: its index in queue_
  std::vector<std::uint32_t> queue_;             // half-edges
  std::vector<std::array<glm::dvec2, 3>> flat_;  // one per queue entry
};

// A chart counts as curved if a corner misses its earlier place by more than this share of the edge
// opposite to it. The rounding of coordinates, added up from triangle to triangle, is less.
constexpr double kMostGap = 0.02;

class ChartUnroller {
 public:
  ChartUnroller(const LocalChart& chart, double min_altitude, std::vector<Vec2d>& uvs)
      : chart_(chart), min_altitude_(min_altitude), uvs_(uvs) {}

  bool run() {
    uvs_.assign(chart_.positions.size(), {});
    placed_.assign(chart_.positions.size(), 0);
    reached_.assign(chart_.corners.size(), 0);
    place(vertex(0), glm::dvec2(0));
    place(vertex(1), {glm::distance(point(0), point(1)), 0});
    if (!lay({0, {1, 0}})) return false;
    queue_.push_back({0, {1, 0}});
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const Side side = queue_[i];
      const std::uint32_t h = chart_.opposite[side.half_edge];
      if (h != kNoIndex && !reached_[h / 3] && !lay({h, -side.direction})) return false;
    }
    return true;
  }

 private:
  // A half-edge of a placed triangle and the unit vector along it. Directions are passed on from
  // triangle to triangle and not computed from the end points, whose errors would grow
  // exponentially over triangles that are higher than wide.
  struct Side {
    std::uint32_t half_edge;
    glm::dvec2 direction;
  };

  std::uint32_t vertex(std::uint32_t h) const { return chart_.corners[h / 3][h % 3]; }
  glm::dvec3 point(std::uint32_t h) const { return to_glm(chart_.positions[vertex(h)]); }
  void place(std::uint32_t v, const glm::dvec2& p) {
    uvs_[v] = from_glm(p);
    placed_[v] = 1;
  }

  // Places the triangle of that side, whose ends are placed. The third corner gets its place or, if
  // it has one, must lie there. Returns false if it does not, or if the triangle is too thin.
  bool lay(const Side& side) {
    const std::uint32_t h = side.half_edge, g = next_half_edge(h), k = previous_half_edge(h);
    reached_[h / 3] = 1;
    const Flat flat(point(h), point(g), point(k));
    const glm::dvec2 first = flat.rise(side.direction),
                     second = first - flat.length * side.direction;
    const double to_first = glm::length(first), to_second = glm::length(second);
    // Written so that triangles without any length fail, too.
    const double longest = std::max({flat.length, to_first, to_second});
    if (!(flat.length * flat.height >= min_altitude_ * longest)) return false;
    queue_.push_back({g, second / to_second});
    queue_.push_back({k, -first / to_first});
    const glm::dvec2 p = to_glm(uvs_[vertex(h)]) + first;
    const std::uint32_t v = vertex(k);
    if (placed_[v]) return glm::distance(p, to_glm(uvs_[v])) <= kMostGap * flat.length;
    place(v, p);
    return true;
  }

  const LocalChart& chart_;
  double min_altitude_;
  std::vector<Vec2d>& uvs_;
  std::vector<std::uint8_t> placed_, reached_;  // one per vertex; one per triangle
  std::vector<Side> queue_;
};

}  // namespace

bool unroll_chart(const LocalChart& chart, double min_altitude, std::vector<Vec2d>& uvs) {
  return ChartUnroller(chart, min_altitude, uvs).run();
}

void unroll_cells(const Topology& topology, const Cells& cells, std::span<const std::uint32_t> tips,
                  CoarseMesh& mesh) {
  Unroller(topology, cells, tips, mesh).run();
}

}  // namespace atlas

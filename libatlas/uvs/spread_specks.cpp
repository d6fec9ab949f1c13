#include "libatlas/uvs/spread_specks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "libatlas/core/no_index.h"
#include "libatlas/uvs/thin_uvs.h"

namespace atlas {
namespace {

// In steps between floats: uvs that are nearer to each other than this form one cluster. If the
// cluster cannot be spread, the next larger distance is tried.
constexpr std::array kNear{16.0, 64.0, 256.0};
// The first radius, in steps per square root of the number of members, and the largest, relative to
// the distance above.
constexpr double kFirstRadius = 8, kMostRadius = 2;
constexpr std::size_t kMostMembers = 64;
constexpr int kSweeps = 4;  // per member

struct DirectedEdge {
  std::uint32_t from, to;
  auto operator<=>(const DirectedEdge&) const = default;
};

// Uvs that are near each other (members), and the triangles and edges at them.
struct Cluster {
  std::vector<std::uint32_t> members, triangles;
  std::vector<DirectedEdge> edges;  // sorted; those with a member
  // The mesh's border at the cluster: a uv outside, members, a uv outside; or if all of the border
  // lies in the cluster, members only, from one back to itself.
  std::vector<std::uint32_t> rim;
};

class SpeckSpreader {
 public:
  SpeckSpreader(std::span<const std::uint32_t> corners, const Buckets& corners_at,
                std::vector<Vec2f>& uvs)
      : corners_(corners), corners_at_(corners_at), uvs_(uvs), place_(uvs.size(), kNoIndex) {}

  void run() {
    // One per triangle: whether a cluster with it could not be spread.
    std::vector<std::uint8_t> in_vain(corners_.size() / 3, 0);
    for (std::uint32_t t = 0; t < in_vain.size(); ++t) {
      if (in_vain[t] || !thin(t)) continue;
      for (const double near : kNear) {
        const std::optional<Cluster> cluster = find_cluster(t, near * kUvStep);
        if (!cluster) continue;
        if (spread(*cluster, kMostRadius * near * kUvStep)) break;
        for (const std::uint32_t other : cluster->triangles) in_vain[other] = 1;
      }
    }
  }

 private:
  std::span<const std::uint32_t, 3> corners_of(std::uint32_t t) const {
    return corners_.subspan(3 * std::size_t(t)).first<3>();
  }
  bool thin(std::uint32_t t) const { return is_thin(corners_of(t), uvs_); }
  glm::dvec2 at(std::uint32_t uv) const { return to_dvec(uvs_[uv]); }
  bool is_member(const Cluster& c, std::uint32_t uv) const {
    return place_[uv] < c.members.size() && c.members[place_[uv]] == uv;
  }

  // Returns the cluster around the first side of the triangle that is shorter than `near`. Returns
  // none if no side is, or if the cluster is large or touches the border of the mesh more than
  // once.
  std::optional<Cluster> find_cluster(std::uint32_t t, double near) {
    Cluster c;
    const auto v = corners_of(t);
    for (std::size_t i = 0; i < 3 && c.members.empty(); ++i) {
      if (glm::distance(at(v[i]), at(v[(i + 1) % 3])) < near) add_member(v[i], c);
    }
    for (std::size_t i = 0; i < c.members.size(); ++i) {
      if (c.members.size() > kMostMembers) return {};
      const std::uint32_t own = c.members[i];
      for (const std::uint32_t corner : corners_at_[own]) {
        c.triangles.push_back(corner / 3);
        for (const std::uint32_t uv : corners_of(corner / 3)) {
          if (!is_member(c, uv) && glm::distance(at(uv), at(own)) < near) add_member(uv, c);
        }
      }
    }
    if (c.members.size() < 2) return {};
    std::sort(c.triangles.begin(), c.triangles.end());
    c.triangles.erase(std::unique(c.triangles.begin(), c.triangles.end()), c.triangles.end());
    list_edges(c);
    if (!find_rim(c)) return {};
    return c;
  }

  void add_member(std::uint32_t uv, Cluster& c) {
    place_[uv] = static_cast<std::uint32_t>(c.members.size());
    c.members.push_back(uv);
  }

  void list_edges(Cluster& c) const {
    for (const std::uint32_t t : c.triangles) {
      const auto v = corners_of(t);
      for (std::size_t i = 0; i < 3; ++i) {
        const DirectedEdge e{v[i], v[(i + 1) % 3]};
        if (e.from != e.to && (is_member(c, e.from) || is_member(c, e.to))) c.edges.push_back(e);
      }
    }
    std::sort(c.edges.begin(), c.edges.end());
  }

  // Returns false if the border passes through the cluster more than once, or if a closed border
  // lies within the cluster. The border may run all the way around the cluster.
  bool find_rim(Cluster& c) const {
    std::vector<DirectedEdge> border;
    for (const DirectedEdge& e : c.edges) {
      if (!std::binary_search(c.edges.begin(), c.edges.end(), DirectedEdge{e.to, e.from})) {
        border.push_back(e);
      }
    }
    if (border.empty()) return true;
    const auto comes_in = [&](const DirectedEdge& e) { return !is_member(c, e.from); };
    const auto first = std::find_if(border.begin(), border.end(), comes_in);
    if (first == border.end() && std::any_of(c.edges.begin(), c.edges.end(), comes_in)) {
      return false;
    }
    DirectedEdge edge = first == border.end() ? border.front() : *first;
    const std::uint32_t start = edge.from;
    c.rim = {start, edge.to};
    while (is_member(c, edge.to) && edge.to != start) {
      const auto next = std::lower_bound(border.begin(), border.end(), DirectedEdge{edge.to, 0});
      if (next == border.end() || next->from != edge.to || c.rim.size() > border.size()) {
        return false;
      }
      edge = *next;
      c.rim.push_back(edge.to);
    }
    return c.rim.size() == border.size() + 1;
  }

  std::size_t count_thin(const Cluster& c) const {
    return std::size_t(std::count_if(c.triangles.begin(), c.triangles.end(),
                                     [&](std::uint32_t t) { return thin(t); }));
  }

  // Returns whether no triangle is thin afterwards. The places that leave the fewest thin triangles
  // are kept.
  bool spread(const Cluster& c, double most_radius) {
    std::vector<Vec2f> best;
    glm::dvec2 centre(0);
    for (const std::uint32_t uv : c.members) {
      best.push_back(uvs_[uv]);
      centre += at(uv) / double(c.members.size());
    }
    std::size_t least = count_thin(c);
    const double first = kFirstRadius * std::sqrt(double(c.members.size())) * kUvStep;
    for (double radius = first; radius <= most_radius && least > 0; radius *= 2) {
      const std::vector<glm::dvec2> drawn = draw(c, centre, radius);
      for (std::size_t i = 0; i < drawn.size(); ++i) uvs_[c.members[i]] = rounded_uv(drawn[i]);
      const std::size_t now = count_thin(c);
      if (now >= least) continue;
      least = now;
      for (std::size_t i = 0; i < drawn.size(); ++i) best[i] = uvs_[c.members[i]];
    }
    for (std::size_t i = 0; i < best.size(); ++i) uvs_[c.members[i]] = best[i];
    return least == 0;
  }

  // Places each member amid its neighbours. Neighbours outside the cluster count as points of the
  // circle in their directions. Members on the border lie on the rest of the circle.
  std::vector<glm::dvec2> draw(const Cluster& c, glm::dvec2 centre, double radius) const {
    std::vector<glm::dvec2> p(c.members.size(), centre);
    std::vector<bool> fixed(c.members.size(), false);
    const auto angle_of = [&](std::uint32_t uv) {
      const glm::dvec2 d = at(uv) - centre;
      return std::atan2(d.y, d.x);
    };
    const auto on_circle = [&](double angle) {
      return centre + radius * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    if (!c.rim.empty()) {
      // The mesh lies on the left of its border. There is none of it counter-clockwise from the
      // direction that the border comes from to the direction in which it goes on.
      const bool closed = is_member(c, c.rim.front());
      const double begin = angle_of(c.rim.front());
      double span = closed ? 2 * std::numbers::pi : angle_of(c.rim.back()) - begin;
      if (span <= 0) span += 2 * std::numbers::pi;
      for (std::size_t i = closed ? 0 : 1; i + 1 < c.rim.size(); ++i) {
        const std::uint32_t member = place_[c.rim[i]];
        p[member] = on_circle(begin + span * double(i) / double(c.rim.size() - 1));
        fixed[member] = true;
      }
    }
    struct Sum {
      glm::dvec2 outer{0};
      double count = 0;
      std::vector<std::uint32_t> inner;
    };
    std::vector<Sum> around(c.members.size());
    for (const DirectedEdge& e : c.edges) {
      // Edges inside the mesh are listed in both directions.
      if (!is_member(c, e.from)) continue;
      Sum& sum = around[place_[e.from]];
      ++sum.count;
      if (is_member(c, e.to)) {
        sum.inner.push_back(place_[e.to]);
      } else {
        sum.outer += on_circle(angle_of(e.to));
      }
    }
    for (std::size_t sweep = 0; sweep < kSweeps * p.size(); ++sweep) {
      for (std::size_t i = 0; i < p.size(); ++i) {
        if (fixed[i]) continue;
        glm::dvec2 sum = around[i].outer;
        for (const std::uint32_t other : around[i].inner) sum += p[other];
        p[i] = sum / around[i].count;
      }
    }
    return p;
  }

  std::span<const std::uint32_t> corners_;
  const Buckets& corners_at_;
  std::vector<Vec2f>& uvs_;
  std::vector<std::uint32_t> place_;  // one per uv: its place among its cluster's members
};

}  // namespace

void spread_specks(std::span<const std::uint32_t> corners, const Buckets& corners_at,
                   std::vector<Vec2f>& uvs) {
  SpeckSpreader(corners, corners_at, uvs).run();
}

}  // namespace atlas

#include "libatlas/charts/mesh/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libatlas/charts/mesh/links.h"
#include "libatlas/charts/mesh/noise.h"
#include "libatlas/charts/mesh/pair_links.h"
#include "libatlas/charts/mesh/thin.h"
#include "libatlas/charts/mesh/welded_mesh.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/is_finite.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

// A triangle is degenerate if twice its area is at most this share of its longest edge squared.
// Double products of float coordinates are good to 1e-16, so such an area is rounding, not shape.
constexpr double kDegenerateShare = 1e-12;

// Data at random places in memory is prefetched this many triangles ahead. The orders of meshes
// differ, and waiting would take most of the time.
constexpr std::size_t kCornersAhead = 20;

Status check_input(const MeshView& mesh) {
  const std::size_t n = mesh.indices.size();
  if (n < 3) return {ErrorCode::bad_input, "mesh: no triangle (nothing to chart)"};
  if (n % 3 != 0) {
    return {ErrorCode::bad_input, fmt::format("mesh: {} indices are not whole triangles", n)};
  }
  if (n / 3 >= (std::size_t{1} << 30)) {
    return {ErrorCode::unsupported, "mesh: more than 2^30 triangles (split it)"};
  }
  const std::uint32_t largest = *std::max_element(mesh.indices.begin(), mesh.indices.end());
  if (largest >= mesh.positions.size()) {
    const auto at = std::find_if(mesh.indices.begin(), mesh.indices.end(),
                                 [&](std::uint32_t v) { return v >= mesh.positions.size(); });
    return {
        ErrorCode::bad_input,
        fmt::format("triangle {}: vertex index {} names none of the {} positions (indices count "
                    "from 0)",
                    (at - mesh.indices.begin()) / 3, *at, mesh.positions.size())};
  }
  if (!mesh.materials.empty() && mesh.materials.size() != n / 3) {
    return {ErrorCode::bad_input, "mesh: materials must be empty or 1 a triangle"};
  }
  if (!mesh.seams.empty() && mesh.seams.size() != n) {
    return {ErrorCode::bad_input, "mesh: seams must be empty or 3 a triangle"};
  }
  if (!mesh.objects.empty() && mesh.objects.size() != mesh.positions.size()) {
    return {ErrorCode::bad_input, "mesh: objects must be empty or 1 a position"};
  }
  if (!mesh.density.empty() && mesh.density.size() != n / 3) {
    return {ErrorCode::bad_input, "mesh: densities must be empty or 1 a triangle"};
  }
  if (!mesh.polygons.empty() && mesh.polygons.size() != n / 3) {
    return {ErrorCode::bad_input, "mesh: polygons must be empty or 1 a triangle"};
  }
  if (!mesh.seam_weights.empty() && mesh.seam_weights.size() != mesh.positions.size()) {
    return {ErrorCode::bad_input, "mesh: seam weights must be empty or 1 a position"};
  }
  for (std::size_t v = 0; v < mesh.seam_weights.size(); ++v) {
    const float weight = mesh.seam_weights[v];
    if (weight >= 0 && std::isfinite(weight)) continue;
    return {ErrorCode::bad_input,
            fmt::format("position {}: seam weight {} (must be at least 0 and finite)", v, weight)};
  }
  for (std::size_t t = 0; t < mesh.density.size(); ++t) {
    if (mesh.density[t] > 0 && std::isfinite(mesh.density[t])) continue;
    return {
        ErrorCode::bad_input,
        fmt::format("triangle {}: density {} (must be above 0 and finite)", t, mesh.density[t])};
  }
  return {};
}

Status check_positions(const MeshView& mesh, const std::vector<std::uint8_t>& used) {
  bool all = true;
  for (std::size_t v = 0; v < used.size(); ++v) all &= !used[v] || is_finite(mesh.positions[v]);
  if (all) return {};
  const auto at = std::find_if(mesh.indices.begin(), mesh.indices.end(),
                               [&](std::uint32_t v) { return !is_finite(mesh.positions[v]); });
  return {ErrorCode::bad_input,
          fmt::format("triangle {}: vertex {} has a position that is not finite",
                      (at - mesh.indices.begin()) / 3, *at)};
}

// Fills scale, points, source_vertex and corner_vertex.
void take_vertices(const MeshView& mesh, WeldedVertices welded, Topology& topology) {
  topology.scale = welded.scale;
  topology.points = std::move(welded.points);
  topology.source_vertex = std::move(welded.source);
  topology.corner_vertex.resize(mesh.indices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::uint32_t v = mesh.indices[i];
    topology.corner_vertex[i] = welded.place.empty() ? v : welded.place[v];
  }
  if (!mesh.seam_weights.empty()) topology.seam_weights.assign(topology.points.size(), 0);
  for (std::size_t i = 0; !mesh.seam_weights.empty() && i < mesh.indices.size(); ++i) {
    float& own = topology.seam_weights[topology.corner_vertex[i]];
    own = std::max(own, mesh.seam_weights[mesh.indices[i]]);
  }
  // In double, since the scale of a mesh of denormal numbers is beyond float.
  const double scale = topology.scale;
  for (Vec3f& p : topology.points) {
    p = {float(p.x * scale), float(p.y * scale), float(p.z * scale)};
  }
}

glm::dvec3 point(const Topology& topology, std::uint32_t corner) {
  return to_dvec(topology.points[topology.corner_vertex[corner]]);
}

// Returns the triangles whose normals are to be borrowed; without `borrow`, only those without
// area.
std::vector<std::uint32_t> measure_triangles(Topology& topology, bool borrow) {
  const std::size_t n = topology.corner_vertex.size() / 3;
  topology.normals.assign(n, Vec3f{});
  topology.areas.assign(n, 0.0f);
  topology.flags.assign(n, 0);
  const RoundingLimit limit(topology);
  std::vector<std::uint32_t> thin;
  for (std::uint32_t t = 0; t < n; ++t) {
    const glm::dvec3 a = point(topology, 3 * t), b = point(topology, 3 * t + 1),
                     c = point(topology, 3 * t + 2);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double twice = glm::length(cross);
    const double longest =
        std::max({glm::dot(b - a, b - a), glm::dot(c - a, c - a), glm::dot(c - b, c - b)});
    if (!(twice > kDegenerateShare * longest)) {
      const std::uint32_t* v = &topology.corner_vertex[3 * std::size_t{t}];
      const bool corners = v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
      topology.flags[t] = corners ? Topology::kThin : Topology::kDegenerate;
      if (topology.thin(t)) thin.push_back(t);
      ++topology.defects.degenerate_triangles;
      continue;
    }
    topology.normals[t] = from_glm(glm::vec3(cross / twice));
    topology.areas[t] = static_cast<float>(0.5 * twice);
    if (borrow && limit.blurs({a, b, c}, cross, longest)) thin.push_back(t);
  }
  return thin;
}

// Numbers the pieces and finds the triangles that must be turned so that neighbours agree. Where no
// choice agrees, the link is cut. Each piece keeps the orientation of most of its area.
//
// This is a union-find in which each triangle points to a lower one of its piece, or to itself.
// Unlike a flood fill, it reads the mesh in order. Links whose triangles agree are joined before
// the others. On a surface that cannot be oriented, what is cut then are links that disagreed in
// the input, instead of links anywhere with half of the surface turned.
class Pieces {
 public:
  explicit Pieces(Topology& topology)
      : topology_(topology),
        triangles_(static_cast<std::uint32_t>(topology.triangle_count())),
        lower_(topology.component) {}

  void run() {
    const bool mixed = topology_.defects.misoriented_edges > 0;
    join_agreeing(mixed);
    if (!mixed) return number();
    turned_.assign(triangles_, 0);
    join_disagreeing();
    number();
    choose_orientations();
    std::sort(topology_.fan_links.begin(), topology_.fan_links.end());
    cut_conflicts();
    for (std::uint32_t t = 0; t < triangles_; ++t) {
      if (topology_.flags[t] & Topology::kFlipped) turn(t);
    }
    for (std::uint32_t& h : topology_.fan_links) {
      if ((topology_.flags[h / 3] & Topology::kFlipped) && h % 3 != 1) h += h % 3 == 0 ? 2 : -2;
    }
  }

 private:
  bool misoriented(std::uint32_t h, std::uint32_t o) const {
    return topology_.corner_vertex[h] == topology_.corner_vertex[o];
  }

  void join_agreeing(bool mixed) {
    lower_.resize(triangles_);
    const auto root = [&](std::uint32_t t) {
      while (lower_[t] != t) t = lower_[t] = lower_[lower_[t]];
      return t;
    };
    for (std::uint32_t t = 0; t < triangles_; ++t) {
      std::uint32_t own = lower_[t] = t;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o >= h || (mixed && misoriented(h, o))) continue;  // kNoIndex is the largest
        const std::uint32_t other = root(o / 3);
        lower_[std::max(own, other)] = std::min(own, other);
        own = std::min(own, other);
      }
    }
  }

  // Joins over the other links, with each triangle turned against the one that it points to or not.
  void join_disagreeing() {
    for (std::uint32_t h = 0; h < 3 * triangles_; ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o >= h || !misoriented(h, o)) continue;
      const auto [a, a_turned] = root_of(h / 3);
      const auto [b, b_turned] = root_of(o / 3);
      if (a == b) continue;
      lower_[std::max(a, b)] = std::min(a, b);
      turned_[std::max(a, b)] = a_turned ^ b_turned ^ 1;
    }
  }

  struct Root {
    std::uint32_t triangle;
    std::uint8_t turned;  // whether the triangle asked for is turned against it
  };

  Root root_of(std::uint32_t t) {
    std::uint8_t turned = 0;
    while (lower_[t] != t) {
      turned_[t] ^= turned_[lower_[t]];
      lower_[t] = lower_[lower_[t]];
      turned ^= turned_[t];
      t = lower_[t];
    }
    return {t, turned};
  }

  // Replaces what triangles point to by the numbers of their pieces, in the order of their first
  // triangles. These are what turned_ then refers to.
  void number() {
    for (std::uint32_t t = 0; t < triangles_; ++t) {
      const std::uint32_t to = lower_[t];
      if (topology_.degenerate(t)) {
        lower_[t] = kNoIndex;
      } else if (to == t) {
        lower_[t] = topology_.component_count++;
      } else {
        lower_[t] = lower_[to];
        if (!turned_.empty()) turned_[t] ^= turned_[to];
      }
    }
  }

  void choose_orientations() {
    std::vector<double> kept(topology_.component_count, 0), turned = kept;
    for (std::uint32_t t = 0; t < triangles_; ++t) {
      if (!topology_.degenerate(t)) (turned_[t] ? turned : kept)[lower_[t]] += topology_.areas[t];
    }
    for (std::uint32_t t = 0; t < triangles_; ++t) {
      if (topology_.degenerate(t)) continue;
      const bool other_way = turned[lower_[t]] > kept[lower_[t]];
      if ((turned_[t] != 0) != other_way) topology_.flags[t] |= Topology::kFlipped;
    }
  }

  void cut_conflicts() {
    for (std::uint32_t h = 0; h < topology_.opposite.size(); ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o == kNoIndex || o < h) continue;
      const bool differ = turned_[h / 3] != turned_[o / 3];
      if (differ == misoriented(h, o)) continue;
      topology_.opposite[h] = topology_.opposite[o] = kNoIndex;
      // The list has the lower half-edge of each pair.
      const bool fan =
          std::binary_search(topology_.fan_links.begin(), topology_.fan_links.end(), h);
      if (!fan) topology_.cut_length += edge_length(topology_, h) / topology_.scale;
    }
  }

  // Exchanges corners 1 and 2, and with them half-edges 0 and 2.
  void turn(std::uint32_t t) {
    const std::uint32_t a = 3 * t, b = 3 * t + 2;
    std::swap(topology_.corner_vertex[3 * t + 1], topology_.corner_vertex[3 * t + 2]);
    Vec3f& normal = topology_.normals[t];
    normal = {-normal.x, -normal.y, -normal.z};
    const std::uint32_t across_a = topology_.opposite[a], across_b = topology_.opposite[b];
    topology_.opposite[a] = across_b;
    topology_.opposite[b] = across_a;
    if (across_a != kNoIndex) topology_.opposite[across_a] = b;
    if (across_b != kNoIndex) topology_.opposite[across_b] = a;
  }

  Topology& topology_;
  std::uint32_t triangles_;
  // One per triangle: a lower one of its piece, or itself; at the end its piece.
  std::vector<std::uint32_t>& lower_;
  std::vector<std::uint8_t> turned_;  // one per triangle; empty if all agree
};

// Counts the vertices around which triangles form more than one fan. There, one fan has fewer than
// all of the vertex's corners.
void count_nonmanifold_vertices(Topology& topology) {
  const auto corners = static_cast<std::uint32_t>(topology.corner_vertex.size());
  std::vector<std::uint32_t> valence(topology.points.size(), 0);  // 0 once the vertex is judged
  for (std::uint32_t h = 0; h < corners; ++h) {
    valence[topology.corner_vertex[h]] += !topology.degenerate(h / 3);
  }
  for (std::uint32_t start = 0; start < corners; ++start) {
    if (start + 3 * kCornersAhead < corners) {
      const std::uint32_t later = start + 3 * kCornersAhead, across = topology.opposite[later];
      __builtin_prefetch(valence.data() + topology.corner_vertex[later], 1);
      if (across != kNoIndex) __builtin_prefetch(topology.opposite.data() + across);
    }
    std::uint32_t& all = valence[topology.corner_vertex[start]];
    if (all == 0 || topology.degenerate(start / 3)) continue;
    std::uint32_t h = start, fan = 1, o;
    for (;; ++fan) {  // in one direction, until the start or a boundary
      o = topology.opposite[previous_half_edge(h)];
      if (o == kNoIndex || o == start) break;
      h = o;
    }
    if (o == kNoIndex) {
      for (o = topology.opposite[start]; o != kNoIndex; o = topology.opposite[h], ++fan) {
        h = next_half_edge(o);
      }
    }
    topology.defects.nonmanifold_vertices += fan < all;
    all = 0;
  }
}

}  // namespace

Result<WeldedVertices> weld_mesh(const MeshView& mesh) {
  if (Status status = check_input(mesh); !status.ok()) return status;
  const std::vector<std::uint8_t> used = used_vertices(mesh.indices, mesh.positions.size());
  if (Status status = check_positions(mesh, used); !status.ok()) return status;
  return weld_vertices(mesh.positions, used, mesh.objects);
}

Result<Topology> build_topology(const MeshView& mesh, const TopologyOptions& options,
                                const Context& context) {
  Result<WeldedVertices> welded = weld_mesh(mesh);
  if (!welded.ok()) return welded.status();
  std::vector<std::uint32_t> corners(mesh.indices.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = welded->place[mesh.indices[i]];
  std::vector<std::uint32_t> opposite = pair_links(corners, welded->points.size());
  return build_topology({mesh, std::move(*welded), std::move(opposite)}, options, context);
}

Result<Topology> build_topology(WeldedMesh welded, const TopologyOptions& options,
                                const Context& context) {
  const MeshView& mesh = welded.mesh;
  Topology topology;
  take_vertices(mesh, std::move(welded.vertices), topology);
  topology.opposite = std::move(welded.opposite);
  topology.polygon.assign(mesh.polygons.begin(), mesh.polygons.end());
  // Given charts are kept whatever the normals are.
  std::vector<std::uint32_t> thin = measure_triangles(topology, !options.cut_at_uv_seams);
  if (context.cancelled()) return Status::cancelled();
  link_half_edges(mesh, options, topology);
  borrow_normals(topology, std::move(thin));
  if (context.cancelled()) return Status::cancelled();
  Pieces(topology).run();
  count_nonmanifold_vertices(topology);
  Stopwatch watch(own_cpu_seconds);
  calm_noise(topology, context);
  topology.noise_cpu = watch.lap();
  return topology;
}

}  // namespace atlas

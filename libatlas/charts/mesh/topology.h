// Internal: the working copy of a mesh that chart segmentation runs on. Positions are welded where
// they are bitwise equal, once coordinates that are nothing but rounding are 0; they are scaled by
// a power of two to about unit size, and triangles of one piece are turned to agree; edges know the
// half-edge across.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

struct TopologyDefects {
  std::uint64_t degenerate_triangles = 0, duplicate_triangles = 0, nonmanifold_edges = 0,
                nonmanifold_vertices = 0, misoriented_edges = 0;
};

// Half-edge h = 3 t + c runs from corner c of triangle t to corner (c + 1) % 3.
struct Topology {
  enum Flag : std::uint8_t {
    kDegenerate = 1,  // no area: linked to nothing
    kFlipped = 2,     // corners 1 and 2 are exchanged against the input
  };

  std::vector<Vec3f> points;                 // welded and scaled, 1 a vertex
  std::vector<std::uint32_t> source_vertex;  // 1 a vertex: the first input vertex at its position
  std::vector<std::uint32_t> corner_vertex;  // 3 a triangle, in working order
  std::vector<std::uint32_t> opposite;       // 1 a half-edge, kNoIndex at borders
  std::vector<Vec3f> normals;                // 1 a triangle, unit; 0 if degenerate
  std::vector<Vec3f> calm_normals;           // the same without scan noise; empty: there is none
  std::vector<float> areas;                  // 1 a triangle, scaled units squared
  std::vector<std::uint8_t> flags;           // 1 a triangle, of Flag
  std::vector<std::uint32_t> component;      // 1 a triangle; kNoIndex if degenerate
  std::uint32_t component_count = 0;
  std::size_t whole_triangles = 0;  // of the mesh that this is a part of; 0: it is all
  double cut_length = 0;  // of edges that exactly two triangles share without a link, input units
  double scale = 1;       // points = positions * scale, a power of two
  double noise_cpu = 0;   // seconds that calm_normals took
  TopologyDefects defects;
  // Linked half-edges (one of each pair) of edges that more than two triangles share.
  std::vector<std::uint32_t> fan_links;

  std::size_t triangle_count() const { return flags.size(); }
  bool degenerate(std::uint32_t t) const { return flags[t] & kDegenerate; }
  const Vec3f& calm_normal(std::uint32_t t) const {
    return calm_normals.empty() ? normals[t] : calm_normals[t];
  }
  // The corner of the input triangle that working corner h stands for.
  std::uint32_t input_corner(std::uint32_t h) const {
    const std::uint32_t t = h / 3, c = h % 3;
    return (flags[t] & kFlipped) && c ? 3 * t + 3 - c : h;
  }
};

inline std::uint32_t next_half_edge(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
inline std::uint32_t previous_half_edge(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

// Scaled units.
inline double edge_length(const Topology& topology, std::uint32_t half_edge) {
  const Vec3f& a = topology.points[topology.corner_vertex[half_edge]];
  const Vec3f& b = topology.points[topology.corner_vertex[next_half_edge(half_edge)]];
  const double x = double{b.x} - a.x, y = double{b.y} - a.y, z = double{b.z} - a.z;
  return std::sqrt(x * x + y * y + z * z);
}

// Where triangles that share an edge are nevertheless not linked.
struct TopologyOptions {
  bool cut_at_materials = true;  // where MeshView::materials differ
  bool cut_at_uv_seams = false;  // where the corners' texcoords differ
};

// Linear in the number of triangles. Edges of more than two triangles are paired by flatness and
// otherwise left open; an edge that no orientation satisfies (a Möbius strip) is cut; duplicates
// (same three vertices) are never linked to their original.
// Errors: bad_input for an index out of range, a position that is not finite, or no triangle.
Result<Topology> build_topology(const MeshView& mesh, const TopologyOptions& options,
                                const Context& context);

}  // namespace atlas

// Internal: the working copy of a mesh that chart segmentation runs on. Positions are welded where
// they are bitwise equal, after coordinates that are mere rounding have become 0, and scaled by a
// power of two to about unit size. The triangles of a piece are turned to agree. Half-edges know
// their opposite half-edge.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/mesh/uv_aspects.h"
#include "libatlas/core/context.h"
#include "libatlas/core/half_edge.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

struct TopologyDefects {
  std::uint64_t degenerate_triangles = 0, duplicate_triangles = 0, nonmanifold_edges = 0,
                nonmanifold_vertices = 0, misoriented_edges = 0;
};

// Half-edges are numbered as in core/half_edge.h.
struct Topology {
  enum Flag : std::uint8_t {
    kDegenerate = 1,  // without area, and linked to nothing with area
    kFlipped = 2,     // corners 1 and 2 are swapped against the input
    kThin = 4,        // without area, but linked: its area is 0, its normal a neighbour's
  };

  std::vector<Vec3f> points;                 // welded and scaled, one per vertex
  std::vector<std::uint32_t> source_vertex;  // one per vertex: the first input vertex at its
                                             // position
  std::vector<std::uint32_t> corner_vertex;  // three per triangle, in working order
  std::vector<std::uint32_t> opposite;       // one per half-edge, kNoIndex at boundaries
  std::vector<Vec3f> normals;                // one per triangle, unit length; 0 if degenerate
  std::vector<Vec3f> calm_normals;       // the same without scan noise; empty if there is no noise
  std::vector<float> areas;              // one per triangle, scaled units squared
  std::vector<std::uint8_t> flags;       // one per triangle: a combination of Flag
  std::vector<std::uint32_t> component;  // one per triangle: its piece; kNoIndex if degenerate
  std::uint32_t component_count = 0;
  // One per triangle: equal for those of one polygon; empty without polygons.
  std::vector<std::uint32_t> polygon;
  std::vector<float> seam_weights;  // one per vertex; empty: all are 1
  // The number of triangles of the mesh that this is a part of; 0: this is the whole mesh.
  std::size_t whole_triangles = 0;
  // The length of edges that exactly two triangles share without a link, in input units.
  double cut_length = 0;
  double scale = 1;      // points = positions * scale, a power of two
  double noise_cpu = 0;  // CPU seconds that calm_normals took
  TopologyDefects defects;
  // One half-edge of each linked pair at edges that more than two triangles share.
  std::vector<std::uint32_t> fan_links;

  std::size_t triangle_count() const { return flags.size(); }
  bool degenerate(std::uint32_t t) const { return flags[t] & kDegenerate; }
  bool thin(std::uint32_t t) const { return flags[t] & kThin; }
  const Vec3f& calm_normal(std::uint32_t t) const {
    return calm_normals.empty() ? normals[t] : calm_normals[t];
  }
  // Whether h is linked and lies inside a polygon, where no seam may run.
  bool inner(std::uint32_t h) const {
    return !polygon.empty() && opposite[h] != kNoIndex &&
           polygon[h / 3] == polygon[opposite[h] / 3];
  }
  // What a seam along h counts, as a multiple of its length: MeshView::seam_weights.
  double seam_weight(std::uint32_t h) const {
    if (seam_weights.empty()) return 1;
    return 0.5 * (double{seam_weights[corner_vertex[h]]} +
                  double{seam_weights[corner_vertex[next_half_edge(h)]]});
  }
  // Returns the corner of the input triangle that working corner h corresponds to.
  std::uint32_t input_corner(std::uint32_t h) const {
    const std::uint32_t t = h / 3, c = h % 3;
    return (flags[t] & kFlipped) && c ? 3 * t + 3 - c : h;
  }
};

// In scaled units.
inline double edge_length(const Topology& topology, std::uint32_t half_edge) {
  const Vec3f& a = topology.points[topology.corner_vertex[half_edge]];
  const Vec3f& b = topology.points[topology.corner_vertex[next_half_edge(half_edge)]];
  const double x = double{b.x} - a.x, y = double{b.y} - a.y, z = double{b.z} - a.z;
  return std::sqrt(x * x + y * y + z * z);
}

// Where triangles that share an edge are not linked although they could be, besides
// MeshView::seams.
struct TopologyOptions {
  bool cut_at_materials = true;  // where MeshView::materials differ
  // Where the corners' texcoords differ, or the aspects of their pages.
  bool cut_at_uv_seams = false;
  UvAspects uv_aspects = {};  // for cut_at_uv_seams
};

// Builds the working copy of a mesh, in time linear in the number of triangles. Edges of more than
// two triangles are linked in the pairs that continue each other best (see FanPairing), and
// otherwise left open. Triangles that agree with each other are turned together or not at all, and
// an edge that no orientation satisfies then (as on a Möbius strip) is cut.
// Duplicate triangles (with the same three vertices) are linked to their original only where the
// two are turned against each other and nothing else continues them. Errors: bad_input for an index
// out of range, a position that is not finite, no triangle, or wrong materials or densities;
// unsupported for more than 2^30 triangles; cancelled.
Result<Topology> build_topology(const MeshView& mesh, const TopologyOptions& options,
                                const Context& context);

}  // namespace atlas

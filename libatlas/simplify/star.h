// Internal: a vertex with its surroundings, and the effect of merging it into a neighbour.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/simplify/chart_mesh.h"

namespace atlas::simplify {

// The effect of merging a vertex v into its neighbour w.
struct Estimate {
  std::uint32_t v = kNoIndex, w = kNoIndex;
  double cost = 0;  // dimensionless: (slip / bound)² + (small factor x length in texels)², and more
                    // if needles arise
  double offset = 0;     // distance in space between v and the new surface at its uv, texels
  bool outside = false;  // v's uv lies outside the new triangles (border vertices only)
};

// The surroundings of the current vertex, fetched once for all its targets. A target is a neighbour
// that the vertex could be merged into, given as an index into the ring.
struct Star {
  Ring ring;
  std::uint32_t vertex = kNoIndex;
  glm::dvec2 uv;
  glm::dvec3 position;
  std::vector<glm::dvec2> uvs;        // of the neighbours
  std::vector<glm::dvec3> positions;  // likewise
  std::vector<glm::dvec3> normals;    // unit, of the faces; 0 where there is no area
  double worst_quality = 1;

  std::size_t size() const { return ring.vertices.size(); }
  std::size_t after(std::size_t i) const { return i + 1 == size() ? 0 : i + 1; }
  bool keeps(std::size_t face, std::size_t target) const {
    return face != target && after(face) != target;
  }

  // Fills normals and worst_quality from the members before them.
  void measure_faces();

  // Collects the neighbours that are tried: all of them, or the nearest ones if there are many.
  void pick_targets(std::vector<std::size_t>& out) const;

  // Returns false if a new triangle would be turned over or be much thinner than the old ones, or
  // if no triangle would be left. `texel` is the length of a texel on the surface, and `slip` the
  // bound of the slip in texels.
  bool judge(std::size_t target, double texel, double slip, Estimate& out) const;

  // The largest distance, in scene units, between the surfaces before and after the collapse, at
  // the uvs where a removed edge crosses a new one. (At the vertex itself the distance is
  // Estimate::offset.)
  double step_slip(std::size_t target) const;
  double step_turn(std::size_t target) const;  // largest angle between old and new faces, radians

 private:
  bool locate(std::size_t target, double texel, Estimate& out) const;
};

}  // namespace atlas::simplify

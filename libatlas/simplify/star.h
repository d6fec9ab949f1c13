// Internal: a vertex and what lies around it, and what merging it into a neighbour would do.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/simplify/chart_mesh.h"

namespace atlas::simplify {

// What merging a vertex v into its neighbour w would do.
struct Estimate {
  std::uint32_t v = kNone, w = kNone;
  double cost = 0;  // dimensionless: (slip / bound)² + (small factor x length in texels)², worse
                    // for needles
  double offset = 0;     // distance in space between v and the new surface at its uv, texels
  bool outside = false;  // v's uv lies outside the new triangles (border vertices only)
};

// The surroundings of the vertex at hand, fetched once for all its targets. Targets are numbers of
// neighbours in the ring.
struct Star {
  Ring ring;
  std::uint32_t vertex = kNone;
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

  // Fills normals and worst_quality from what comes before them.
  void measure_faces();

  // The neighbours that are tried: all, or the nearest of many.
  void pick_targets(std::vector<std::size_t>& out) const;

  // False where new triangles would be turned, much thinner than the old ones, or none. `texel` is
  // its length on the surface, `slip` the bound in texels.
  bool judge(std::size_t target, double texel, double slip, Estimate& out) const;

  // Largest distance between the surfaces before and after, at the same uv, where an edge that goes
  // crosses one that comes. (At the vertex itself it is Estimate::offset.)
  double step_slip(std::size_t target) const;
  double step_turn(std::size_t target) const;  // largest angle between old and new faces, radians

 private:
  bool locate(std::size_t target, double texel, Estimate& out) const;
};

}  // namespace atlas::simplify

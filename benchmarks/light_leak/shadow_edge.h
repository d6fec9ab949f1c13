// Finds where the light on an object drops sharply: the edge of a shadow as the fine mesh holds it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/scene/scene.h"

namespace atlas::bench {

struct ShadowEdgeOptions {
  std::string object = "door";  // a name in Scene::object_names
  double drop = 0.5;            // relative to the larger value at a mesh edge's two ends
  // Mesh edges longer than this, in metres, do not count: the mesh does not resolve an edge there.
  double length = 0.02;
  double spacing = 0.0005;  // of the points along the shadow edge, metres
};

// A mesh edge crosses the shadow edge if the luma (Rec. 709) of the illuminance at its ends differs
// by more than `drop` times the larger value, if that value is at least the object's mean (nobody
// sees edges in the dark), and if the mesh edge is at most `length` long. The crossing is where the
// value, linear along the mesh edge, is the mean of both. In a triangle with two crossings (with
// three: for every pair) the straight line between them is a piece of the shadow edge. A lone
// crossing counts as a point.
struct ShadowEdge {
  std::vector<std::uint32_t> triangles;  // triangles of the object
  std::vector<Vec3f> points;             // along the edge, at most `spacing` apart; scene units
  double length = 0;                     // of all pieces, metres
};

ShadowEdge find_shadow_edge(const Scene& scene, const ShadowEdgeOptions& options);

// Nearest-point queries up to a fixed radius, by a hash grid.
class NearPoints {
 public:
  NearPoints(const std::vector<Vec3f>& points, double radius);
  // Returns the distance to the nearest point, or infinity if it exceeds the radius.
  double distance(Vec3d p) const;

 private:
  struct Cell {
    std::uint64_t key;
    std::uint32_t point;
  };
  std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) const;
  const std::vector<Vec3f>& points_;
  double radius_;
  std::vector<Cell> cells_;  // sorted by key
};

}  // namespace atlas::bench

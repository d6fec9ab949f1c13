// Where on an object the light drops sharply: the edge of a shadow as the fine mesh holds it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/scene/scene.h"

namespace atlas::bench {

struct ShadowEdgeOptions {
  std::string object = "door";  // Scene::object_names
  double drop = 0.5;            // of the larger value at a mesh edge's two ends
  double length = 0.02;         // mesh edges longer than this do not count, metres: the mesh does
                                // not resolve an edge there
  double spacing = 0.0005;      // of the points along the shadow's edge, metres
};

// A mesh edge crosses the shadow's edge where the luma (Rec. 709) of the illuminance at its ends
// differs by more than `drop` times the larger one, which is at least the object's mean (nobody
// sees edges in the dark), and it is at most `length` long. The crossing lies where the value,
// linear along the mesh edge, is the mean of both. In a triangle
// with two crossings (three: every pair) the straight line between them is a piece of the shadow's
// edge; a lone crossing counts as a point.
struct ShadowEdge {
  std::vector<std::uint32_t> triangles;  // of the object
  std::vector<Vec3f> points;             // along the edge, at most `spacing` apart; scene units
  double length = 0;                     // of all pieces, metres
};

ShadowEdge find_shadow_edge(const Scene& scene, const ShadowEdgeOptions& options);

// Nearest-point queries up to a fixed radius, by a hash grid.
class NearPoints {
 public:
  NearPoints(const std::vector<Vec3f>& points, double radius);
  // Distance to the nearest point, or infinity when it exceeds the radius.
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

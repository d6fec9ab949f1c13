// Measures a UV atlas from an OBJ alone, by whoever made it: the project's own judge, independent
// of the library that it judges.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas::test {

// A mesh with texture coordinates; every material is one page.
struct UvMesh {
  struct Face {
    std::array<std::uint32_t, 3> position, uv;
    std::uint32_t page = 0;
  };
  std::vector<Vec3d> positions;
  std::vector<Vec2d> uvs;  // 0..1 a page
  std::vector<Face> faces;
  std::uint32_t pages = 1;
  std::uint64_t faces_without_uv = 0;  // left out of faces
};

// Polygons are cut into fans. Errors: not_found, bad_input (an index out of range).
Result<UvMesh> read_uv_obj(const std::filesystem::path& path);

// The chart of every face: faces that share a texture coordinate, numbered as they come.
std::vector<std::uint32_t> charts_by_texcoord(const UvMesh& mesh);

struct AtlasMeasures {
  std::uint64_t triangles = 0, faces_without_uv = 0, charts = 0, pages = 0;
  double scale = 0;         // texels per unit: sqrt(uv area in texels² / surface area)
  double stretch_l2 = 0;    // Sander et al. 2001, whole mesh at that one scale; 1 is perfect
  double stretch_linf = 0;  // largest
  double stretch_999 = 0;   // that 99.9 % of the area stays within
  double conformal_mean = 0, conformal_999 = 0,
         conformal_max = 0;      // larger / smaller singular value
  double dirichlet_mean = 0;     // symmetric Dirichlet energy / 4; 1 is perfect
  double utilization = 0;        // sum of |uv area| / area of all pages
  double covered = 0;            // share of texels whose centre lies in a triangle
  std::uint64_t flipped = 0;     // triangles against their chart's majority
  std::uint64_t mirrored = 0;    // charts of negative orientation
  std::uint64_t degenerate = 0;  // uv area < 1e-12 of a page, though the surface's is not
  std::uint64_t outside = 0;     // triangles that leave their page
  std::uint64_t overlap = 0;     // texels whose centre lies in more than one triangle
  std::uint64_t bleed = 0;       // texels that bilinear lookups of two charts touch
  double seam = 0;               // length of inner edges that are chart borders / sqrt(area)
};

// Pages are width x height texels. Triangles are connected where they share an edge by place, page
// and both texture coordinates. Centre tests snap to 1/256 texel and follow the top-left rule.
AtlasMeasures measure_atlas(const UvMesh& mesh, int width, int height);

}  // namespace atlas::test

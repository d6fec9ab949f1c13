// Measures a UV atlas from an OBJ file alone, whatever program made it. It is independent of the
// library that it judges.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas::test {

// A mesh with texture coordinates. Every material is one page.
struct UvMesh {
  struct Face {
    std::array<std::uint32_t, 3> position, uv;
    std::uint32_t page = 0;
  };
  std::vector<Vec3d> positions;
  std::vector<Vec2d> uvs;  // 0 to 1 within a page
  std::vector<Face> faces;
  std::uint32_t pages = 1;
  std::uint64_t faces_without_uv = 0;  // not contained in `faces`
};

// Reads an OBJ and divides polygons into fans. Errors: not_found, bad_input (an index out of
// range).
Result<UvMesh> read_uv_obj(const std::filesystem::path& path);

// Returns the chart of every face. Faces that share a texture coordinate belong to one chart;
// charts are numbered in order of appearance.
std::vector<std::uint32_t> charts_by_texcoord(const UvMesh& mesh);

struct AtlasMeasures {
  std::uint64_t triangles = 0, faces_without_uv = 0, charts = 0, pages = 0;
  double scale = 0;         // texels per unit: sqrt(uv area in texels² / surface area)
  double stretch_l2 = 0;    // Sander et al. 2001, whole mesh at that one scale; 1 is perfect
  double stretch_linf = 0;  // the largest
  double stretch_999 = 0;   // bound that 99.9 % of the area stays within
  double conformal_mean = 0, conformal_999 = 0,
         conformal_max = 0;      // ratio of larger to smaller singular value
  double dirichlet_mean = 0;     // symmetric Dirichlet energy / 4; 1 is perfect
  double utilization = 0;        // sum of |uv area| / area of all pages
  double covered = 0;            // share of texels whose centre lies in a triangle
  std::uint64_t flipped = 0;     // triangles oriented against their chart's majority
  std::uint64_t mirrored = 0;    // charts of negative orientation
  std::uint64_t degenerate = 0;  // triangles with uv area < 1e-12 of a page but area on the surface
  std::uint64_t outside = 0;     // triangles that leave their page
  std::uint64_t overlap = 0;     // texels whose centre lies in more than one triangle
  std::uint64_t bleed = 0;       // texels that bilinear lookups of two charts read
  double seam = 0;               // length of inner edges that are chart borders / sqrt(area)
};

// Measures pages of width x height texels. Triangles are connected where they share an edge with
// equal positions, page and both texture coordinates. Tests of texel centres snap corners to 1/256
// texel and follow the top-left rule.
AtlasMeasures measure_atlas(const UvMesh& mesh, int width, int height);

}  // namespace atlas::test

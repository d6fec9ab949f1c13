// Internal: the uvs that the triangles of a mesh take over from an earlier one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/unwrap/like.h"
#include "libatlas/unwrap/like/joined_mesh.h"
#include "libatlas/unwrap/like/match_triangles.h"
#include "libatlas/unwrap/like/page_grid.h"

namespace atlas {

// What a triangle has of the earlier mesh.
enum class TakenState : std::uint8_t {
  none,    // nothing
  beside,  // a place beside triangles that have theirs
  moved,   // the place of a triangle whose corners lay elsewhere
  same,    // the place of the same triangle
};

struct TakenUvs {
  std::vector<TakenState> state = {};          // one per triangle
  std::vector<TexelCorners> texels = {};       // one per triangle, in the order of its corners
  std::vector<std::uint32_t> chart = {};       // one per triangle: the earlier chart, or kNoIndex
  std::vector<std::uint32_t> chart_page = {};  // one per earlier chart
  // One per earlier chart: how many triangles it had.
  std::vector<std::uint32_t> chart_triangles = {};
  // One per half-edge: the earlier mesh had a seam there, or both sides are not one chart.
  std::vector<std::uint8_t> seams = {};
  std::size_t with_uvs = 0;  // triangles of the earlier mesh whose uvs are usable
  std::size_t matched = 0;   // triangles that match one of it

  bool any() const { return !chart.empty() && matched > 0; }
};

struct UvPair {
  const JoinedMesh& mesh;
  const JoinedMesh& earlier_mesh;
  const EarlierUvs& earlier;
};

// Takes over the uvs of the triangles that match. Charts that lie on others, the smaller ones of
// each two, or on themselves are left out. `grid` receives what is taken over; the owner of a
// triangle is its earlier chart.
TakenUvs take_uvs(const UvPair& pair, PageGrid& grid);

// How far triangles may overlap by rounding, in texels of pages of this size.
double rounding_of(std::span<const Extent> pages);

}  // namespace atlas

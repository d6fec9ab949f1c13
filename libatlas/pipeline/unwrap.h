// A mesh in memory, unwrapped in one call: charts, packed onto pages, as vertices to draw with.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/bake/placement.h"
#include "libatlas/charts/charts.h"
#include "libatlas/charts/gaps.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/pack.h"

namespace atlas {

struct UnwrapOptions {
  ChartOptions charts = {};
  std::uint32_t pages = 1;        // at most, >= 1
  std::int32_t page_size = 2048;  // largest side of a page, texels, 64 to 16384
  std::int32_t padding = 2;       // texels kept free around each chart, >= 0
  // To bake the pages with as many mip levels (BakeOptions::mip_levels), 0 to 10: from 1 on each
  // chart gets gutter_pad(mip_levels) texels of padding at least, and whole cells of 2^mip_levels
  // texels. To bake with 0, a padding of 1 does.
  std::int32_t mip_levels = 0;
  // Boxes and cells of charts begin and end at multiples of this, in texels, >= 1 (4 for textures
  // compressed in blocks). More where mip_levels ask for it.
  std::int32_t alignment = 1;
  bool allow_rotation = true;  // charts are turned to pack better; else they lie as their uvs do
  PackPreset packing = PackPreset::standard;
  // Texels along a unit of length, the same for all charts; 0: as many as the pages hold. Where
  // they hold less all charts get less; UnwrappedMesh::texels_per_unit tells. A single page that is
  // not square is made as full as it can be, not its charts as large.
  double texels_per_unit = 0;
  // Sides are powers of two (page_size must be one), and equal. Else a single page has the shape
  // that packs best, which textures for it must share; several have sides of powers of two.
  bool square = false;
  // Parts of one chart that are far apart on the surface are kept apart on the page, too, as charts
  // are: for lightmaps, since bilinear look-ups would mix the light of both. Uvs stretch a little
  // more there, within ChartOptions::max_stretch.
  bool part_gaps = false;
};

// Each vertex is a copy of one of the input's; those along seams are there once for each side.
struct UnwrappedMesh {
  std::vector<std::uint32_t> vertices;       // 1 a vertex: the vertex of the input it is a copy of
  std::vector<Vec2f> uvs;                    // 1 a vertex: 0..1 over its page, origin bottom left
  std::vector<std::uint32_t> indices;        // 3 a triangle, input order, into vertices and uvs
  std::vector<std::uint32_t> triangle_page;  // 1 a triangle, into pages
  std::vector<Extent> pages;                 // texels
  double texels_per_unit = 0;                // reached
  double utilization = 0;                    // area of the charts / area of the pages
  std::uint64_t thin_triangles = 0;          // slivers that floats leave no area, or turn over
  // Texels whose centres more than one triangle covers once corners are rounded to 1/256 of a
  // texel, as graphics hardware does: 0 but for masses of slivers, and where mip levels leave no
  // padding to spare that charts could be moved into by a hair.
  std::uint64_t texels_drawn_twice = 0;
  GapReport gaps;                          // texels; what part_gaps left; else zeros
  ChartSet charts;                         // with all that was measured: distortion, seams
  std::vector<ChartPlacement> placements;  // 1 a chart
};

// Nothing is left out: triangle t of the input is triangle t of the result, its corners in the same
// order. Triangles that the mesh holds the wrong way round against their neighbours
// (ChartSet::flipped_triangles) are the only ones whose uvs turn clockwise. Charts that leave the
// pages poorly filled are cut (ChartOptions::min_fill). MeshView::texcoords,
// for ChartOptions::keep_uv_charts, may go without texcoord_indices if there is one a vertex.
// The result is the same for every thread count.
// Errors: those of make_charts; bad_option; no_solution (more charts than the pages hold texels
// for); cancelled.
Result<UnwrappedMesh> unwrap_mesh(const MeshView& mesh, const UnwrapOptions& options,
                                  const Context& context);

}  // namespace atlas

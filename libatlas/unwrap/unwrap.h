// Unwraps a mesh in memory in one call: makes charts, packs them onto pages, and returns vertices
// to draw with.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/gaps.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/pages.h"
#include "libatlas/unwrap/like.h"
#include "libatlas/uvs/placement.h"

namespace atlas {

// Of the pages, page_size is 64 to 16384 texels, and padding and alignment are at most a quarter of
// it. With `square`, page sides are equal and powers of two (page_size must be one). Otherwise a
// single page has the shape that packs best, and textures for it must have the same shape; several
// pages have sides that are powers of two.
struct UnwrapOptions : PageOptions {
  ChartOptions charts = {};
  // Prepares the pages to be baked with this many mip levels (BakeOptions::mip_levels), 0 to 10.
  // From 1 on, each chart gets at least gutter_pad(mip_levels) texels of padding, and whole cells
  // of 2^mip_levels texels, and the uvs of slivers lie within a texel of where the placements say
  // that light is baked. A padding of 1 is enough to bake with 0.
  std::int32_t mip_levels = 0;
  // Texels per unit of length, the same for all charts, times MeshView::density where that is
  // given; 0 for as many as the pages hold, and then charts that are longer than the page that the
  // others fill, and cannot be cut, have fewer (Context::warn names them). If the pages hold less
  // than was asked for, all charts get less, see UnwrappedMesh::texels_per_unit. A single page that
  // is not square is made as full as possible, instead of making its charts as large as possible.
  double texels_per_unit = 0;
  // Parts of one chart that are far apart on the surface are kept apart on the page, too, like
  // different charts. Lightmaps need this, because bilinear look-ups would otherwise mix the light
  // of both parts. The uvs stretch a little more there, within ChartOptions::max_stretch.
  bool part_gaps = false;
  // An earlier state of the mesh with its uvs, or null. Charts whose triangles are unchanged stay
  // as they were, to the last bit of their uvs; charts of which triangles changed are repaired
  // where they lie, if max_stretch allows it. What is new takes free room at the same density; the
  // pages are the earlier ones, and others are added, or they grow, if that is not enough.
  // texels_per_unit and page_size then count only if nothing is found again, which is told to
  // Context::warn. Not with keep_uv_charts.
  const EarlierUvs* like = nullptr;
};

// The options for lightmaps of game engines: `square` pages, whose mip levels 0 to 2 can be built
// and whose blocks of 4 x 4 texels can be compressed without mixing charts; `part_gaps`; and a
// texel of padding more than that takes, within which charts are moved until no texel is drawn
// twice. `texels_per_metre`: 0 for as many as the pages hold. `metres_per_unit`: of the positions.
UnwrapOptions lightmap_options(double texels_per_metre, double metres_per_unit = 1);

// Each vertex is a copy of one of the input's vertices. A vertex on a seam has a copy for each
// side.
struct UnwrappedMesh {
  std::vector<std::uint32_t> vertices = {};  // one per vertex: the input vertex that it copies
  std::vector<Vec2f> uvs = {};  // one per vertex: 0..1 over its page, origin bottom left
  // Three per triangle, input order; into vertices and uvs.
  std::vector<std::uint32_t> indices = {};
  std::vector<std::uint32_t> triangle_page = {};  // one per triangle, into pages
  std::vector<Extent> pages = {};                 // texels
  // That were reached, where MeshView::density is 1. Charts that are too long for it have less, see
  // ChartPlacement::texels_per_unit.
  double texels_per_unit = 0;
  double utilization = 0;            // area of the charts / area of the pages
  std::uint64_t thin_triangles = 0;  // slivers that rounding to floats closes or turns over
  // How many texels have centres that more than one triangle covers once corners are rounded to
  // 1/256 of a texel, as graphics hardware does. There are none except with very many slivers, or
  // where mip levels leave no spare padding within which charts could be moved by fractions of a
  // texel.
  std::uint64_t texels_drawn_twice = 0;
  // The charts that part_gaps changed, and the border in texels that is still too near on the
  // finished pages (near_after; near_before is the same). Zeros without part_gaps.
  GapReport gaps = {};
  ChartSet charts = {};                         // with what was measured on them: distortion, seams
  std::vector<ChartPlacement> placements = {};  // one per chart
  // One per chart, or empty if nothing of UnwrapOptions::like was found again. Texels of charts
  // that were kept need not be made again.
  std::vector<ChartOrigin> origins = {};
};

// An unwrapping as what the next one of the mesh is to be like. Both arguments, and what the mesh
// points at, must outlive it.
EarlierUvs earlier_uvs(const MeshView& mesh, const UnwrappedMesh& unwrapped);

// Unwraps a mesh. Nothing is left out: triangle t of the input is triangle t of the result, with
// its corners in the same order. Only triangles whose orientation in the mesh is opposite to that
// of their neighbours (ChartSet::flipped_triangles) get clockwise uvs. Charts that leave the pages
// poorly filled are cut (ChartOptions::min_fill). MeshView::texcoords, for
// ChartOptions::keep_uv_charts, need no texcoord_indices if there is one texcoord per vertex. The
// result is the same for every thread count.
// Errors: those of make_charts; bad_option; no_solution (more charts than the pages hold texels
// for); cancelled.
Result<UnwrappedMesh> unwrap_mesh(const MeshView& mesh, const UnwrapOptions& options,
                                  const Context& context);

}  // namespace atlas

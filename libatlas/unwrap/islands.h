// Packs the islands of uvs that are there anew, and leaves their shapes as they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/pack/pages.h"

namespace atlas {

// Triangles that name a uv in common are one island, whatever they cover.
struct IslandView {
  std::span<const Vec2f> uvs = {};              // finite and below 1e6 where they are named
  std::span<const std::uint32_t> indices = {};  // 3 a triangle, into uvs
};

// Of the pages, page_size is 64 to 16384 texels, and padding and alignment are at most a quarter of
// it. Sides of square and of several pages are powers of two; otherwise a single page has the shape
// that packs best. Rotation is by any angle.
struct IslandOptions : PageOptions {
  // Texels of the page per unit of uv, finite; 0 for as many as the pages hold. If the pages hold
  // less, all islands get less, see PackedIslands::texels_per_uv.
  double texels_per_uv = 0;
};

struct PackedIslands {
  // The given uv p goes to offset + texels_per_uv · R(angle) · p, in texels of its page.
  struct Island {
    std::uint32_t page = 0;
    double angle = 0;  // radians, counterclockwise
    Vec2d offset = {};
  };
  std::vector<Vec2f> uvs = {};  // one per given uv: 0..1 over its page; (0, 0) if none names it
  std::vector<std::uint32_t> triangle_island = {};  // one per triangle
  std::vector<Island> islands = {};                 // in the order of their first triangles
  std::vector<Extent> pages = {};                   // texels
  double texels_per_uv = 0;                         // that were reached
  double utilization = 0;  // area that the islands cover / area of the pages
};

// Moves, turns and scales islands so that none lies on another. All get the same scale, none is
// mirrored, and those that lie on themselves still do. The result is the same for every thread
// count.
// Errors: bad_input where there is no triangle, an index is out of range, a uv is not usable, or no
// island has an extent; bad_option; no_solution (more islands than the pages hold texels for);
// cancelled.
Result<PackedIslands> pack_islands(const IslandView& islands, const IslandOptions& options,
                                   const Context& context);

}  // namespace atlas

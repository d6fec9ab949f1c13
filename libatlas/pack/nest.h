// Internal: placing outlines on one page, and the search for a good order.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libatlas/pack/bit_page.h"

namespace atlas::pack {

// One chart in all directions tried: direction k is turned by k · 360 / directions degrees.
struct Piece {
  std::vector<Mask> masks;
  std::vector<MaskTests> tests;
  std::vector<Vec2d> origins;   // see RasterOptions; empty for coarse pieces
  std::vector<double> centers;  // height of the mask's centre of mass
  // A place's height is its foot's plus the direction's lift: half the mask's height and half the
  // height of its centre.
  std::vector<double> lifts;
  std::vector<std::uint32_t> by_fraction;  // directions by the fraction of their lifts
  bool too_large = false;  // in every direction: without masks, although the shape has corners

  std::int64_t cells() const {
    for (const Mask& m : masks)
      if (m.cells > 0) return m.cells;
    return 0;
  }
};

struct PieceOptions {
  double factor = 1;                // texels of page a texel of the shape
  std::span<const double> factors;  // 1 a shape, instead of the common factor; or empty
  std::int32_t padding = 1, cell = 1;
  std::uint32_t directions = 4;
  Extent page;  // cells; a direction in which a shape exceeds it gets no mask. 0 x 0: no limit
};

// Rasterises shapes in all directions; quarter turns are exact turns of the masks. Without a page's
// limit masks take memory by the length of the shapes.
std::vector<Piece> make_pieces(std::span<const ChartOutline> shapes, const PieceOptions& options,
                               const Context& context);

inline constexpr std::int32_t kFree = -1;

// The order in which pieces are placed, and the direction of each (kFree: the best).
struct NestPlan {
  std::vector<std::uint32_t> order;
  std::vector<std::int32_t> direction;  // 1 a piece
  // Placing ends with the piece that makes the page higher than this, which is left over.
  double most_height = std::numeric_limits<double>::infinity();
};

// Largest first, by their cells alone or by their boxes, too: large frames, as of rings, then come
// while there are pieces that lie within them.
enum class LargestBy : std::uint8_t { cells, boxes };
NestPlan plan_by_size(std::span<const Piece> pieces, LargestBy by = LargestBy::cells);

struct NestPlace {
  bool placed = false;
  std::uint32_t direction = 0;
  BitPage::Place at;

  bool operator==(const NestPlace&) const = default;
};

struct Nest {
  std::vector<NestPlace> places;         // 1 a piece
  std::vector<std::uint32_t> left_over;  // pieces without room, in order
  std::int32_t used_height = 0;
  double potential = 0;  // sum over pieces of cells × height of the centre: breaks ties of height
};

// Puts the pieces of the plan on the page one after another, each where it ends lowest: the sum of
// its foot, half its height and half the height of its centre is smallest. Pieces already in
// nest.places stay.
void place_pieces(std::span<const Piece> pieces, const NestPlan& plan, BitPage& page, Nest& nest);

// A plan, where its pieces came to lie on an empty page, and what looking for each place took.
struct PlacedPlan {
  NestPlan plan;
  Nest nest;
  std::vector<std::uint64_t> work;  // 1 a piece of the order, words; as if all had been looked for
};

// Places the plan of `placed` on the page, which is emptied first: as place_pieces() does, but
// places are taken from `like` where both plans begin alike, and where they end alike if the pieces
// between came to lie as they did. A page where that is so may lack the last pieces afterwards.
void place_pieces_as(std::span<const Piece> pieces, const PlacedPlan& like, BitPage& page,
                     PlacedPlan& placed);

std::int32_t longest_run(std::span<const Piece> pieces);

// A search for a plan that makes a strip of this width (cells) low, limited by work in words
// looked at (2 to 5 ns each), by layouts or by time; deterministic unless time is the limit.
struct NestSearchOptions {
  std::int32_t width = 0;
  std::uint64_t work = UINT64_MAX;     // words
  std::uint64_t layouts = UINT64_MAX;  // tried at most
  std::int32_t enough = 0;             // stop when the strip is this low
  std::uint64_t seed = 1;
  double seconds = 1e300;  // wall time, for `best`
};
struct NestSearchResult {
  Nest nest;                  // the lowest one found
  std::uint64_t layouts = 0;  // tried
  std::uint64_t work = 0;     // words
};
NestSearchResult search_nest(std::span<const Piece> pieces, const NestPlan& start,
                             const NestSearchOptions& options, const Context& context);

}  // namespace atlas::pack

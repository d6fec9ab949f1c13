// Internal: places outlines on one page, and searches for a good order of placing them.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "libatlas/pack/nesting/bit_page.h"
#include "libatlas/pack/nesting/pieces.h"

namespace atlas::pack {

inline constexpr std::int32_t kFree = -1;

// The order in which pieces are placed, and the direction of each (kFree: the best direction).
struct NestPlan {
  std::vector<std::uint32_t> order;
  std::vector<std::int32_t> direction;  // one per piece
  // Placing ends with the first piece that makes the page higher than this. That piece is left
  // over.
  double most_height = std::numeric_limits<double>::infinity();
  // Whether placing also ends with the first piece that finds no room. If pieces are long and thin,
  // a search in vain takes as long as hundreds of others.
  bool all_or_none = false;
  // Once it is cancelled or the deadline (wall_seconds()) has passed, place_pieces() places no
  // more. The other pieces are not left over either.
  const Context* context = nullptr;
  double deadline = std::numeric_limits<double>::infinity();
};

// Sorts by size, largest first. The size is the number of cells, or a weighted geometric mean of
// this and the area of the box. With boxes, large frames such as rings are placed while there are
// still pieces left that fit within them.
enum class LargestBy : std::uint8_t { cells, boxes };
NestPlan plan_by_size(std::span<const Piece> pieces, LargestBy by = LargestBy::cells);

// Assigns the pieces to pages, in this order, each to the page whose pieces have the fewest cells
// so far. Returns one page per piece.
std::vector<std::uint32_t> deal_out(std::span<const Piece> pieces,
                                    std::span<const std::uint32_t> order, std::uint32_t pages);

struct NestPlace {
  bool placed = false;
  std::uint32_t direction = 0;
  BitPage::Place at;

  bool operator==(const NestPlace&) const = default;
};

struct Nest {
  std::vector<NestPlace> places;         // one per piece
  std::vector<std::uint32_t> left_over;  // the pieces that found no room, in the order tried
  std::int32_t used_height = 0;
  // The sum over all pieces of cells × height of the centre; breaks ties of height.
  double potential = 0;
};

// Puts the pieces of the plan on the page one after another. Each goes where it ends lowest: where
// the sum of its foot, half its height and half the height of its centre is smallest. Places in
// nest.places of pieces that the plan does not contain are kept.
void place_pieces(std::span<const Piece> pieces, const NestPlan& plan, BitPage& page, Nest& nest);

// Returns whether searches for a place begin where one for a piece of similar size has ended, which
// is the case for many pieces. They may then miss a place that is free. For fewer pieces, a piece
// that is left over has no room on the page, neither then nor after more pieces were placed.
bool searches_skip_rows(std::size_t pieces);

// A plan, the places of its pieces on a page that was empty at first, and the work that the search
// for each place took.
struct PlacedPlan {
  NestPlan plan;
  Nest nest;
  // One per position of the order, in words; as if every place had been searched for.
  std::vector<std::uint64_t> work;
};

// Places the plan of `placed` on the page, which is emptied first. The result is that of
// place_pieces(). But if the plans of `placed` and `like` begin with the same pieces and
// directions, the places of these are copied from `like`. If the plans also end alike, the places
// at the end are copied as well, provided that the pieces in between lie as in `like`. In that case
// the page may lack the last pieces afterwards.
void place_pieces_as(std::span<const Piece> pieces, const PlacedPlan& like, BitPage& page,
                     PlacedPlan& placed);

// Limits of a search for a plan that makes a strip of this width (in cells) low. The work is
// measured in words that are examined (2 to 5 ns each). The search is deterministic unless the time
// limit ends it.
struct NestSearchOptions {
  std::int32_t width = 0;
  std::uint64_t work = UINT64_MAX;     // in words
  std::uint64_t layouts = UINT64_MAX;  // maximum number of layouts that are tried
  std::int32_t enough = 0;             // the search stops when the strip is this low
  std::uint64_t seed = 1;
  double deadline = std::numeric_limits<double>::infinity();  // wall_seconds(), for `best`
};
struct NestSearchResult {
  Nest nest;                  // the lowest nest found
  std::uint64_t layouts = 0;  // layouts tried
  std::uint64_t work = 0;     // in words
};

// A search for a low strip that can be interrupted, so that several can be compared half-way.
class NestSearch {
 public:
  // The pieces must outlive the search.
  NestSearch(std::span<const Piece> pieces, const NestPlan& start,
             const NestSearchOptions& options);
  NestSearch(NestSearch&&) noexcept;
  NestSearch& operator=(NestSearch&&) noexcept;
  ~NestSearch();

  // Searches until this share (0 to 1) of the limits of work and layouts is used up. At least the
  // start is laid out. Returns the lowest nest so far; it stays valid until the next call.
  const NestSearchResult& run(double share, const Context& context);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Searches until the limits are reached.
NestSearchResult search_nest(std::span<const Piece> pieces, const NestPlan& start,
                             const NestSearchOptions& options, const Context& context);

}  // namespace atlas::pack

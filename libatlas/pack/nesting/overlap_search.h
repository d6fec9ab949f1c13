// Internal: makes a layout of pieces on a strip lower by letting pieces overlap for a while.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "libatlas/core/context.h"
#include "libatlas/pack/nesting/nest.h"

namespace atlas::pack {

struct OverlapSearchOptions {
  std::int32_t width = 0;       // of the strip, in cells
  std::int32_t low_enough = 0;  // the search ends when the strip is this low
  std::uint64_t work = 0;       // limit, in words that are examined (2 to 5 ns each)
  std::uint64_t seed = 1;
  double deadline = std::numeric_limits<double>::infinity();  // wall_seconds(), for `best`
};

// Pushes the pieces of `nest` into a strip that is a little lower, and then searches for places at
// which they do not overlap: pieces that do are moved, one at a time, to the place where their
// overlaps weigh least, and the weight of each pair that still overlaps grows. This is guided local
// search (Egeblad et al. 2007), with the sampling and the weights of Gardeyn et al. (2025), on
// cells (Umetani and Murakami 2022). Each success replaces `nest` by the lower layout.
//
// `nest` must hold all pieces that have cells, without overlaps. The search is deterministic.
// Returns the work in words. It may exceed the limit by one round of moves.
std::uint64_t search_overlaps(std::span<const Piece> pieces, const OverlapSearchOptions& options,
                              const Context& context, Nest& nest);

}  // namespace atlas::pack

// Internal: weighs the places that a piece could take among pieces that it may overlap.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/pack/nesting/bit_page.h"

namespace atlas::pack {

// A strip of cells, each of which carries the sum of the weights of the pieces on it. The weight of
// a place is the sum over the cells that a mask would cover there, so it takes two table lookups
// for each run of the mask.
class WeightMap {
 public:
  // Places are weighed in columns of this many, one above the other, at once.
  static constexpr std::int32_t kColumn = 8;

  // Both sides are in cells.
  WeightMap(std::int32_t width, std::int32_t height);

  // Masks are added, and removed by adding them with the negative weight. They must lie within the
  // strip. sum() must follow before places are weighed; it only looks at what has changed. No place
  // that is weighed may be as heavy as 2^31.
  void clear();
  void add(const Mask& mask, BitPage::Place at, std::int32_t weight);
  void sum();

  // Returns the columns of kColumn cells that the strip consists of, about what sum() looks at.
  std::uint64_t words() const {
    return std::uint64_t(width_) * std::uint64_t(stride_) / std::uint64_t(kColumn);
  }

  // The lightest of a column of places, and the lowest of equally light ones.
  struct Lightest {
    std::int32_t weight = 0;
    BitPage::Place at;
  };

  // Weighs the places from `lowest` to `count` - 1 rows above it (count: 1 .. kColumn). The mask
  // must lie within the strip at all of them. If all places turn out to be heavier than `most`, the
  // weight that is returned is above `most`, but otherwise of no meaning.
  Lightest weigh(const Mask& mask, BitPage::Place lowest, std::int32_t count,
                 std::int32_t most) const;

 private:
  // Columns of cells follow one another, and a column begins with row 0.
  std::size_t index(std::int32_t x, std::int32_t y) const {
    return std::size_t(x) * std::size_t(stride_) + std::size_t(y);
  }

  std::int32_t width_, stride_;
  // In `steps_`, every cell holds by how much it is heavier than the cell to its left. In `sums_`,
  // it holds the sum of the weights to its left, which may wrap around: only differences are used.
  // `sums_` begins with an empty column, so that column x is its column x + 1.
  std::vector<std::uint32_t> steps_, sums_;
  std::vector<std::int32_t> changed_;  // for each band of rows: its first column that changed
};

}  // namespace atlas::pack

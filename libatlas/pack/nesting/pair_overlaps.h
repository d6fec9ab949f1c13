// Internal: by how much each pair of masks overlaps, and what its overlap weighs in a guided local
// search, in which the weights of overlaps that persist grow (Gardeyn et al. 2025).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/nesting/bit_page.h"

namespace atlas::pack {

// A mask whose box has its lower left corner at `at`.
struct PlacedMask {
  const Mask* mask = nullptr;  // nullptr: takes no part, like a mask without cells
  BitPage::Place at;
};

// Returns the number of rows that shared_cells() looks at, at least 1.
inline std::int32_t shared_rows(const PlacedMask& a, const PlacedMask& b) {
  if (a.at.x >= b.at.x + b.mask->width || b.at.x >= a.at.x + a.mask->width) return 1;
  const std::int32_t top = std::min(a.at.y + a.mask->height, b.at.y + b.mask->height);
  return std::max(1, top - std::max(a.at.y, b.at.y));
}

// Returns the number of cells that both cover.
std::int32_t shared_cells(const PlacedMask& a, const PlacedMask& b);

class PairOverlaps {
 public:
  // Weights lie between these.
  static constexpr std::int32_t kLeastWeight = 16, kMostWeight = 4096;

  // The masks must outlive this, and may be moved and replaced, but those that take part stay the
  // same. Measures nothing yet.
  explicit PairOverlaps(std::span<const PlacedMask> masks);

  // The numbers of the masks that take part.
  std::span<const std::uint32_t> taking_part() const { return taking_part_; }

  // Measures all pairs, and gives them the least weight.
  void reset();
  // Measures the pairs of mask i after it has moved.
  void measure(std::uint32_t i);
  // Raises the weights of pairs that overlap, those that overlap most by most, and lowers others.
  void raise_weights();

  bool overlaps(std::uint32_t i) const { return of_mask_[i] > 0; }  // any other mask
  std::int64_t total() const { return total_; }  // cells that pairs share, over all pairs
  std::int32_t weight(std::uint32_t i, std::uint32_t j) const { return weights_[pair(i, j)]; }

 private:
  // All pairs are held twice, as i, j and j, i.
  std::size_t pair(std::uint32_t i, std::uint32_t j) const {
    return std::size_t(i) * masks_.size() + j;
  }
  void measure(std::uint32_t i, std::uint32_t j);

  std::span<const PlacedMask> masks_;
  std::vector<std::uint32_t> taking_part_;
  std::vector<std::int32_t> cells_, weights_;
  std::vector<std::int64_t> of_mask_;
  std::int64_t total_ = 0;
};

}  // namespace atlas::pack

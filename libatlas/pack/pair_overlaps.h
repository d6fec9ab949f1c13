// Internal: how much each pair of pieces overlaps, and what its overlap weighs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/nest.h"

namespace atlas::pack {

class PairOverlaps {
 public:
  // Weights lie between these.
  static constexpr std::int32_t kLeastWeight = 16, kMostWeight = 4096;

  // Both must outlive this. Only pieces that are placed and have cells take part.
  PairOverlaps(std::span<const Piece> pieces, const std::vector<NestPlace>& places);

  // The numbers of the pieces that take part.
  std::span<const std::uint32_t> pieces() const { return taking_part_; }

  // Measures all pairs, and gives them the least weight.
  void reset();
  // Measures the pairs of piece i after it has moved.
  void measure(std::uint32_t i);
  // Raises the weights of pairs that overlap, those that overlap most by most, and lowers others.
  void raise_weights();

  bool overlaps(std::uint32_t i) const { return of_piece_[i] > 0; }  // any other piece
  std::int64_t total() const { return total_; }  // cells that pairs share, over all pairs
  std::int32_t weight(std::uint32_t i, std::uint32_t j) const { return weights_[pair(i, j)]; }

 private:
  // All pairs are held twice, as i, j and j, i.
  std::size_t pair(std::uint32_t i, std::uint32_t j) const {
    return std::size_t(i) * pieces_.size() + j;
  }
  void measure(std::uint32_t i, std::uint32_t j);

  std::span<const Piece> pieces_;
  const std::vector<NestPlace>& places_;
  std::vector<std::uint32_t> taking_part_;
  std::vector<std::int32_t> cells_, weights_;
  std::vector<std::int64_t> of_piece_;
  std::int64_t total_ = 0;
};

}  // namespace atlas::pack

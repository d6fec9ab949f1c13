#include "libatlas/pack/nesting/pair_overlaps.h"

#include <algorithm>

namespace atlas::pack {

std::int32_t shared_cells(const PlacedMask& a, const PlacedMask& b) {
  const BitPage::Place p = a.at, q = b.at;
  if (p.x >= q.x + b.mask->width || q.x >= p.x + a.mask->width) return 0;
  const std::int32_t from = std::max(p.y, q.y);
  const std::int32_t to = std::min(p.y + a.mask->height, q.y + b.mask->height);
  const std::int32_t shift = p.x - q.x;
  std::int32_t cells = 0;
  for (std::int32_t y = from; y < to; ++y)
    for (const Run& r : a.mask->row(y - p.y))
      for (const Run& s : b.mask->row(y - q.y)) {
        const std::int32_t begin = std::max(r.begin + shift, s.begin);
        cells += std::max(0, std::min(r.end + shift, s.end) - begin);
      }
  return cells;
}

PairOverlaps::PairOverlaps(std::span<const PlacedMask> masks) : masks_(masks) {
  const std::size_t n = masks.size();
  for (std::uint32_t i = 0; i < n; ++i)
    if (masks[i].mask && masks[i].mask->cells > 0) taking_part_.push_back(i);
  cells_.assign(n * n, 0);
  weights_.assign(n * n, kLeastWeight);
  of_mask_.assign(n, 0);
}

void PairOverlaps::reset() {
  for (const std::uint32_t i : taking_part_)
    for (const std::uint32_t j : taking_part_)
      if (i < j) measure(i, j);
  std::fill(weights_.begin(), weights_.end(), kLeastWeight);
}

void PairOverlaps::measure(std::uint32_t i) {
  for (const std::uint32_t j : taking_part_)
    if (i != j) measure(i, j);
}

void PairOverlaps::measure(std::uint32_t i, std::uint32_t j) {
  const std::int32_t cells = shared_cells(masks_[i], masks_[j]);
  const std::int32_t more = cells - cells_[pair(i, j)];
  if (more == 0) return;
  cells_[pair(i, j)] = cells_[pair(j, i)] = cells;
  of_mask_[i] += more;
  of_mask_[j] += more;
  total_ += more;
}

void PairOverlaps::raise_weights() {
  // By at least and at most these percentages. Other weights fall by a sixteenth.
  constexpr std::int64_t kLeast = 20, kMost = 100;
  std::int64_t most = 1;
  for (const std::int32_t cells : cells_) most = std::max<std::int64_t>(most, cells);
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    std::int32_t& w = weights_[k];
    if (cells_[k] == 0) {
      w = std::max(kLeastWeight, w - w / 16);
      continue;
    }
    const std::int64_t percent = kLeast + (kMost - kLeast) * cells_[k] / most;
    w = static_cast<std::int32_t>(std::min<std::int64_t>(kMostWeight, w + w * percent / 100));
  }
}

}  // namespace atlas::pack

#include "libatlas/pack/pair_overlaps.h"

#include <algorithm>

namespace atlas::pack {
namespace {

// Returns the number of cells that both masks cover at these places.
std::int32_t shared_cells(const Mask& a, BitPage::Place p, const Mask& b, BitPage::Place q) {
  if (p.x >= q.x + b.width || q.x >= p.x + a.width) return 0;
  const std::int32_t from = std::max(p.y, q.y), to = std::min(p.y + a.height, q.y + b.height);
  std::int32_t cells = 0;
  for (std::int32_t y = from; y < to; ++y)
    for (const Run& r : a.row(y - p.y))
      for (const Run& s : b.row(y - q.y))
        cells += std::max(
            0, std::min(r.end + p.x, s.end + q.x) - std::max(r.begin + p.x, s.begin + q.x));
  return cells;
}

}  // namespace

PairOverlaps::PairOverlaps(std::span<const Piece> pieces, const std::vector<NestPlace>& places)
    : pieces_(pieces), places_(places) {
  const std::size_t n = pieces.size();
  for (std::uint32_t i = 0; i < n; ++i)
    if (places[i].placed && pieces[i].masks[places[i].direction].cells > 0)
      taking_part_.push_back(i);
  cells_.assign(n * n, 0);
  weights_.assign(n * n, kLeastWeight);
  of_piece_.assign(n, 0);
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
  const NestPlace &p = places_[i], &q = places_[j];
  const std::int32_t now =
      shared_cells(pieces_[i].masks[p.direction], p.at, pieces_[j].masks[q.direction], q.at);
  const std::int32_t more = now - cells_[pair(i, j)];
  if (more == 0) return;
  cells_[pair(i, j)] = cells_[pair(j, i)] = now;
  of_piece_[i] += more;
  of_piece_[j] += more;
  total_ += more;
}

void PairOverlaps::raise_weights() {
  constexpr std::int64_t kRaise = 20, kRaiseMost = 100, kDecay = 16;  // percent, and a share
  const std::int64_t most = *std::max_element(cells_.begin(), cells_.end());
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    std::int32_t& w = weights_[k];
    if (cells_[k] == 0) {
      w = std::max<std::int32_t>(kLeastWeight, w - w / kDecay);
      continue;
    }
    const std::int64_t percent = kRaise + (kRaiseMost - kRaise) * cells_[k] / most;
    w = static_cast<std::int32_t>(std::min<std::int64_t>(kMostWeight, w + w * percent / 100));
  }
}

}  // namespace atlas::pack

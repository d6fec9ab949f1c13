#include "libatlas/param/repair/near_parts.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas::param {
namespace {

constexpr double kPiece = 0.5;  // share of the clearance
// Pieces per half-edge: twice the texels along the largest page.
constexpr double kMostPieces = 1 << 15;
// Pieces are found by their midpoints, which are at most this multiple of the clearance from the
// nearest point.
constexpr double kCell = 1 + kPiece;
constexpr std::uint64_t kRow = std::uint64_t{1} << 32;
// At a smaller share of the clearance the direction between two places is not reliable.
constexpr double kTouching = 0.1;

glm::dvec2 nearest(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 d = b - a;
  const double squared = glm::dot(d, d);
  return squared > 0 ? a + std::clamp(glm::dot(p - a, d) / squared, 0.0, 1.0) * d : a;
}

glm::dvec2 unit(glm::dvec2 d) {
  const double length = glm::length(d);
  return length > 0 ? d / length : glm::dvec2(0);
}

}  // namespace

NearParts::NearParts(const LocalMesh& mesh, const BorderView& edges, double clearance,
                     std::span<const Vec2d> uvs)
    : half_edges_(edges.all), clearance_(clearance), cell_(kCell * clearance) {
  for (const std::uint32_t h : edges.border.half_edges) {
    const glm::dvec3 a = to_glm(mesh.positions[half_edges_.from(h)]);
    const glm::dvec3 b = to_glm(mesh.positions[half_edges_.to(h)]);
    const double length = glm::distance(at(h, 0, uvs), at(h, 1, uvs));
    const double count = std::clamp(std::ceil(length / (kPiece * clearance)), 1.0, kMostPieces);
    const double density = mesh.density.empty() ? 1 : mesh.density[h / 3];
    for (double k = 0; k < count; ++k) {
      pieces_.push_back({h, k / count, (k + 1) / count, a + (k + 0.5) / count * (b - a), density});
    }
  }
}

glm::dvec2 NearParts::at(std::uint32_t half_edge, double along, std::span<const Vec2d> uvs) const {
  const glm::dvec2 a = to_glm(uvs[half_edges_.from(half_edge)]);
  return a + along * (to_glm(uvs[half_edges_.to(half_edge)]) - a);
}

// Returns the unit vector to the right of the border's direction, away from its triangles.
glm::dvec2 NearParts::outward(std::uint32_t half_edge, std::span<const Vec2d> uvs) const {
  const glm::dvec2 d = at(half_edge, 1, uvs) - at(half_edge, 0, uvs);
  return unit({d.y, -d.x});
}

bool NearParts::far(const Piece& a, const Piece& b) const {
  const glm::dvec3 d = a.point - b.point;
  const double apart = 2 * kFar * clearance_ / (a.density + b.density);
  return glm::dot(d, d) > apart * apart;
}

// Cells of a row have consecutive keys; the cell above one has a key larger by kRow.
void NearParts::sort_into_cells(std::span<const Vec2d> uvs) {
  middles_.clear();
  glm::dvec2 low(0);
  for (const Piece& piece : pieces_) {
    const glm::dvec2 p = at(piece.half_edge, (piece.begin + piece.end) / 2, uvs);
    low = middles_.empty() ? p : glm::min(low, p);
    middles_.push_back(p);
  }
  keys_.clear();
  cells_.clear();
  for (const glm::dvec2 p : middles_) {
    const glm::dvec2 cell = (p - low) / cell_ + 1.0;
    keys_.push_back(static_cast<std::uint64_t>(cell.y) * kRow + static_cast<std::uint64_t>(cell.x));
    cells_.push_back({keys_.back(), static_cast<std::uint32_t>(cells_.size())});
  }
  std::sort(cells_.begin(), cells_.end());
}

void NearParts::measure(std::uint32_t piece, std::span<const Vec2d> uvs) {
  const Piece& own = pieces_[piece];
  const glm::dvec2 p = middles_[piece];
  double least = clearance_;
  Place place{own.half_edge, (own.begin + own.end) / 2, 0, 0, {}};
  for (const std::uint64_t row : {keys_[piece] - kRow, keys_[piece], keys_[piece] + kRow}) {
    auto c = std::lower_bound(cells_.begin(), cells_.end(), Cell{row - 1, 0});
    for (; c != cells_.end() && c->key <= row + 1; ++c) {
      const Piece& other = pieces_[c->piece];
      const glm::dvec2 d = p - middles_[c->piece];
      if (glm::dot(d, d) > cell_ * cell_ || !far(own, other)) continue;
      const glm::dvec2 q =
          nearest(p, at(other.half_edge, other.begin, uvs), at(other.half_edge, other.end, uvs));
      const double gap = glm::distance(p, q);
      if (!(gap < least)) continue;
      least = gap;
      place.away = gap > kTouching * clearance_
                       ? (p - q) / gap
                       : unit(outward(other.half_edge, uvs) - outward(own.half_edge, uvs));
    }
  }
  if (!(least < clearance_)) return;
  place.short_by = clearance_ - least;
  place.length =
      (own.end - own.begin) * glm::distance(at(own.half_edge, 0, uvs), at(own.half_edge, 1, uvs));
  places_.push_back(place);
}

std::span<const NearParts::Place> NearParts::find(std::span<const Vec2d> uvs) {
  places_.clear();
  sort_into_cells(uvs);
  for (std::uint32_t i = 0; i < pieces_.size(); ++i) measure(i, uvs);
  return places_;
}

}  // namespace atlas::param

// Internal: several charts that are placed as one piece.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/nesting/pieces.h"
#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

// All charts, and the factors by which they are scaled.
struct ScaledCharts {
  std::span<const ChartOutline> outlines = {};
  std::span<const double> factors = {};
};

// Where a chart lies in the box of the piece's mask, and the origin of its own mask, in texels. It
// is turned by `turn` (radians) and the angle of the piece's direction.
struct JoinedPart {
  std::uint32_t chart = 0;
  double turn = 0;
  Rect cells = {};
  Vec2d origin = {};
};

struct JoinedPiece {
  Piece piece;
  std::vector<std::vector<JoinedPart>> parts;  // one list per direction, empty without a mask
};

}  // namespace atlas::pack

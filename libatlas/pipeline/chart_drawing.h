// Internal: a chart of the page as graphics hardware draws it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "libatlas/core/rect.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Where a triangle lies is decided for corners rounded to 1/256 of a texel, halves up
// (Direct3D 11.3 Functional Specification, 3.2.4; D3D12_SUBPIXEL_FRACTIONAL_BIT_COUNT).
inline constexpr int kDrawnBits = 8;
inline constexpr int kDrawnSteps = 1 << kDrawnBits;

struct UvRange {
  std::uint32_t first = 0, count = 0;
};

// Triangles that are counter-clockwise and do not overlap, drawn with such corners. Thinner ones
// than a step may then be turned over, and lie upon their neighbours.
class ChartDrawing {
 public:
  // `corners`: 3 a triangle, uvs of the range; those that name a uv twice are not drawn.
  ChartDrawing(std::span<const std::uint32_t> corners, UvRange range,
               std::span<const Vec2f> page_uvs, glm::dvec2 page);

  // Of all, how many texels' centres more than one triangle covers, when the chart is moved by so
  // many steps.
  std::size_t texels_drawn_twice(glm::ivec2 steps);
  // How many triangles floats leave no area, or turn over (thin_uvs.h), likewise.
  std::size_t thin_triangles(glm::ivec2 steps);
  // The chart's uvs, moved; 1 a uv of the range. Valid until the next call of a method.
  std::span<const Vec2f> moved(glm::ivec2 steps);

  // hits[kDrawnSteps * y + x]: how many texels' centres triangles that are turned over would cover,
  // edges included, if the chart were moved by (x, y) steps, modulo kDrawnSteps.
  std::vector<std::uint32_t> hits_of_turned();

 private:
  using Snapped = std::array<glm::i64vec2, 3>;
  Snapped snapped(std::size_t triangle) const;
  void draw(const Snapped& triangle);
  void mark(int y, int x0, int x1, bool turned);

  std::vector<std::uint32_t> corners_;  // 3 a triangle, local
  std::span<const Vec2f> uvs_;          // local
  glm::dvec2 page_;
  std::vector<Vec2f> moved_;
  std::vector<glm::i64vec2> at_;  // of moved_, steps
  Rect box_;                      // texels
  std::size_t row_words_ = 0;
  std::vector<std::uint64_t> once_, twice_;  // 1 a texel of the box
};

}  // namespace atlas

// Internal: ChartDrawing, a chart of the page as graphics hardware draws it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/ext/vector_int2_sized.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "libatlas/core/rect.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Graphics hardware decides where a triangle lies after rounding its corners to 1/256 of a texel,
// halves up (Direct3D 11.3 Functional Specification, 3.2.4; D3D12_SUBPIXEL_FRACTIONAL_BIT_COUNT).
inline constexpr int kDrawnBits = 8;
inline constexpr int kDrawnSteps = 1 << kDrawnBits;

struct UvRange {
  std::uint32_t first = 0, count = 0;
};

// Draws triangles that are counter-clockwise and do not overlap, after rounding their corners like
// this. Triangles thinner than a step may then be turned over, and lie on their neighbours. Where a
// corner lies so near to half a step that decimals or single precision may round it the other way
// (kUvSlack in thin_uvs.h), triangles that would be turned over by that count as turned over.
class ChartDrawing {
 public:
  // `corners` are three per triangle, uvs of the range. Triangles that name a uv twice are not
  // drawn. `page` is the size of the page in texels.
  ChartDrawing(std::span<const std::uint32_t> corners, UvRange range,
               std::span<const Vec2f> page_uvs, glm::dvec2 page);

  // Returns how many texels have centres that more than one triangle covers if the chart is moved
  // by `steps`.
  std::size_t texels_drawn_twice(glm::ivec2 steps);
  // Returns how many triangles floats leave no area, or turn over (thin_uvs.h), if the chart is
  // moved by `steps`.
  std::size_t thin_triangles(glm::ivec2 steps);
  // Returns the chart's uvs moved by `steps`, one per uv of the range. They are valid until the
  // next call of a method.
  std::span<const Vec2f> moved(glm::ivec2 steps);

  // Returns hits[kDrawnSteps * y + x]: how many texel centres the triangles that are turned over
  // would cover, edges included, if the chart were moved by (x, y) steps, modulo kDrawnSteps.
  std::vector<std::uint32_t> hits_of_turned();

 private:
  using Snapped = std::array<glm::i64vec2, 3>;
  Snapped snapped(std::size_t triangle) const;
  Snapped turned_most(std::size_t triangle) const;
  template <class Visit>
  void visit_turned(std::size_t triangle, const Visit& visit) const;
  void snap();
  void draw(std::size_t triangle);
  void mark(int y, int x0, int x1, bool turned);

  std::vector<std::uint32_t> corners_;  // three per triangle, into uvs_
  std::span<const Vec2f> uvs_;          // those of the range
  glm::dvec2 page_;
  std::vector<Vec2f> moved_;
  std::vector<glm::i64vec2> at_;    // positions of moved_, in steps
  std::vector<glm::i8vec2> doubt_;  // one per uv: the way to where it may also round to, or 0
  Rect box_;                        // texels
  std::size_t row_words_ = 0;
  std::vector<std::uint64_t> once_, twice_;  // one bit per texel of the box
};

}  // namespace atlas

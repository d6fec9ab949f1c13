// Integer rectangles on a texel grid. The origin of a page is at the bottom left, x points to the
// right and y up, so that uv = texel / page size without a flip; image writers reverse the order of
// the rows.
#pragma once

#include <cstdint>

namespace atlas {

struct Rect {
  std::int32_t x = 0, y = 0, width = 0, height = 0;

  std::int32_t right() const { return x + width; }
  std::int32_t top() const { return y + height; }
  std::int64_t area() const { return std::int64_t{width} * height; }
  bool operator==(const Rect&) const = default;
};

}  // namespace atlas

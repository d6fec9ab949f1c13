// Internal: which larger pages would hold what lies on many.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace atlas {

// More pages than this are worth advice, because each is a texture that viewers load and bind by
// itself. Scenes of published work have about 50 pages, and a cabin of three million triangles has
// 39.
inline constexpr std::size_t kManyPages = 64;
// The side of textures that every graphics card supports.
inline constexpr std::int32_t kCommonSide = 8192;

struct LargerPages {
  std::int32_t side = 0;   // texels
  std::int64_t count = 0;  // of pages that `texels` fill
};

// Doubles the side until half of kManyPages hold this many texels, or until it would exceed
// kCommonSide.
inline LargerPages larger_pages(double texels, std::int32_t side) {
  const auto count = [&] { return std::int64_t(std::ceil(texels / (double(side) * side))); };
  while (side <= kCommonSide / 2 && count() > std::int64_t(kManyPages) / 2) side *= 2;
  return {side, count()};
}

}  // namespace atlas

#include "libatlas/texture/light_row.h"

#include <algorithm>
#include <cstring>

#include "libatlas/texture/wide_lanes.h"

namespace atlas {
namespace {

// srgb_encode_lanes of two colours.
ATLAS_INLINE Lanes2 encode_two(Lanes2 v) {
  using namespace srgb_detail;
  constexpr float kSmallest = 1.0f / (1 << kOctaves);
  v = clamp_lanes(v, 0, 1);
  const auto bits = reinterpret_cast<IntLanes2>(v > kSmallest ? v : Lanes2{} + kSmallest);
  const IntLanes2 index = (bits - static_cast<std::int32_t>(kFirst)) >> (23 - kPieceBits);
  const IntLanes2 low = bits & ((1 << (23 - kPieceBits)) - 1);
  const Lanes2 t = __builtin_convertvector(low, Lanes2) * (1.0f / (1 << (23 - kPieceBits)));
  const auto piece = [&](int lane) { return piece_as_double(index[lane]); };
  const auto red_green = reinterpret_cast<Lanes2>(Quad{piece(0), piece(1), piece(4), piece(5)});
  const auto blue = reinterpret_cast<Lanes2>(Quad{piece(2), 0, piece(6), 0});
  const Lanes2 start = __builtin_shufflevector(red_green, blue, 0, 2, 8, 10, 4, 6, 12, 14);
  const Lanes2 rise = __builtin_shufflevector(red_green, blue, 1, 3, 9, 11, 5, 7, 13, 15);
  Lanes2 out = v < kSmallest ? v * 12.92f : start + t * rise;
  const IntLanes2 fourth{0, 0, 0, -1, 0, 0, 0, -1};
  return fourth ? Lanes2{} + 1.0f : out;
}

ATLAS_WIDE void encode_wide(float scale, int n, Lanes* colours) {
  int i = 0;
  for (; i + 1 < n; i += 2) {
    Lanes2 v;
    std::memcpy(&v, &colours[i], sizeof v);
    v = encode_two(v * scale);
    std::memcpy(&colours[i], &v, sizeof v);
  }
  if (i < n) colours[i] = srgb_encode_lanes(colours[i] * scale);
}

}  // namespace

void srgb_encode_row(float scale, int n, Lanes* colours) {
  if (has_wide_vectors) return encode_wide(scale, n, colours);
  for (int i = 0; i < n; ++i) colours[i] = srgb_encode_lanes(colours[i] * scale);
}

void multiply_by_texture(const TextureRow& row, int n, Lanes* colours) {
  const auto floor_of = [](Lanes v) {
    const IntLanes i = __builtin_convertvector(v, IntLanes);
    return i + (v < __builtin_convertvector(i, Lanes));  // the comparison gives -1 or 0
  };
  for (int first = 0; first < n; first += 4) {
    const IntLanes next{0, 1, 2, 3};
    const Lanes number = __builtin_convertvector(row.first + first + next, Lanes);
    const Lanes x = row.at.x + number * row.step.x - 0.5f,
                y = row.at.y + number * row.step.y - 0.5f;
    const IntLanes left = floor_of(x), low = floor_of(y);
    const Lanes right_share = x - __builtin_convertvector(left, Lanes);
    const Lanes high_share = y - __builtin_convertvector(low, Lanes);
    for (int k = 0; k < std::min(4, n - first); ++k)
      colours[first + k] *=
          bilinear(row.level, {left[k], low[k], right_share[k], high_share[k]}, row.wraps);
  }
}

}  // namespace atlas

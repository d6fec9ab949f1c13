#include "libatlas/texture/light_row.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "libatlas/core/wide_lanes.h"

namespace atlas {
namespace {

// Applies srgb_encode_lanes to two colours at once.
ATLAS_INLINE Lanes2 encode_two(Lanes2 v) {
  using namespace srgb_detail;
  constexpr float kSmallest = 1.0f / (1 << kOctaves);
  v = smaller_lanes(larger_lanes(v, Lanes2{}), Lanes2{} + 1.0f);
  const auto bits = reinterpret_cast<IntLanes2>(larger_lanes(v, Lanes2{} + kSmallest));
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
    const Lanes2 v = encode_two(join_lanes(colours[i], colours[i + 1]) * scale);
    std::memcpy(&colours[i], &v, sizeof v);
  }
  if (i < n) colours[i] = srgb_encode_lanes(colours[i] * scale);
}

// Four consecutive sample positions of a row, each as its lower left texel and the shares of the
// texels to the right and above.
struct Positions {
  IntLanes left, low;
  Lanes right_share, high_share;

  ATLAS_INLINE Positions(const TextureRow& row, int first) {
    const IntLanes next{0, 1, 2, 3};
    const Lanes number = __builtin_convertvector(row.first + first + next, Lanes);
    const Lanes x = row.at.x + number * row.step.x - 0.5f;
    const Lanes y = row.at.y + number * row.step.y - 0.5f;
    left = floor_of(x);
    low = floor_of(y);
    right_share = x - __builtin_convertvector(left, Lanes);
    high_share = y - __builtin_convertvector(low, Lanes);
  }

  // Replaces the positions from `count` on by the first one.
  ATLAS_INLINE void repeat_first(std::size_t count) {
    const IntLanes number{0, 1, 2, 3};
    const IntLanes beyond = number >= static_cast<std::int32_t>(count);
    left = beyond ? IntLanes{} + left[0] : left;
    low = beyond ? IntLanes{} + low[0] : low;
  }

  ATLAS_INLINE static IntLanes floor_of(Lanes v) {
    const IntLanes i = __builtin_convertvector(v, IntLanes);
    return i + (v < __builtin_convertvector(i, Lanes));  // the comparison gives -1 or 0
  }
};

template <class Texels>
ATLAS_INLINE void multiply_some(const TextureRow& row, const Texels& texels, const Positions& p,
                                std::span<Lanes> colours) {
  for (std::size_t k = 0; k < colours.size(); ++k)
    colours[k] *= bilinear(row.level, texels,
                           {p.left[k], p.low[k], p.right_share[k], p.high_share[k]}, row.wraps);
}

template <class Texels>
void multiply_narrow(const TextureRow& row, const Texels& texels, std::span<Lanes> colours) {
  for (std::size_t first = 0; first < colours.size(); first += 4)
    multiply_some(row, texels, Positions(row, static_cast<int>(first)),
                  colours.subspan(first, std::min<std::size_t>(4, colours.size() - first)));
}

using Places = std::uint32_t __attribute__((vector_size(16)));

// Two positions, each as the index of its lower left texel and the shares of the texels to the
// right and above.
struct TwoPositions {
  std::size_t at[2];
  Lanes2 right_share, high_share;
};

// Does bilinear() for two positions at once.
template <class Texels>
ATLAS_INLINE Lanes2 bilinear_two(const Texels& texel, std::size_t width, const TwoPositions& p) {
  const std::size_t i = p.at[0], j = p.at[1];
  const Lanes2 a = join_lanes(texel(i), texel(j)), b = join_lanes(texel(i + 1), texel(j + 1));
  const Lanes2 c = join_lanes(texel(i + width), texel(j + width));
  const Lanes2 d = join_lanes(texel(i + width + 1), texel(j + width + 1));
  const Lanes2 low = a + p.right_share * (b - a), high = c + p.right_share * (d - c);
  return low + p.high_share * (high - low);
}

// Multiplies four colours. None of the four texels around any of the positions may lie beyond the
// texture's edge.
template <class Texels>
ATLAS_INLINE void multiply_four(const TextureRow& row, const Texels& texels, const Positions& p,
                                Lanes* colours) {
  const auto width = static_cast<std::size_t>(row.level.width);
  // Unsigned, because the largest textures have more texels than a signed number can count.
  const Places at = reinterpret_cast<Places>(p.low) * static_cast<std::uint32_t>(width) +
                    reinterpret_cast<Places>(p.left);
  const Lanes x = p.right_share, y = p.high_share;
  const Lanes2 two[2] = {bilinear_two(texels, width,
                                      {{at[0], at[1]},
                                       __builtin_shufflevector(x, x, 0, 0, 0, 0, 1, 1, 1, 1),
                                       __builtin_shufflevector(y, y, 0, 0, 0, 0, 1, 1, 1, 1)}),
                         bilinear_two(texels, width,
                                      {{at[2], at[3]},
                                       __builtin_shufflevector(x, x, 2, 2, 2, 2, 3, 3, 3, 3),
                                       __builtin_shufflevector(y, y, 2, 2, 2, 2, 3, 3, 3, 3)})};
  for (int k = 0; k < 2; ++k) {
    // Two colours are loaded and joined, because they were stored one by one. A single load of both
    // would have to wait until the processor has completed both stores.
    const Lanes2 colour = join_lanes(colours[2 * k], colours[2 * k + 1]) * two[k];
    std::memcpy(&colours[2 * k], &colour, sizeof colour);
  }
}

template <class Texels>
ATLAS_WIDE void multiply_wide(const TextureRow& row, const Texels& texels,
                              std::span<Lanes> colours) {
  const IntLanes right = IntLanes{} + (row.level.width - 1);
  const IntLanes top = IntLanes{} + (row.level.height - 1);
  for (std::size_t first = 0; first < colours.size(); first += 4) {
    Positions p(row, static_cast<int>(first));
    const std::span<Lanes> some =
        colours.subspan(first, std::min<std::size_t>(4, colours.size() - first));
    if (some.size() < 4) p.repeat_first(some.size());
    const IntLanes within = (p.left >= 0) & (p.left < right) & (p.low >= 0) & (p.low < top);
    if ((within[0] & within[1] & within[2] & within[3]) == 0) {
      multiply_some(row, texels, p, some);
    } else if (some.size() == 4) {
      multiply_four(row, texels, p, some.data());
    } else {
      Lanes four[4]{};
      std::copy(some.begin(), some.end(), four);
      multiply_four(row, texels, p, four);
      std::copy_n(four, some.size(), some.begin());
    }
  }
}

}  // namespace

void srgb_encode_row(float scale, int n, Lanes* colours) {
  if (has_wide_vectors) return encode_wide(scale, n, colours);
  for (int i = 0; i < n; ++i) colours[i] = srgb_encode_lanes(colours[i] * scale);
}

void multiply_by_texture(const TextureRow& row, int n, Lanes* colours) {
  const std::span<Lanes> all(colours, static_cast<std::size_t>(n));
  with_texels(row.level, [&](const auto& texels) {
    has_wide_vectors ? multiply_wide(row, texels, all) : multiply_narrow(row, texels, all);
  });
}

}  // namespace atlas

// The sRGB transfer function (IEC 61966-2-1) and exact 8-bit quantisation.
#pragma once

#include <bit>
#include <cstdint>

namespace atlas {

namespace srgb_detail {

// The encoding curve between 2^-9 and 1 consists of straight pieces, 128 an octave. A float's upper
// bits are the index of the piece, and its lower bits are the position in the piece. Below 2^-9,
// which is less than 0.0031308, the curve is a line.
inline constexpr int kPieceBits = 7, kOctaves = 9;
inline constexpr std::uint32_t kFirst = (127 - kOctaves) << 23;

struct Tables {
  float decode[256];
  float threshold[257];  // the linear value from which code i is the nearest
  // The value at which a piece begins, and by how much it rises. The last piece, from 1 on, is
  // level.
  struct alignas(8) Piece {
    float start, rise;
  };
  Piece encode[(kOctaves << kPieceBits) + 1];
  Tables();
};
extern const Tables tables;

}  // namespace srgb_detail

// Returns the linear value in [0, 1] of an 8-bit sRGB code, from a table.
inline float srgb_decode8(std::uint8_t code) {
  return srgb_detail::tables.decode[code];
}

// Returns the linear value of a display value in [0, 1]. Inputs outside that range are clamped. The
// result is exact to float rounding.
float srgb_decode(float display);

// Returns the display value in [0, 1] of a linear value. Inputs outside [0, 1] are clamped, and NaN
// gives 0. The result comes from a table with linear interpolation, and is within 2e-6 of the
// definition.
inline float srgb_encode(float linear) {
  using namespace srgb_detail;
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  const auto bits = std::bit_cast<std::uint32_t>(linear);
  if (bits < kFirst) return linear * 12.92f;
  const std::uint32_t index = (bits - kFirst) >> (23 - kPieceBits);
  const auto low = static_cast<std::int32_t>(bits & ((1u << (23 - kPieceBits)) - 1));
  const float t = static_cast<float>(low) * (1.0f / (1 << (23 - kPieceBits)));
  return tables.encode[index].start + t * tables.encode[index].rise;
}

// Returns the 8-bit code nearest to 255 times the display value of `linear`. Ties are rounded up.
// The result is exact.
std::uint8_t srgb_encode8(float linear);

// Returns the 8-bit code nearest to 255 times a display value, clamped to [0, 255]. NaN gives 0.
inline std::uint8_t quantize8(float display) {
  const float scaled = display * 255.0f + 0.5f;
  if (!(scaled > 0)) return 0;
  return scaled >= 255.0f ? 255 : static_cast<std::uint8_t>(scaled);
}

}  // namespace atlas

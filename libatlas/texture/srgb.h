// The sRGB transfer function (IEC 61966-2-1) and exact 8-bit quantisation.
#pragma once

#include <cstdint>

namespace atlas {

// Linear value in [0, 1] of an 8-bit sRGB code. Table look-up.
float srgb_decode8(std::uint8_t code);

// Linear value of a display value in [0, 1]; inputs outside are clamped. Exact to float rounding.
float srgb_decode(float display);

// Display value in [0, 1] of a linear value; inputs outside [0, 1] are clamped, NaN gives 0.
// Table with linear interpolation: within 2e-6 of the definition.
float srgb_encode(float linear);

// The 8-bit code nearest to 255 times the display value of `linear`, ties upwards: exact.
std::uint8_t srgb_encode8(float linear);

// The nearest 8-bit code of a display value, clamped to [0, 255]; NaN gives 0.
inline std::uint8_t quantize8(float display) {
  const float scaled = display * 255.0f + 0.5f;
  if (!(scaled > 0)) return 0;
  return scaled >= 255.0f ? 255 : static_cast<std::uint8_t>(scaled);
}

}  // namespace atlas

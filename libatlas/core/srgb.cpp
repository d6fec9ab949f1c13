#include "libatlas/core/srgb.h"

#include <cmath>
#include <iterator>

#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

double decode_exact(double d) {
  return d <= 0.04045 ? d / 12.92 : portable::pow((d + 0.055) / 1.055, 2.4);
}

double encode_exact(double l) {
  return l <= 0.0031308 ? l * 12.92 : 1.055 * portable::pow(l, 1 / 2.4) - 0.055;
}

}  // namespace

namespace srgb_detail {

Tables::Tables() {
  for (int i = 0; i < 256; ++i) decode[i] = static_cast<float>(decode_exact(i / 255.0));
  threshold[0] = 0;
  for (int i = 1; i < 256; ++i) {
    const double exact = decode_exact((i - 0.5) / 255);
    // The smallest float that is not below the exact bound.
    float f = static_cast<float>(exact);
    if (f < exact) f = std::nextafter(f, 2.0f);
    threshold[i] = f;
  }
  threshold[256] = INFINITY;
  for (std::uint32_t i = 0; i < std::size(encode); ++i)
    encode[i].start =
        static_cast<float>(encode_exact(std::bit_cast<float>(kFirst + (i << (23 - kPieceBits)))));
  for (std::size_t i = 0; i + 1 < std::size(encode); ++i)
    encode[i].rise = encode[i + 1].start - encode[i].start;
  encode[std::size(encode) - 1].rise = 0;
}

const Tables tables;

}  // namespace srgb_detail

float srgb_decode(float display) {
  if (!(display > 0)) return 0;
  if (display >= 1) return 1;
  return static_cast<float>(decode_exact(display));
}

std::uint8_t srgb_encode8(float linear) {
  std::uint8_t code = quantize8(srgb_encode(linear));
  if (code > 0 && !(linear >= srgb_detail::tables.threshold[code])) return code - 1;
  if (code < 255 && linear >= srgb_detail::tables.threshold[code + 1]) return code + 1;
  return code;
}

}  // namespace atlas

// Internal: how bright a colour is.
#pragma once

namespace atlas {

// Returns the luminance of a linear colour, by the weights of Rec. 709, in the precision of T.
template <class T>
constexpr T luma(T r, T g, T b) {
  return T(0.2126) * r + T(0.7152) * g + T(0.0722) * b;
}

}  // namespace atlas

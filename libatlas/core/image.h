// Images in memory: rows of texels whose channels are interleaved, with row 0 at the bottom (see
// core/rect.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atlas {

template <class T>
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<T> texels = {};  // width * height * channels

  Image() = default;
  Image(int w, int h, int c, T fill = T{})
      : width(w), height(h), channels(c), texels(std::size_t(w) * h * c, fill) {}

  bool empty() const { return width == 0 || height == 0 || channels == 0; }
  // Returns whether no side is negative and `texels` has width * height * channels values. That
  // product of three integers may leave the range of std::size_t, so it is divided instead.
  bool whole() const {
    if (width < 0 || height < 0 || channels < 0) return false;
    if (empty()) return texels.empty();
    const std::size_t area = std::size_t(width) * std::size_t(height);
    return texels.size() % area == 0 && texels.size() / area == std::size_t(channels);
  }

  T* at(int x, int y) { return texels.data() + (std::size_t(y) * width + x) * channels; }
  const T* at(int x, int y) const {
    return texels.data() + (std::size_t(y) * width + x) * channels;
  }
};

using ImageF = Image<float>;
using Image8 = Image<std::uint8_t>;

}  // namespace atlas

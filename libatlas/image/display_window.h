// Internal: the part of an image that is to be shown. OpenEXR files may store another one, the data
// window: renderers leave out empty borders, or store more than is shown for filters to use.
#pragma once

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "libatlas/core/image.h"

namespace atlas {

// Returns whether the image stores another part than the one it shows, its display window. Only of
// OpenEXR: in other formats, an offset is a place on paper or among layers.
inline bool stores_another_part(const OIIO::ImageInput& input) {
  const OIIO::ImageSpec& spec = input.spec();
  return std::string_view(input.format_name()) == "openexr" &&
         (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
          spec.height != spec.full_height);
}

// Returns the part to be shown of `stored`, an image of bottom-up rows. Texels that are not stored
// are 0, in all channels.
template <class T>
Image<T> shown_part(const Image<T>& stored, const OIIO::ImageSpec& spec) {
  Image<T> shown(spec.full_width, spec.full_height, stored.channels);
  const std::int64_t right = std::int64_t{spec.x} - spec.full_x;
  const std::int64_t up = std::int64_t{spec.full_y} + spec.full_height - spec.y - spec.height;
  const std::int64_t first = std::max<std::int64_t>(0, right);
  const std::int64_t end = std::min<std::int64_t>(shown.width, right + stored.width);
  if (first >= end) return shown;
  for (int y = 0; y < stored.height; ++y) {
    const std::int64_t to = y + up;
    if (to < 0 || to >= shown.height) continue;
    std::copy_n(stored.at(int(first - right), y), std::size_t(end - first) * stored.channels,
                shown.at(int(first), int(to)));
  }
  return shown;
}

}  // namespace atlas
